//! Random pairs and deviations from a seed.

use rackmesh::deviation::*;
use rackmesh::gear::{Pair, PairData, PinionData, RackData};

pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        // splitmix64
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
    pub fn range(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }
    pub fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }
    pub fn int(&mut self, lo: i64, hi: i64) -> i64 {
        lo + (self.next() % (hi - lo + 1) as u64) as i64
    }
}

/// A pair that meshes: any hand and shaft angle, no undercut worth mentioning, contact ratio above 1.05.
pub fn pair(random: &mut Random) -> Pair {
    pair_with(random, |random| {
        let helix = |random: &mut Random| {
            if random.chance(0.15) { 0.0 } else { random.range(-45.0, 45.0_f64).to_radians() }
        };
        (helix(random), helix(random))
    })
}

/// The same with helix angles of rack and pinion of one's choice.
pub fn pair_with(random: &mut Random, mut helices: impl FnMut(&mut Random) -> (f64, f64)) -> Pair {
    loop {
        let m = random.range(1.0, 4.0);
        let alpha = random.range(14.5, 25.0_f64).to_radians();
        let teeth = random.int(5, 60) as u32;
        let (beta_r, beta_p) = helices(random);
        let x = random.range(-0.3, 0.8);
        let r = m * f64::from(teeth) / 2.0 / beta_p.cos();
        let tan_t = alpha.tan() / beta_p.cos();
        let alpha_t = tan_t.atan();
        let addendum = random.range(0.7, 1.1);
        let undercut = addendum - r / m * alpha_t.sin().powi(2);
        if x < undercut + 0.02 {
            continue;
        }
        let data = PairData {
            normal_module_mm: m,
            normal_pressure_angle_rad: alpha,
            rack: RackData {
                helix_angle_rad: beta_r,
                face_width_mm: random.range(4.0, 15.0) * m,
                addendum_mm: addendum * m,
                tooth_thickness_mm: None,
            },
            pinion: PinionData {
                teeth,
                helix_angle_rad: beta_p,
                profile_shift: x,
                tip_diameter_mm: 2.0 * (r + m * (x + random.range(0.6, 1.05))),
                root_form_diameter_mm: Some(2.0 * (r + m * (x - random.range(0.9, 1.2)))),
                face_width_mm: random.range(4.0, 15.0) * m,
                tooth_thickness_deviation_mm: if random.chance(0.3) { random.range(-0.1, 0.05) } else { 0.0 },
            },
        };
        if let Ok(pair) = Pair::new(&data)
            && pair.contact_ratio().transverse > 1.05
        {
            return pair;
        }
    }
}

pub fn rack(random: &mut Random, pair: &Pair, leads: bool) -> RackFlanks {
    RackFlanks::new(pair, &rack_list(random, leads)).unwrap()
}

pub fn rack_list(random: &mut Random, leads: bool) -> Vec<RackDeviation> {
    let mut list = Vec::new();
    for _ in 0..random.int(0, 6) {
        let first = random.int(-4, 8);
        let teeth = match random.int(0, 2) {
            0 => ToothRange::ALL,
            1 => ToothRange::new(Some(first), None).unwrap(),
            _ => ToothRange::new(Some(first), Some(first + random.int(0, 3))).unwrap(),
        };
        let value = random.range(-0.1, 0.1);
        let kind = match random.int(0, if leads { 6 } else { 5 }) {
            0 => RackDeviationKind::OverRoller(value),
            1 => RackDeviationKind::Pitch(0.3 * value),
            2 => RackDeviationKind::Shift(value),
            3 => RackDeviationKind::Thickness(value),
            4 => RackDeviationKind::Left(value),
            5 => RackDeviationKind::Right(value),
            _ => RackDeviationKind::Lead(random.range(-1.0, 1.0_f64).to_radians() * 0.5),
        };
        list.push(RackDeviation { teeth, kind });
    }
    if leads && random.chance(0.6) {
        let lead = random.range(-1.0, 1.0_f64).to_radians() * 0.5;
        list.push(RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Lead(lead) });
    }
    list
}

pub fn pinion(random: &mut Random, pair: &Pair, leads: bool) -> PinionFlanks {
    let z = i64::from(pair.pinion().teeth);
    let mut list = pinion_list(random, z, leads);
    if random.chance(0.4) {
        let tooth = random.int(0, z - 1) as u32;
        list.push(PinionDeviation::eccentricity(random.range(-0.1, 0.1), tooth));
    }
    PinionFlanks::new(pair, &list).unwrap()
}

pub fn pinion_list(random: &mut Random, z: i64, leads: bool) -> Vec<PinionDeviation> {
    let mut list = Vec::new();
    for _ in 0..random.int(0, 6) {
        let teeth = ToothRange::single(random.int(0, z - 1)).unwrap();
        let value = random.range(-0.1, 0.1);
        let kind = match random.int(0, if leads { 5 } else { 4 }) {
            0 => PinionDeviationKind::Shift(value),
            1 => PinionDeviationKind::Thickness(value),
            2 => PinionDeviationKind::Left(value),
            3 => PinionDeviationKind::Right(value),
            4 => PinionDeviationKind::Radial(value),
            _ => PinionDeviationKind::Lead(random.range(-1.0, 1.0_f64).to_radians()),
        };
        list.push(PinionDeviation { teeth, kind });
    }
    list
}
