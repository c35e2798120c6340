//! Closed forms: the paper's pair, spur gears, sums.

use super::random::{self, Random, drawn};
use crate::deviation::DeviationKind;
use crate::formula::Law;
use crate::gear::{Pair, PairData, PinionData, RackData};
use crate::judge::bound::{
    AssumedHeight, Basis, Bound, ErrorRange, ExtendedError, Extent, GivenGeometry, GivenPair, HeightFrom, Knowledge,
    KnownPairs, KnownTeeth, NoBound, Note, Range, sum::bound,
};
use crate::mesh::Support;
use crate::quantity::{Angle, Length};
use crate::reproduction;
use crate::trig;

const DEGREE: f64 = std::f64::consts::PI / 180.0;

fn unknown(errors: &[ExtendedError]) -> Bound {
    Basis::default().bound(errors)
}

fn of(pair: Pair, errors: &[ExtendedError]) -> Bound {
    of_given(GivenPair::plain(pair), errors)
}

fn of_given(given: GivenPair, errors: &[ExtendedError]) -> Bound {
    let geometry = GivenGeometry::Known(KnownPairs::new(given));
    Basis { geometry, ..Basis::default() }.bound(errors)
}

fn error(pair: &Pair, kind: u32, extent: Extent, value: f64) -> ExtendedError {
    drawn(pair, kind, extent, value, None).error
}

fn near(value: f64, expected: f64) {
    assert!((value - expected).abs() < 1e-9, "{value} {expected}");
}

/// Whatever sign and share of its tolerance an error has, it stays inside the range of the tolerance.
#[test]
fn tolerances_hold_errors_of_either_sign() {
    let mut random = Random(0x746f_6c65);
    let mut held = 0;
    for _ in 0..40 {
        let pair = random::pair(&mut random);
        let errors: Vec<_> = (0..3).map(|_| random::error(&mut random, &pair).error).collect();
        let tolerances: Vec<_> = errors.iter().copied().map(ExtendedError::of_either_sign).collect();
        let pairs = KnownPairs::new(GivenPair::plain(pair));
        let Ok(known) = pairs.for_errors(&tolerances, None) else { continue };
        let (none, rolls) = (Basis::default(), Basis { rolls: true, ..Basis::default() });
        for (basis, pair) in [(&none, Some(known)), (&none, None), (&rolls, None)] {
            let knowledge = Knowledge { basis, pair };
            let Ok(outer) = bound(&tolerances, &knowledge).combined.range else { continue };
            for _ in 0..8 {
                let some: Vec<_> = errors.iter().map(|error| error.scaled(random.range(-1.0, 1.0))).collect();
                let Range { lower, upper } = bound(&some, &knowledge).combined.range.unwrap();
                assert!(
                    lower >= outer.lower - 1e-9 && upper <= outer.upper + 1e-9,
                    "{some:?} {lower} {upper} {outer:?}"
                );
                held += 1;
            }
        }
    }
    assert!(held > 400, "{held}");
}

/// A tolerance whose sign is not known scatters over what either sign does.
#[test]
fn a_tolerance_of_all_teeth_alike_scatters() {
    let pair = reproduction::pair().unwrap();
    let rss =
        |kind, extent| Basis::default().together(&[error(&pair, kind, extent, 0.03).of_either_sign()]).rss.unwrap();
    let size = rss(0, Extent::All);
    near(size.lower, -0.03);
    near(size.upper, 0.03);
    let step = rss(1, Extent::One);
    let alone = Basis::default().alone(&error(&pair, 1, Extent::One, 0.03)).unwrap();
    near(step.upper, alone.upper_mm);
}

/// z = 20, straight teeth, α_n = 20°, short rack teeth: at times one tooth carries alone.
fn spur() -> Pair {
    with_addendum(1.0, Some(38.0))
}

fn with_addendum(addendum_mm: f64, root_form_diameter_mm: Option<f64>) -> Pair {
    Pair::new(&PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: 20.0 * DEGREE,
        rack: RackData { helix_angle_rad: 0.0, face_width_mm: 20.0, addendum_mm, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 20,
            helix_angle_rad: 0.0,
            profile_shift: 0.0,
            tip_diameter_mm: 43.8,
            root_form_diameter_mm,
            face_width_mm: 26.0,
            tooth_thickness_deviation_mm: 0.0,
        },
    })
    .unwrap()
}

/// Every rack pitch off by 12 µm on the paper's pair: as many steps add up as are in contact, where the formula has one.
#[test]
fn every_pitch_of_the_papers_rack_adds_up() {
    let pair = reproduction::pair().unwrap();
    let step = 0.012 / (2.0 * trig::tan(19.9 * DEGREE));
    let path = crate::judge::bound::ContactPath::nominal(&pair);
    for (value, count) in
        [(0.012, (path.ratio - 2.0 * path.offset).floor()), (-0.012, (path.ratio + 2.0 * path.offset).floor())]
    {
        let all = of(pair, &[error(&pair, 1, Extent::All, value)]);
        let ErrorRange { upper_mm, in_contact, .. } = all.errors[0].unwrap();
        println!("{value}: {upper_mm} of {step}, {count} in contact {in_contact:?}, path {path:?}");
        assert!(upper_mm >= count * step - 1e-12 && upper_mm < (count + 1.0) * step);
    }
    let one = of(pair, &[error(&pair, 1, Extent::One, 0.012)]);
    near(one.errors[0].unwrap().upper_mm, step);
    assert_eq!(unknown(&[error(&pair, 1, Extent::All, 0.012)]).combined.range, Err(NoBound::TeethInContactUnknown));
}

/// A rack step and a pinion step of 20 µm, each 0 to 27.5 µm alone, reach −24.8 µm together in the mesh.
#[test]
fn two_steps_that_only_push_may_sink_together() {
    let pair = spur();
    let g = 0.02 / (2.0 * trig::tan(20.0 * DEGREE));
    let steps = [error(&pair, 1, Extent::One, 0.02), error(&pair, 4, Extent::One, 0.02)];
    let alone = Basis { geometry: GivenGeometry::BothFlanks, ..Basis::default() }.bound(&steps);
    for range in &alone.errors {
        assert!((range.unwrap().lower_mm, range.unwrap().raw_lower_mm) == (0.0, -range.unwrap().upper_mm));
        near(range.unwrap().upper_mm, g);
    }
    let Range { lower, upper } = alone.combined.range.unwrap();
    near(lower, -g);
    near(upper, 2.0 * g);
    let Range { lower, .. } = unknown(&steps).combined.range.unwrap();
    assert!(lower < -0.0289, "{lower}");
    // one tooth alone in the wider space sinks by the whole step
    near(of(pair, &steps[..1]).errors[0].unwrap().lower_mm, -g);
}

/// Sizes: e, and what one space can do.
#[test]
fn a_space_acts_as_its_extent_says() {
    let pair = spur();
    let ends = |extent, value| {
        let ErrorRange { lower_mm, upper_mm, .. } = of(pair, &[error(&pair, 3, extent, value)]).errors[0].unwrap();
        (lower_mm, upper_mm)
    };
    assert_eq!(ends(Extent::All, -0.004), (-0.004, -0.004));
    assert_eq!(ends(Extent::Each, -0.004), (-0.004, 0.004));
    assert_eq!(ends(Extent::Part, -0.004), (-0.004, 0.0));
    assert_eq!(ends(Extent::One, 0.004), (0.0, 0.004));
    // +13 µm of all rack spaces and −4 µm of one pinion space: the mesh says +13
    let both = of(pair, &[error(&pair, 0, Extent::All, 0.013), error(&pair, 3, Extent::One, -0.004)]);
    near(both.combined.range.unwrap().upper, 0.013);
    near(both.combined.range.unwrap().lower, 0.009);
}

/// f_Hβ cos β_b / (2 sin α_n) of a pinion, k |sin Δβ| / (2 tan α_n) of a straight rack: always, like a size.
#[test]
fn a_lead_of_every_tooth_acts_always() {
    let pair = spur();
    let law = Law::pinion_lead("20".parse().unwrap(), "25".parse().unwrap()).unwrap();
    let deviation: Length = "10 um".parse().unwrap();
    let pinion = ExtendedError::new(law, deviation, Extent::All).unwrap();
    let sin_b = trig::sin(25.0 * DEGREE) * trig::cos(20.0 * DEGREE);
    let expected = 0.01 * (1.0 - sin_b * sin_b).sqrt() / (2.0 * trig::sin(20.0 * DEGREE));
    near(unknown(&[pinion]).errors[0].unwrap().upper_mm, expected);
    let lead = of(pair, &[error(&pair, 2, Extent::All, 0.1 * DEGREE)]).errors[0].unwrap();
    let expected = 20.0 * trig::sin(0.1 * DEGREE) / (2.0 * trig::tan(20.0 * DEGREE));
    for end in [lead.upper_mm, if pair.contact_ratio().transverse > 1.1 { lead.lower_mm } else { lead.upper_mm }] {
        assert!((end / expected - 1.0).abs() < 1e-3, "{lead:?} {expected}");
    }
    // twice the angle: the sum of both as angles
    let half = error(&pair, 2, Extent::All, 0.05 * DEGREE);
    // a single lead is taken between nodes
    assert!((of(pair, &[half, half]).combined.range.unwrap().upper - lead.upper_mm).abs() < 2e-7);
}

/// F_p of a pinion per flank side: one thick tooth.
#[test]
fn a_total_deviation_counts_on_both_flank_sides() {
    let pair = spur();
    let total = of(pair, &[error(&pair, 4, Extent::Total, 0.02)]).errors[0].unwrap();
    near(total.upper_mm, 2.0 * 0.02 * (1.0 - 1.0 / 20.0) / (2.0 * trig::tan(20.0 * DEGREE)));
    assert_eq!((total.lower_mm, total.raw_lower_mm), (-total.upper_mm, -total.upper_mm));
}

#[test]
fn what_would_narrow_a_range_is_said() {
    let pair = spur();
    let notes = unknown(&[error(&pair, 1, Extent::One, 0.02), error(&pair, 2, Extent::All, 0.001)]).notes;
    let expected = [
        Note::OwnCurveAt(0.0),
        Note::GeometryNarrows,
        Note::BothFlanksNarrows,
        Note::AssumedHeight(AssumedHeight { mm: 0.25 * 20.0, from: HeightFrom::FaceWidth }),
    ];
    assert_eq!(notes, expected);
    let with_module = Basis { normal_module_mm: Some(2.0), ..Basis::default() };
    let notes = with_module.bound(&[error(&pair, 2, Extent::All, 0.001)]).notes;
    assert!(notes.contains(&Note::AssumedHeight(AssumedHeight { mm: 3.0, from: HeightFrom::Module })));
    let with_addendum = Basis { addendum_mm: Some(6.0), ..with_module };
    let notes = with_addendum.bound(&[error(&pair, 2, Extent::All, 0.001)]).notes;
    assert!(notes.contains(&Note::AssumedHeight(AssumedHeight { mm: 6.0, from: HeightFrom::Addendum })));
    assert_eq!(of(pair, &[error(&pair, 4, Extent::Each, 0.02)]).notes, [Note::WholeTeeth]);
    // what moves all teeth alike has one ΔCD, and one that is on a few teeth a range
    assert_eq!(unknown(&[error(&pair, 0, Extent::All, 0.02)]).notes, [Note::OwnCurveAt(0.0)]);
    assert!(unknown(&[error(&pair, 0, Extent::One, 0.02)]).notes.contains(&Note::GeometryNarrows));
}

/// What a known pair does by itself is in the sum, and said.
#[test]
fn the_own_range_of_a_known_pair_is_said() {
    let pair = with_addendum(2.7, None);
    let bound = of(pair, &[error(&pair, 0, Extent::All, 0.01)]);
    let [Note::OwnRange(Range { lower, upper })] = bound.notes[..] else { panic!("{:?}", bound.notes) };
    assert!(lower == 0.0 && upper > 0.0005, "{lower} {upper}");
    let sum = bound.combined.range.unwrap();
    near(sum.lower, 0.01 + lower);
    // errors of the pinion would shift its sides against each other, and lift a little more
    assert!(sum.upper > 0.0105 && sum.upper <= 0.01 + upper, "{sum:?}");
    let spur = spur();
    assert_eq!(of(spur, &[error(&spur, 0, Extent::All, 0.01)]).notes, []);
}

#[test]
fn an_error_needs_a_value_and_an_extent_that_fit() {
    let length: Length = "0.02".parse().unwrap();
    assert_eq!(ExtendedError::new(Law::rack_over_roller(), length, Extent::Total), Err(NoBound::NotOfItsKind));
    let lead = Law::rack_lead("20 deg".parse().unwrap(), Angle::ZERO, "20".parse().unwrap()).unwrap();
    assert_eq!(ExtendedError::new(lead, length, Extent::All), Err(NoBound::NotOfItsKind));
    let steep: Angle = "50 deg".parse().unwrap();
    assert_eq!(ExtendedError::new(lead, steep, Extent::All), Err(NoBound::TooLarge));
    assert_eq!(DeviationKind::RackPitch.usual_extent(), Extent::One);
}

/// A known pair is for so much error and no more; a rack that may roll keeps the upper ends.
#[test]
fn what_a_known_pair_is_for() {
    let pair = spur();
    let small = [error(&pair, 3, Extent::Each, 0.001)];
    let large = [error(&pair, 3, Extent::Each, 0.1)];
    let pairs = KnownPairs::new(GivenPair::plain(pair));
    let pair_of_small = pairs.for_errors(&small, None).unwrap();
    let knowledge = Knowledge { basis: &Basis::default(), pair: Some(pair_of_small) };
    assert_eq!(bound(&large, &knowledge).combined.range, Err(NoBound::BeyondReach));
    let support = Support::FreeRoll { axis_depth_mm: 8.0 };
    let step = [error(&pair, 1, Extent::One, 0.02)];
    let rolling = of_given(GivenPair { support, ..GivenPair::plain(pair) }, &step);
    let (fixed, rolling) = (of(pair, &step).errors[0].unwrap(), rolling.errors[0].unwrap());
    near(rolling.upper_mm, fixed.upper_mm);
    assert!(rolling.lower_mm == rolling.raw_lower_mm && rolling.raw_lower_mm <= fixed.raw_lower_mm);
}

/// A measured error enters with its bound, tolerances with the root of their squares; steps on every pitch add as squares.
#[test]
fn what_scatters_in_a_statistical_sum() {
    let pair = spur();
    let rss = |errors: &[ExtendedError]| of(pair, errors).combined.rss;
    let measured = [error(&pair, 0, Extent::All, 0.01), error(&pair, 1, Extent::One, 0.02)];
    assert_eq!((rss(&measured), rss(&[])), (Err(NoBound::NothingScatters), Err(NoBound::NothingScatters)));
    let tolerances = [error(&pair, 0, Extent::Each, 0.03), error(&pair, 3, Extent::Each, 0.04)];
    let found = rss(&tolerances).unwrap();
    near(found.lower, -0.05);
    near(found.upper, 0.05);
    let bound = of(pair, &measured).combined.range.unwrap();
    let both = rss(&[measured, tolerances].concat()).unwrap();
    assert!((both.lower - (bound.lower - 0.05)).abs() < 1e-6 && (both.upper - (bound.upper + 0.05)).abs() < 1e-6);
    let step = error(&pair, 1, Extent::Each, 0.02);
    let alone = of(pair, &[step]).errors[0].unwrap();
    let g = 0.02 / (2.0 * trig::tan(20.0 * DEGREE));
    near(rss(&[step]).unwrap().upper, (alone.raw_upper_mm * g).sqrt().min(alone.upper_mm));
    // without geometry nobody knows how many add up, unless their total is limited
    assert_eq!(unknown(&[step]).combined.rss, Err(NoBound::TeethInContactUnknown));
    near(unknown(&[step.within_total(0.004)]).combined.rss.unwrap().upper, 0.4 * g);
}

/// A limit on a single error is held against this range.
#[test]
fn what_an_error_does_alone_does_not_depend_on_the_others() {
    let pair = spur();
    let step = error(&pair, 4, Extent::Each, 0.0008);
    let alone = of(pair, &[step]).errors[0].unwrap();
    for size in [0.002, 0.04, 0.2] {
        assert_eq!(of(pair, &[step, error(&pair, 0, Extent::Each, size)]).errors[0].unwrap(), alone, "{size}");
    }
}

/// F_p of 10 µm on either flank side of a pinion of 8 teeth, with f_pt larger than that: 2 g(F_p) (1 − 1/z), with the
/// pair known; without it z is not known.
#[test]
fn a_pitch_tolerance_is_capped_by_the_total_of_either_flank_side() {
    let pair = spur();
    let capped = |value: f64| error(&pair, 4, Extent::Each, value).within_total(0.01);
    let g = |value: f64| value / (2.0 * trig::tan(20.0 * DEGREE));
    let total = of(pair, &[error(&pair, 4, Extent::Total, 0.01)]).errors[0].unwrap();
    let range = of(pair, &[capped(0.1)]).errors[0].unwrap();
    near(range.upper_mm, total.upper_mm);
    near(range.raw_lower_mm, total.raw_lower_mm);
    let free = of(pair, &[error(&pair, 4, Extent::Each, 0.001)]).errors[0].unwrap();
    near(of(pair, &[capped(0.001)]).errors[0].unwrap().upper_mm, free.upper_mm);
    let unknown = unknown(&[capped(0.1)]).errors[0].unwrap();
    assert!(unknown.upper_mm <= 2.0 * g(0.01) + 1e-12 && unknown.upper_mm >= total.upper_mm, "{unknown:?}");
}

/// A stroke that the mesh did not solve may lie lower or higher: what it says is no bound.
#[test]
fn teeth_whose_mesh_is_not_solved_have_no_bound() {
    let teeth = |solved| Some(KnownTeeth { range: Range { lower: -0.01, upper: 0.02 }, solved });
    let total = |solved| Basis { known_teeth: teeth(solved), ..Basis::default() }.bound(&[]).combined.range;
    assert_eq!(total(true), Ok(Range { lower: -0.01, upper: 0.02 }));
    assert_eq!(total(false), Err(NoBound::NotSolved));
}
