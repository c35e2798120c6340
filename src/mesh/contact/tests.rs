//! Tests of the searches, and what tests of the closed forms share with them.

mod generator;
pub(super) mod said;
pub(super) mod wild;

use std::cell::Cell;
use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::{Across, ContactKind, FlankContact, Generator, Hint, Plane, Pose, Touch};
use crate::deviation::{
    PinionDeviation, PinionDeviationKind, PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks, ToothRange,
};
use crate::gear::{Pair, PairData, PinionData, RackData};
use crate::mesh::prepare::Roll;
use crate::mesh::{FlankSide, Mesh, Sampler, Support};
use crate::trig;

thread_local! {
    /// Generators and points of flanks that were looked at.
    static LOOKED_AT: Cell<u64> = const { Cell::new(0) };
}

/// One more generator or point of a flank is looked at.
pub(super) fn count() {
    LOOKED_AT.set(LOOKED_AT.get() + 1);
}

/// How many are, while something is done.
pub(super) fn looks<T>(work: impl FnOnce() -> T) -> (T, u64) {
    let before = LOOKED_AT.get();
    let done = work();
    (done, LOOKED_AT.get() - before)
}

/// Random numbers, the same each time.
pub(in crate::mesh) struct Random(pub(in crate::mesh) u64);

impl Random {
    pub(in crate::mesh) fn next(&mut self, low: f64, high: f64) -> f64 {
        // splitmix64
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let unit = ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * unit
    }
}

/// A random pair.
pub(in crate::mesh) fn pair(random: &mut Random, narrow: bool) -> Option<Pair> {
    let module = random.next(1.0, 3.0);
    let teeth = random.next(6.0, 60.0).round();
    let helix = |random: &mut Random| if random.next(0.0, 1.0) < 0.25 { 0.0 } else { random.next(-0.7, 0.7) };
    let (rack, pinion) = (helix(random), helix(random));
    let parallel = random.next(0.0, 1.0) < 0.3;
    let radius = 0.5 * module * teeth / trig::cos(pinion);
    // a large profile shift puts all of the flank outside of the reference circle
    let shift = random.next(0.0, if narrow { 2.0 } else { 0.6 });
    // of narrow faces most are much narrower than the widest
    let face = |random: &mut Random, least: f64| {
        let share = random.next(0.0, 1.0);
        module * if narrow { 0.05 + 15.0 * share * share * share * share } else { least + (15.0 - least) * share }
    };
    let data = PairData {
        normal_module_mm: module,
        normal_pressure_angle_rad: random.next(0.26, 0.43),
        rack: RackData {
            helix_angle_rad: if parallel { -pinion } else { rack },
            face_width_mm: face(random, 2.0),
            addendum_mm: random.next(0.7, 1.1) * module,
            tooth_thickness_mm: None,
        },
        pinion: PinionData {
            teeth: teeth as u32,
            helix_angle_rad: pinion,
            profile_shift: shift,
            tip_diameter_mm: 2.0 * (radius + module * (shift + random.next(0.6, 1.0))),
            root_form_diameter_mm: Some(2.0 * (radius + module * (shift - random.next(0.8, 1.2)))),
            face_width_mm: face(random, 5.0),
            tooth_thickness_deviation_mm: 0.0,
        },
    };
    Pair::new(&data).ok()
}

/// With as much eccentricity as [`positions`] has.
pub(super) fn off_axis(pinion: PinionFlanks) -> PinionFlanks {
    pinion.with_offset((0.1415, 0.0)).expect("small")
}

/// Positions of a flank pair, on its contact line and beyond.
pub(super) fn positions(
    random: &mut Random,
    mesh: &Mesh,
    contact: &FlankContact,
    across: f64,
    each: &mut impl FnMut(&FlankContact, &Pose),
) {
    for _ in 0..12 {
        let reach = contact.kappa.abs() * contact.half_face + 0.2;
        let roll = random.next(contact.start_roll - reach, contact.tip_roll + reach);
        let (x, z) = (random.next(-0.1, 0.1), random.next(-0.1, 0.1));
        let c = contact.nu - roll;
        let pose = Pose { c, shift: 0.0, offset: (x, z), offset_rate: (-z, x), across };
        // placed as where the pinion is near its place: the line asks for the nominal centre distance or so
        let line = contact.unbounded(&pose);
        let wanted = mesh.pair().nominal_center_distance_mm() + random.next(-0.1, 0.1);
        each(contact, &Pose { shift: wanted - line, ..pose });
    }
}

/// Flanks that fit, on usual faces or narrow ones.
pub(super) fn contacts(narrow: bool, mut each: impl FnMut(&FlankContact, &Pose)) {
    let mut random = Random(1);
    let mut made = 0;
    while made < 600 {
        let Some(pair) = pair(&mut random, narrow) else { continue };
        let mesh = Mesh::new(pair, RackFlanks::nominal(&pair), off_axis(PinionFlanks::nominal(&pair)), Support::Fixed);
        let mesh = mesh.expect("teeth in order");
        made += 1;
        let side = if made % 2 == 0 { FlankSide::Right } else { FlankSide::Left };
        let contact = mesh.prepare(side, 0, &Roll::NONE).contact;
        positions(&mut random, &mesh, &contact, 0.0, &mut each);
    }
}

/// Flanks with lead errors, some of them hardly any, the rack rolled or not; and whether it is beneath the pinion.
fn tilted(mut each: impl FnMut(&FlankContact, &Pose, bool)) {
    let mut random = Random(3);
    let mut made = 0;
    while made < 500 {
        let Some(pair) = pair(&mut random, made % 2 == 0) else { continue };
        made += 1;
        let amount = |random: &mut Random| match random.next(0.0, 4.0) {
            0.0..1.0 => 0.0,
            1.0..2.0 => random.next(-1e-5, 1e-5),
            _ => random.next(-0.01, 0.01),
        };
        let (rack, pinion) = (amount(&mut random), amount(&mut random));
        let rack = [RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Lead(rack) }];
        let pinion = [PinionDeviation { teeth: ToothRange::ALL, kind: PinionDeviationKind::Lead(pinion) }];
        let rack = RackFlanks::new(&pair, &rack).expect("small");
        let pinion = off_axis(PinionFlanks::new(&pair, &pinion).expect("small"));
        let roll =
            if made % 3 == 0 { Roll::new(random.next(-0.07, 0.07), random.next(-5.0, 20.0)) } else { Roll::NONE };
        let mesh = Mesh::new(pair, rack, pinion, Support::Fixed).expect("teeth in order");
        let side = if made % 4 < 2 { FlankSide::Right } else { FlankSide::Left };
        let contact = mesh.prepare(side, 0, &roll).contact;
        // as with a roll axis that is far away: the rack's face may pass beside the pinion's
        let beside = if contact.fits || made % 5 != 0 { 0.0 } else { random.next(-1.5, 1.5) };
        let across = roll.sin * (roll.depth + mesh.pair().nominal_center_distance_mm())
            + beside * (contact.half_face + contact.across.half_width);
        positions(&mut random, &mesh, &contact, across, &mut |contact, pose| each(contact, pose, beside == 0.0));
    }
}

/// The largest demand among many generators, refined beside the best ones.
pub(super) fn scanned(contact: &FlankContact, pose: &Pose) -> Option<f64> {
    const CELLS: u32 = 600;
    let zero = pose.c - contact.nu;
    let reach = contact.kappa.abs() * contact.half_face;
    let lo = (zero + contact.start_roll - reach).max(-PI);
    let hi = (zero + contact.tip_roll + reach).min(PI);
    // off the flank, what misses least ranks highest
    let value = |delta: f64| match contact.demand(pose, delta) {
        Generator::Some { demand, .. } => demand,
        Generator::None { gap, .. } => -1e6 + gap,
    };
    let at = |cell: u32| lo + (hi - lo) * f64::from(cell) / f64::from(CELLS);
    let values: Vec<f64> = (0..=CELLS).map(|cell| value(at(cell))).collect();
    let mut best = values[0].max(values[CELLS as usize]);
    for cell in 0..=CELLS {
        let here = values[cell as usize];
        let (before, after) = (cell.saturating_sub(1), (cell + 1).min(CELLS));
        if here >= values[before as usize] && here >= values[after as usize] {
            let (mut a, mut b) = (at(before), at(after));
            for _ in 0..100 {
                let (x, y) = (b - 0.618 * (b - a), a + 0.618 * (b - a));
                let (left, right) = (value(x), value(y));
                best = best.max(left).max(right);
                if left >= right { b = y } else { a = x }
            }
        }
    }
    (best > -0.9e6).then_some(best)
}

pub(super) const NO_FLOOR: f64 = f64::NEG_INFINITY;

/// Flanks that do not fit touch at the highest of all generators, wherever the search begins.
#[test]
fn the_climb_ends_at_the_top() {
    let mut random = Random(7);
    let (mut some, mut none, mut fresh, mut hinted, mut worst) = (0, 0, 0, 0, 0.0_f64);
    tilted(|contact, pose, _| {
        let (touch, count) = looks(|| contact.touch(pose, NO_FLOOR, None));
        fresh += count;
        let Some(touch) = touch else {
            none += 1;
            assert_eq!(scanned(contact, pose), None, "{contact:?}\n{pose:?}");
            return;
        };
        some += 1;
        let best = scanned(contact, pose).expect("the scan finds it too");
        worst = worst.max((touch.demand - best).abs());
        // how far a generator reaches beyond a vertex and still counts decides there
        let allowed = if touch.vertex.is_some() { 1e-9 } else { 1e-11 };
        assert!((touch.demand - best).abs() < allowed, "{best} {touch:?}\n{contact:?}\n{pose:?}");
        for spread in [1e-6, 1e-3, 0.1] {
            let delta = touch.spot.delta + spread * random.next(-1.0, 1.0);
            let hint = Hint { delta, w: touch.spot.w, at_rack_edge: touch.at_rack_edge };
            let (again, count) = looks(|| contact.touch(pose, NO_FLOOR, Some(hint)));
            hinted += count;
            let again = again.expect("it touched before");
            assert!(
                (again.demand - touch.demand).abs() < allowed,
                "{hint:?} {touch:?}\n{again:?}\n{contact:?}\n{pose:?}"
            );
        }
    });
    println!("{some} touch, {none} do not, difference {worst:e}; {fresh} generators from afar, {hinted} from hints");
    assert!(some > 3000 && none > 300);
    assert!(fresh <= 44_050 && hinted <= 118_810, "{fresh} {hinted}");
}

/// Below the floor a bound will do, above it nothing changes.
#[test]
fn a_search_that_ends_early_ends_with_a_bound() {
    let (mut early, mut looked) = (0, [0; 4]);
    tilted(|contact, pose, _| {
        let Some(touch) = contact.touch(pose, NO_FLOOR, None) else { return };
        for (above, looked) in [1e-9, 1e-4, 0.01, 1.0].into_iter().zip(&mut looked) {
            let (low, count) = looks(|| contact.touch(pose, touch.demand + above, None));
            *looked += count;
            if let Some(low) = low {
                early += u32::from(low.demand != touch.demand);
                assert!(low.demand >= touch.demand - 1e-12, "{low:?}\n{touch:?}\n{contact:?}\n{pose:?}");
                assert!(low.demand < touch.demand + above, "{low:?}\n{touch:?}\n{contact:?}\n{pose:?}");
            }
            let same = contact.touch(pose, touch.demand - above, None).expect("it asks for more");
            assert!((same.demand - touch.demand).abs() < 1e-12, "{same:?}\n{touch:?}\n{contact:?}\n{pose:?}");
        }
    });
    println!("{early} early ends, {looked:?} generators");
    assert!(early > 1000);
    assert!(looked.iter().zip([37_930, 32_940, 28_950, 22_690]).all(|(&looked, known)| looked <= known), "{looked:?}");
}

/// The same flank, a little further.
pub(super) fn moved(pose: &Pose, h: f64) -> Pose {
    let ((x, z), (dx, dz)) = (pose.offset, pose.offset_rate);
    Pose { c: pose.c + h, offset: (x + h * dx, z + h * dz), ..*pose }
}

/// Compares the derivative by the flank's angle with differences, and counts the contacts compared of each kind.
pub(super) fn compare_rates(contacts: impl FnOnce(&mut dyn FnMut(&FlankContact, &Pose))) -> BTreeMap<ContactKind, u32> {
    let mut compared = BTreeMap::new();
    contacts(&mut |contact, pose| {
        let h = 1e-6;
        let at = |h: f64| contact.touch(&moved(pose, h), NO_FLOOR, None);
        let (Some(before), Some(here), Some(after)) = (at(-h), at(0.0), at(h)) else { return };
        let names = |touch: &Touch| {
            (touch.kind, touch.spot.kind, touch.other.map(|(spot, _)| spot.kind), touch.vertex.is_some())
        };
        if names(&before) != names(&here) || names(&after) != names(&here) {
            return;
        }
        let slope = (after.demand - before.demand) / (2.0 * h);
        let bend = (after.demand - 2.0 * here.demand + before.demand).abs() / h;
        // not across a corner of the demand
        if bend < 1e-3 {
            *compared.entry(here.kind).or_default() += 1;
            let off = (slope - here.rate).abs();
            assert!(off < 1e-6 + bend, "{off:e} {slope} {here:?}\n{contact:?}\n{pose:?}");
        }
    });
    println!("{compared:?}");
    compared
}

/// The derivative by the flank's angle, at edges, corners and vertices alike.
#[test]
fn the_climbs_rates_are_differences() {
    let compared = compare_rates(|each| tilted(|contact, pose, _| each(contact, pose)));
    assert!(compared.len() >= 5 && compared.values().all(|&count| count > 5), "{compared:?}");
}

/// Along a stroke each search starts where the last one ended.
#[test]
fn neighbouring_strokes_take_few_looks() {
    let mut random = Random(6);
    let (mut fitting, mut tilted) = (0, 0);
    for made in 0..24 {
        let Some(pair) = pair(&mut random, false) else { continue };
        let lead = if made % 2 == 0 { 0.0 } else { random.next(-0.005, 0.005) };
        let rack = [
            RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Lead(lead) },
            RackDeviation { teeth: ToothRange::single(1).expect("a tooth"), kind: RackDeviationKind::Thickness(0.03) },
        ];
        let rack = RackFlanks::new(&pair, &rack).expect("small");
        let pinion = PinionFlanks::new(&pair, &[PinionDeviation::eccentricity(0.03, 2)]);
        let mesh = Mesh::new(pair, rack, pinion.expect("small"), Support::Fixed).expect("teeth in order");
        let mut sampler = Sampler::new(&mesh);
        let looked = if made % 2 == 0 { &mut fitting } else { &mut tilted };
        for step in 0..150 {
            let stroke = 0.017 * f64::from(step) * mesh.pair().rack().pitch_mm;
            let (point, count) = looks(|| sampler.at(stroke));
            *looked += count;
            assert!(point.is_ok(), "{point:?}");
        }
    }
    println!("{fitting} places looked at on flanks that fit, {tilted} on those that do not");
    assert!(fitting <= 4260 && tilted <= 46_830);
}

#[test]
fn contacts_have_names() {
    let names = [
        (ContactKind::Line, "line"),
        (ContactKind::Point, "point"),
        (ContactKind::TipEdge, "tip edge"),
        (ContactKind::RootEdge, "root edge"),
        (ContactKind::RackEdge, "rack edge"),
        (ContactKind::RackEndEdge, "end edge"),
        (ContactKind::PinionEndEdge, "end edge"),
        (ContactKind::Corner, "corner"),
    ];
    for (kind, name) in names {
        assert_eq!((kind.name(), kind.to_string().as_str()), (name, name));
    }
}

/// Flanks that do not fit are not passed over either if they ask for more than the mark.
#[test]
fn what_stays_below_does_not_touch_above() {
    let mut below = [0; 3];
    tilted(|contact, pose, beneath| {
        if !beneath {
            return;
        }
        let Some(touch) = contact.touch(pose, NO_FLOOR, None) else { return };
        assert!(!contact.stays_below(pose, touch.demand - 1e-11), "{touch:?}\n{contact:?}\n{pose:?}");
        let line = contact.unbounded(pose) + contact.tilt.abs() * contact.w_extent;
        for (share, below) in [0.0, 0.3, 0.9].into_iter().zip(&mut below) {
            *below += u32::from(contact.stays_below(pose, touch.demand + share * (line - touch.demand) + 1e-12));
        }
    });
    println!("{below:?} stay below none, 0.3 and 0.9 of what they miss");
    assert!(below.iter().zip([920, 1885, 2677]).all(|(&below, least)| below >= least), "{below:?}");
}

/// The parts of a flank of which the closed forms say nothing, against points of them.
#[test]
fn the_rest_of_a_flank_is_bounded_closely() {
    let mut compared = 0;
    contacts(false, |contact, pose| {
        if !contact.slides {
            return;
        }
        let (r, nu) = (contact.base_radius, contact.nu);
        // on the contact line's side of the axis and beyond a quarter turn: where τ is least, and where tan(δ/2) = τ
        let quarter = 0.5 * PI - nu;
        let behind = contact.scale * (nu - contact.sin_nu);
        let ahead = contact.scale * (2.0 * trig::tan(0.5 * quarter) - quarter);
        let loss = contact.far_loss;
        assert!(loss <= behind.min(ahead) * (1.0 + 1e-12) && loss > 0.8 * behind.min(ahead), "{loss} {behind} {ahead}");
        // the tip plane asks for most where tan(δ/2) = τ at the root
        let gamma = nu + 2.0 * trig::atan(contact.start_roll);
        let (sin, cos) = trig::sin_cos(gamma);
        let root = contact.tip.d + r * (cos + contact.start_roll * sin) - pose.offset.1;
        if contact.start_roll * contact.sin_nu < contact.cos_nu {
            assert!((contact.reach_of_root(pose) - root).abs() < 1e-12, "{root}");
            compared += 1;
        }
        let far = contact.unbounded(pose) - loss;
        let without_helix = contact.kappa == 0.0;
        assert_eq!(contact.rest(pose, true), far);
        assert_eq!(contact.rest(pose, false), if without_helix { far } else { far.max(contact.reach_of_root(pose)) });
    });
    assert!(compared > 1000, "{compared}");
}

/// With any pressure angle: what generators behind the axis and beyond a quarter turn miss at least.
#[test]
fn far_generators_miss_by_a_known_amount() {
    for nu in [0.1, 0.3, 0.5, 0.7, 0.9, 1.1, 1.3] {
        let contact = FlankContact { nu, sin_nu: trig::sin(nu), scale: 3.0, ..FlankContact::default() };
        let quarter = 0.5 * PI - nu;
        let least = 3.0 * (nu - trig::sin(nu)).min(2.0 * trig::tan(0.5 * quarter) - quarter);
        assert!(contact.far_loss() <= least && contact.far_loss() > 0.6 * least, "{nu} {least} {}", contact.far_loss());
    }
}
