//! Tests of the searches, and what tests of the closed forms share with them.

use std::cell::Cell;
use std::f64::consts::PI;

use super::{ContactKind, FlankContact, Generator, Hint, Pose, Touch};
use crate::deviation::{
    PinionDeviation, PinionDeviationKind, PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks, ToothRange,
};
use crate::gear::{Pair, PairData, PinionData, RackData};
use crate::mesh::prepare::Roll;
use crate::mesh::{FlankSide, Mesh, Support};
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

/// Numbers in 0..1 that fill it evenly.
pub(super) struct Even(pub(super) f64);

impl Even {
    pub(super) fn next(&mut self, low: f64, high: f64) -> f64 {
        self.0 = (self.0 + 0.618_033_988_749_895).fract();
        low + (high - low) * self.0
    }
}

/// A random pair.
fn pair(even: &mut Even, narrow: bool) -> Option<Pair> {
    let module = even.next(1.0, 3.0);
    let teeth = even.next(6.0, 60.0).round();
    let helix = |even: &mut Even| if even.next(0.0, 1.0) < 0.25 { 0.0 } else { even.next(-0.7, 0.7) };
    let (rack, pinion) = (helix(even), helix(even));
    let parallel = even.next(0.0, 1.0) < 0.3;
    let radius = 0.5 * module * teeth / trig::cos(pinion);
    let shift = even.next(0.0, 0.6);
    // of narrow faces most are much narrower than the widest
    let face = |even: &mut Even, least: f64| {
        let share = even.next(0.0, 1.0);
        module * if narrow { 0.05 + 15.0 * share * share * share * share } else { least + (15.0 - least) * share }
    };
    let data = PairData {
        normal_module_mm: module,
        normal_pressure_angle_rad: even.next(0.26, 0.43),
        rack: RackData {
            helix_angle_rad: if parallel { -pinion } else { rack },
            face_width_mm: face(even, 2.0),
            addendum_mm: even.next(0.7, 1.1) * module,
            tooth_thickness_mm: None,
        },
        pinion: PinionData {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "6 to 60")]
            teeth: teeth as u32,
            helix_angle_rad: pinion,
            profile_shift: shift,
            tip_diameter_mm: 2.0 * (radius + module * (shift + even.next(0.6, 1.0))),
            root_form_diameter_mm: Some(2.0 * (radius + module * (shift - even.next(0.8, 1.2)))),
            face_width_mm: face(even, 5.0),
            tooth_thickness_deviation_mm: 0.0,
        },
    };
    Pair::new(&data).ok()
}

/// Positions of a flank pair, on its contact line and beyond.
fn positions(
    even: &mut Even,
    mesh: &Mesh,
    contact: &FlankContact,
    across: f64,
    each: &mut impl FnMut(&FlankContact, &Pose),
) {
    for _ in 0..12 {
        let reach = contact.kappa.abs() * contact.half_face + 0.2;
        let roll = even.next(contact.start_roll - reach, contact.tip_roll + reach);
        let (x, z) = (even.next(-0.1, 0.1), even.next(-0.1, 0.1));
        let c = contact.nu - roll;
        let pose = Pose { c, shift: 0.0, offset: (x, z), offset_rate: (-z, x), across };
        // placed as where the pinion is near its place: the line asks for the nominal centre distance or so
        let line = contact.unbounded(&pose);
        let wanted = mesh.pair().nominal_center_distance_mm() + even.next(-0.1, 0.1);
        each(contact, &Pose { shift: wanted - line, ..pose });
    }
}

/// Flanks that fit, on usual faces or narrow ones.
pub(super) fn contacts(narrow: bool, mut each: impl FnMut(&FlankContact, &Pose)) {
    let mut even = Even(0.1);
    let mut made = 0;
    while made < 600 {
        let Some(pair) = pair(&mut even, narrow) else { continue };
        let mesh = Mesh::nominal(pair).expect("teeth in order");
        made += 1;
        let side = if made % 2 == 0 { FlankSide::Right } else { FlankSide::Left };
        let contact = mesh.prepare(side, 0, &Roll::NONE).contact;
        positions(&mut even, &mesh, &contact, 0.0, &mut each);
    }
}

/// Flanks with lead errors, some of them hardly any, and narrow faces, the rack rolled or not.
fn tilted(mut each: impl FnMut(&FlankContact, &Pose)) {
    let mut even = Even(0.3);
    let mut made = 0;
    while made < 500 {
        let Some(pair) = pair(&mut even, made % 2 == 0) else { continue };
        made += 1;
        let amount = |even: &mut Even| match even.next(0.0, 4.0) {
            0.0..1.0 => 0.0,
            1.0..2.0 => even.next(-1e-5, 1e-5),
            _ => even.next(-0.01, 0.01),
        };
        let (rack, pinion) = (amount(&mut even), amount(&mut even));
        let rack = [RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Lead(rack) }];
        let pinion = [PinionDeviation { teeth: ToothRange::ALL, kind: PinionDeviationKind::Lead(pinion) }];
        let rack = RackFlanks::new(&pair, &rack).expect("small");
        let pinion = PinionFlanks::new(&pair, &pinion).expect("small");
        let roll = if made % 3 == 0 { Roll::new(even.next(-0.07, 0.07), even.next(-5.0, 20.0)) } else { Roll::NONE };
        let mesh = Mesh::new(pair, rack, pinion, Support::Fixed).expect("teeth in order");
        let side = if made % 4 < 2 { FlankSide::Right } else { FlankSide::Left };
        let contact = mesh.prepare(side, 0, &roll).contact;
        // as with a roll axis that is far away: the rack's face may pass beside the pinion's
        let beside = if contact.fits || made % 5 != 0 { 0.0 } else { even.next(-1.5, 1.5) };
        let across = roll.sin * (roll.depth + mesh.pair().nominal_center_distance_mm())
            + beside * (contact.half_face + contact.across.half_width);
        positions(&mut even, &mesh, &contact, across, &mut each);
    }
}

/// The largest demand among many generators, refined beside the best ones.
fn scanned(contact: &FlankContact, pose: &Pose) -> Option<f64> {
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
    let mut even = Even(0.7);
    let (mut some, mut none, mut fresh, mut hinted, mut worst) = (0, 0, 0, 0, 0.0_f64);
    tilted(|contact, pose| {
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
            let delta = touch.spot.delta + spread * even.next(-1.0, 1.0);
            let hint = Hint { delta, w: touch.spot.w, at_rack_edge: touch.at_rack_edge, spread };
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
    assert!(fresh <= 51_700 && hinted <= 121_900, "{fresh} {hinted}");
}

/// Below the floor a bound will do, above it nothing changes.
#[test]
fn a_search_that_ends_early_ends_with_a_bound() {
    let (mut early, mut looked) = (0, [0; 4]);
    tilted(|contact, pose| {
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
    assert!(looked.iter().zip([45_440, 39_130, 33_700, 25_420]).all(|(&looked, known)| looked <= known), "{looked:?}");
}

/// The same flank, a little further.
fn moved(pose: &Pose, h: f64) -> Pose {
    let ((x, z), (dx, dz)) = (pose.offset, pose.offset_rate);
    Pose { c: pose.c + h, offset: (x + h * dx, z + h * dz), ..*pose }
}

/// The derivative by the flank's angle, at edges, corners and vertices alike.
#[test]
fn the_climbs_rates_are_differences() {
    let mut compared = std::collections::BTreeMap::<ContactKind, u32>::new();
    tilted(|contact, pose| {
        let h = 1e-6;
        let at = |h: f64| contact.touch(&moved(pose, h), NO_FLOOR, None);
        let (Some(before), Some(here), Some(after)) = (at(-h), at(0.0), at(h)) else { return };
        let same = |a: &Touch, b: &Touch| {
            let names = |touch: &Touch| {
                (touch.kind, touch.spot.kind, touch.other.map(|(spot, _)| spot.kind), touch.vertex.is_some())
            };
            names(a) == names(b)
        };
        if !same(&before, &here) || !same(&after, &here) {
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
    assert!(compared.len() >= 5 && compared.values().all(|&count| count > 15), "{compared:?}");
}
