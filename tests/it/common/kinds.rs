//! Comparisons of the solver with the brute force, by kind of pair. Each makes a case from a seed, and says how far the
//! two are apart and what the case was, or nothing if there is no contact in either.

use rackmesh::deviation::{PinionForm, RackForm};
use rackmesh::gear::Pair;
use rackmesh::mesh::{Mesh, MeshPoint, Support};

use super::brute::{Brute, Roll};
use super::random::{self, Random};

type Compared = Option<(f64, String)>;

type Kind = (&'static str, fn(u64) -> Compared);

type Make = fn(u64) -> Case;

/// Kinds of pairs: the name of each and its comparison.
pub const KINDS: [Kind; 7] = [
    (CASES[0].0, |seed| compare_case(&CASES[0].1(seed))),
    (CASES[1].0, |seed| compare_case(&CASES[1].1(seed))),
    (CASES[2].0, |seed| compare_case(&CASES[2].1(seed))),
    (CASES[3].0, |seed| compare_case(&CASES[3].1(seed))),
    (CASES[4].0, compare_formed),
    (CASES[5].0, |seed| compare_rolling(seed, 5, false)),
    (CASES[6].0, |seed| compare_rolling(seed, 5, true)),
];

/// How each kind's cases are made.
pub const CASES: [(&str, Make); 7] = [
    ("spur", |seed| Case::of_pair(seed, |_| (0.0, 0.0), false)),
    ("helical, parallel axes", |seed| {
        Case::of_pair(
            seed,
            |random| {
                let beta = random.range(-45.0, 45.0_f64).to_radians();
                (beta, -beta)
            },
            false,
        )
    }),
    ("crossed helical", |seed| Case::of_pair(seed, any_helices, false)),
    ("crossed helical, lead errors", |seed| Case::of_pair(seed, any_helices, true)),
    ("crossed helical, flank form", Case::formed),
    ("rack free to roll", |seed| Case::rolling(seed, false)),
    ("rack free to roll, flank form", |seed| Case::rolling(seed, true)),
];

fn any_helices(random: &mut Random) -> (f64, f64) {
    (random.range(-45.0, 45.0_f64).to_radians(), random.range(-45.0, 45.0_f64).to_radians())
}

/// The rack teeth that can touch at a stroke, and some more.
pub fn teeth(pair: &Pair, stroke: f64) -> Vec<i64> {
    let middle = (stroke / pair.rack().pitch_mm).round() as i64;
    let reach = 3 + (pair.contact_ratio().total / 2.0).ceil() as i64;
    (middle - reach..=middle + reach).collect()
}

/// A mesh and a stroke, made from a seed.
pub struct Case {
    pub mesh: Mesh,
    pub stroke: f64,
    pub seed: u64,
}

impl Case {
    fn new(seed: u64, mut random: Random, pair: Pair, leads: bool) -> Self {
        let rack = random::rack(&mut random, &pair, leads);
        let pinion = random::pinion(&mut random, &pair, leads);
        let stroke = random.range(-3.0, 8.0) * pair.rack().pitch_mm;
        Self { mesh: Mesh::new(pair, rack, pinion, Support::Fixed).unwrap(), stroke, seed }
    }

    fn of_pair(seed: u64, helices: impl FnMut(&mut Random) -> (f64, f64), leads: bool) -> Self {
        let mut random = Random(seed);
        let pair = random::pair_with(&mut random, helices);
        Self::new(seed, random, pair, leads)
    }

    /// Crowning, relief and profile slope: the flanks are no longer ruled, and contact is a point inside them.
    fn formed(seed: u64) -> Self {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let (rack_form, pinion_form) = forms(&mut random, &pair);
        let leads = random.chance(0.5);
        let rack = random::rack(&mut random, &pair, leads).with_form(&pair, rack_form).unwrap();
        let pinion = random::pinion(&mut random, &pair, leads).with_form(pinion_form).unwrap();
        let stroke = random.range(-3.0, 8.0) * pair.rack().pitch_mm;
        Self { mesh: Mesh::new(pair, rack, pinion, Support::Fixed).unwrap(), stroke, seed }
    }

    fn rolling(seed: u64, formed: bool) -> Self {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let mut rack = random::rack(&mut random, &pair, true);
        let mut pinion = random::pinion(&mut random, &pair, true);
        if formed {
            let forms = forms(&mut random, &pair);
            rack = rack.with_form(&pair, forms.0).unwrap();
            pinion = pinion.with_form(forms.1).unwrap();
        }
        let axis_depth_mm = random.range(-2.0, 12.0) * pair.normal_module_mm();
        let stroke = random.range(-3.0, 8.0) * pair.rack().pitch_mm;
        Self { mesh: Mesh::new(pair, rack, pinion, Support::FreeRoll { axis_depth_mm }).unwrap(), stroke, seed }
    }

    /// The centre distance by brute force, of a rolling rack at the roll given. A point says where to begin.
    pub fn by_brute_force(&self, roll: f64, near: Option<&MeshPoint>) -> Option<f64> {
        let (pair, rack, pinion) = (self.mesh.pair(), self.mesh.rack(), self.mesh.pinion());
        let teeth = teeth(pair, self.stroke);
        let start = near.map_or(0.0, |point| -point.transmission_error_rad);
        let at = |roll| Brute { pair, rack, pinion, roll }.center_distance(self.stroke, &teeth, start);
        let Support::FreeRoll { axis_depth_mm } = self.mesh.support() else { return at(Roll::default()) };
        let mut assumed = near.map_or(pair.nominal_center_distance_mm(), |point| point.center_distance_mm);
        for _ in 0..8 {
            let a = at(Roll { angle: roll, depth: axis_depth_mm, assumed })?;
            // the face's edge moves by the roll times the error of what was assumed
            if ((a - assumed) * roll).abs() < 1e-10 {
                return Some(a);
            }
            assumed = a;
        }
        None
    }
}

/// Any pair, most of them with lead errors.
pub fn compare(seed: u64) -> Compared {
    let mut random = Random(seed);
    let pair = random::pair(&mut random);
    let leads = random.chance(0.7);
    compare_case(&Case::new(seed, random, pair, leads))
}

fn compare_case(case: &Case) -> Compared {
    let point = case.mesh.at(case.stroke);
    let reference = case.by_brute_force(0.0, point.as_ref().ok());
    let seed = case.seed;
    match (point, reference) {
        (Ok(point), Some(a)) => {
            let unsettled = if point.converged() { 0.0 } else { f64::NAN };
            Some((point.center_distance_mm - a + unsettled, format!("seed {seed}: {point:?}\n{:?}", case.mesh)))
        }
        (Err(_), None) => None,
        (point, reference) => panic!("seed {seed}: {point:?} against {reference:?}"),
    }
}

fn forms(random: &mut Random, pair: &Pair) -> (RackForm, PinionForm) {
    let m = pair.normal_module_mm();
    let (start, addendum) = (random.range(0.0, 0.6), pair.rack().addendum_mm);
    let rack = RackForm {
        crowning_mm: if random.chance(0.7) { random.range(0.0, 0.03) } else { 0.0 },
        tip_relief_mm: if random.chance(0.5) { random.range(0.0, 0.03) } else { 0.0 },
        tip_relief_start_mm: start * addendum.min(m),
    };
    let pinion = PinionForm {
        crowning_mm: if random.chance(0.7) { random.range(0.0, 0.03) } else { 0.0 },
        profile_slope_mm: if random.chance(0.5) { random.range(-0.02, 0.02) } else { 0.0 },
    };
    (rack, pinion)
}

/// Crowning, relief and profile slope.
pub fn compare_formed(seed: u64) -> Compared {
    let case = Case::formed(seed);
    let point = case.mesh.at(case.stroke).unwrap();
    let reference = case.by_brute_force(0.0, Some(&point))?;
    Some((point.center_distance_mm - reference, format!("seed {seed}: {point:?}\n{:?}", case.mesh)))
}

/// A rack that rolls: its centre distance is the brute force's at that roll, and no other roll has a smaller one.
pub fn compare_rolling(seed: u64, rolls: u32, formed: bool) -> Compared {
    let case = Case::rolling(seed, formed);
    let pair = case.mesh.pair();
    let point = case.mesh.at(case.stroke).unwrap();
    let at = |angle: f64| case.by_brute_force(angle, Some(&point));
    let same_roll = at(point.roll_rad)?;
    let what = |roll: f64, a: f64| format!("seed {seed}, roll {roll} gives {a}: {point:?}\n{:?}", case.mesh);
    let error = point.center_distance_mm - same_roll;
    if error.abs() > 1e-7 {
        return Some((error, what(point.roll_rad, same_roll)));
    }
    let near = [1e-4, 2e-3].into_iter().flat_map(|step| [point.roll_rad - step, point.roll_rad + step]);
    let far = (0..rolls).map(|i| {
        let cells = f64::from(rolls - 1);
        0.07 * (2.0 * f64::from(i) / cells - 1.0)
    });
    for roll in near.chain(far) {
        // far below, the rack has rolled off the pinion, which drops past it
        if let Some(a) = at(roll)
            && a > 0.5 * pair.nominal_center_distance_mm()
            && a < point.center_distance_mm - 1e-7
        {
            return Some((point.center_distance_mm - a, what(roll, a)));
        }
    }
    Some((error, String::new()))
}

/// Runs one comparison per seed on two cores; how many there were, the largest difference, and what went wrong.
pub fn run(
    seeds: &[u64],
    allowed_mm: f64,
    compare: impl Fn(u64) -> Option<(f64, String)> + Sync,
) -> (usize, f64, Vec<String>) {
    let next = std::sync::atomic::AtomicUsize::new(0);
    let found = std::sync::Mutex::new((0, 0.0_f64, Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(&seed) = seeds.get(next.fetch_add(1, std::sync::atomic::Ordering::Relaxed)) {
                    if let Some((error, what)) = compare(seed) {
                        let mut found = found.lock().unwrap();
                        found.0 += 1;
                        found.1 = found.1.max(error.abs());
                        if error.is_nan() || error.abs() > allowed_mm {
                            found.2.push(format!("{error:e} mm, {what}"));
                        }
                    }
                }
            });
        }
    });
    found.into_inner().unwrap()
}
