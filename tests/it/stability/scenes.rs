//! Random scenes, and the relations between those that are related.

use super::*;

#[derive(Debug, Clone)]
pub(super) struct Scene {
    pub(super) data: PairData,
    pub(super) rack: Vec<RackDeviation>,
    pub(super) pinion: Vec<PinionDeviation>,
    pub(super) support: Support,
}

impl Scene {
    /// Deviations of every kind but accumulated pitch on all teeth, which is anchored at tooth 0.
    pub(super) fn random(seed: u64) -> Self {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let z = i64::from(pair.pinion().teeth);
        let leads = random.chance(0.5);
        let anchored = |d: &RackDeviation| matches!(d.kind, RackDeviationKind::Pitch(_)) && d.teeth.first().is_none();
        let mut rack = random::rack_list(&mut random, leads);
        rack.retain(|deviation| !anchored(deviation));
        let mut pinion = random::pinion_list(&mut random, z, leads);
        let amount_mm = if random.chance(0.4) { random.range(-0.1, 0.1) } else { 0.0 };
        pinion.push(PinionDeviation::eccentricity(amount_mm, random.int(0, z - 1) as u32));
        Self { data: data(&pair), rack, pinion, support: Support::Fixed }
    }

    pub(super) fn pair(&self) -> Pair {
        Pair::new(&self.data).unwrap()
    }

    pub(super) fn pitch(&self) -> f64 {
        self.pair().rack().pitch_mm
    }

    pub(super) fn mesh(&self) -> Mesh {
        let pair = self.pair();
        let rack = RackFlanks::new(&pair, &self.rack).unwrap();
        let pinion = PinionFlanks::new(&pair, &self.pinion).unwrap();
        Mesh::new(pair, rack, pinion, self.support).unwrap()
    }

    /// The scene with the X axis turned round: hands change, right becomes left, tooth i becomes −i.
    pub(super) fn mirrored(&self) -> Self {
        use PinionDeviationKind as P;
        use RackDeviationKind as R;
        let mut mirror = self.clone();
        mirror.data.rack.helix_angle_rad *= -1.0;
        mirror.data.pinion.helix_angle_rad *= -1.0;
        for deviation in &mut mirror.rack {
            let (first, last) = (deviation.teeth.first(), deviation.teeth.last());
            deviation.teeth = ToothRange::new(last.map(|tooth| -tooth), first.map(|tooth| -tooth)).unwrap();
            deviation.kind = match deviation.kind {
                R::Shift(v) => R::Shift(-v),
                R::Lead(v) => R::Lead(-v),
                R::Left(v) => R::Right(v),
                R::Right(v) => R::Left(v),
                R::Pitch(_) => unreachable!("a range of pitches has no mirror image"),
                same => same,
            };
        }
        let z = i64::from(self.data.pinion.teeth);
        for deviation in &mut mirror.pinion {
            // the space before tooth 0 is that of rack tooth 0; radial is of the space after a tooth
            let of_space = i64::from(matches!(deviation.kind, P::Radial(_)));
            let tooth = deviation.teeth.first().unwrap();
            deviation.teeth = ToothRange::single((z - 1 - of_space - tooth).rem_euclid(z)).unwrap();
            deviation.kind = match deviation.kind {
                P::Shift(v) => P::Shift(-v),
                P::Lead(v) => P::Lead(-v),
                P::Left(v) => P::Right(v),
                P::Right(v) => P::Left(v),
                same => same,
            };
        }
        mirror
    }

    /// Every tooth's number raised by one.
    pub(super) fn renumbered(&self) -> Self {
        let z = i64::from(self.data.pinion.teeth);
        let mut next = self.clone();
        for deviation in &mut next.rack {
            let up = |tooth: Option<i64>| tooth.map(|tooth| tooth + 1);
            deviation.teeth = ToothRange::new(up(deviation.teeth.first()), up(deviation.teeth.last())).unwrap();
        }
        for deviation in &mut next.pinion {
            deviation.teeth = ToothRange::single((deviation.teeth.first().unwrap() + 1) % z).unwrap();
        }
        next
    }

    pub(super) fn scaled(&self, f: f64) -> Self {
        let mut scaled = self.clone();
        scaled.data = scaled_data(&self.data, f);
        scaled.rack.iter_mut().for_each(|d| d.kind = rack_kind(d.kind, |v| v * f, |v| v));
        scaled.pinion.iter_mut().for_each(|d| d.kind = pinion_kind(d.kind, |v| v * f, |v| v));
        scaled
    }

    /// Every deviation in two parts, in another order.
    pub(super) fn split(&self, share: f64) -> Self {
        let mut split = self.clone();
        let part = |share: f64| move |v: f64| v * share;
        let rack = |share| {
            self.rack.iter().map(move |d| RackDeviation { kind: rack_kind(d.kind, part(share), part(share)), ..*d })
        };
        let pinion = |share| {
            self.pinion
                .iter()
                .map(move |d| PinionDeviation { kind: pinion_kind(d.kind, part(share), part(share)), ..*d })
        };
        split.rack = rack(1.0 - share).rev().chain(rack(share)).collect();
        split.pinion = pinion(1.0 - share).rev().chain(pinion(share)).collect();
        split
    }
}

pub(super) fn rack_kind(
    kind: RackDeviationKind,
    length: impl Fn(f64) -> f64,
    angle: impl Fn(f64) -> f64,
) -> RackDeviationKind {
    use RackDeviationKind as R;
    match kind {
        R::OverRoller(v) => R::OverRoller(length(v)),
        R::Pitch(v) => R::Pitch(length(v)),
        R::Shift(v) => R::Shift(length(v)),
        R::Thickness(v) => R::Thickness(length(v)),
        R::Left(v) => R::Left(length(v)),
        R::Right(v) => R::Right(length(v)),
        R::Lead(v) => R::Lead(angle(v)),
        other => panic!("{other:?} is new: say how it scales"),
    }
}

pub(super) fn pinion_kind(
    kind: PinionDeviationKind,
    length: impl Fn(f64) -> f64,
    angle: impl Fn(f64) -> f64,
) -> PinionDeviationKind {
    use PinionDeviationKind as P;
    match kind {
        P::Shift(v) => P::Shift(length(v)),
        P::Thickness(v) => P::Thickness(length(v)),
        P::Left(v) => P::Left(length(v)),
        P::Right(v) => P::Right(length(v)),
        P::Radial(v) => P::Radial(length(v)),
        P::Eccentricity(v) => P::Eccentricity(length(v)),
        P::Lead(v) => P::Lead(angle(v)),
        other => panic!("{other:?} is new: say how it scales"),
    }
}

pub(super) fn data(pair: &Pair) -> PairData {
    let (r, p) = (pair.rack(), pair.pinion());
    let standard = (std::f64::consts::FRAC_PI_2 + 2.0 * p.profile_shift * pair.normal_pressure_angle_rad().tan())
        * pair.normal_module_mm()
        / p.helix_angle_rad.cos();
    PairData {
        normal_module_mm: pair.normal_module_mm(),
        normal_pressure_angle_rad: pair.normal_pressure_angle_rad(),
        rack: RackData {
            helix_angle_rad: r.helix_angle_rad,
            face_width_mm: r.face_width_mm,
            addendum_mm: r.addendum_mm,
            tooth_thickness_mm: Some(r.tooth_thickness_mm),
        },
        pinion: PinionData {
            teeth: p.teeth,
            helix_angle_rad: p.helix_angle_rad,
            profile_shift: p.profile_shift,
            tip_diameter_mm: 2.0 * p.tip_radius_mm,
            root_form_diameter_mm: Some(2.0 * p.root_form_radius_mm),
            face_width_mm: p.face_width_mm,
            tooth_thickness_deviation_mm: p.tooth_thickness_mm - standard,
        },
    }
}

pub(super) fn scaled_data(data: &PairData, f: f64) -> PairData {
    let mut scaled = *data;
    scaled.normal_module_mm *= f;
    scaled.rack.face_width_mm *= f;
    scaled.rack.addendum_mm *= f;
    scaled.rack.tooth_thickness_mm = data.rack.tooth_thickness_mm.map(|v| v * f);
    scaled.pinion.tip_diameter_mm *= f;
    scaled.pinion.root_form_diameter_mm = data.pinion.root_form_diameter_mm.map(|v| v * f);
    scaled.pinion.face_width_mm *= f;
    scaled.pinion.tooth_thickness_deviation_mm *= f;
    scaled
}
