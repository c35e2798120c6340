//! What is made of solved points, curves and their summaries, and the virtual measuring machine, against values known
//! in closed form.
#![allow(clippy::pedantic, clippy::disallowed_methods)]

use crate::common::pairs::{spur, steering};
use crate::process::run;
use rackmesh::deviation::*;
use rackmesh::gear::Pair;
use rackmesh::mesh::{Carrier, ContactKind, Curve, Ending, FlankSide, Mesh, MeshError, MeshPoint, Sampler, Support};
use rackmesh::spec::{MeasuredTables, Spec};

fn near(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{what}: {found} {expected}");
}

fn point(stroke_mm: f64, delta_cd_mm: f64, transmission_error_rad: f64) -> MeshPoint {
    let carrier = Carrier { rack_tooth: 0, pinion_tooth: 0, contact: ContactKind::Line };
    MeshPoint {
        stroke_mm,
        center_distance_mm: 20.0 + delta_cd_mm,
        delta_cd_mm,
        pinion_angle_rad: 0.1 * stroke_mm + transmission_error_rad,
        transmission_error_rad,
        roll_rad: 0.0,
        right: carrier,
        left: carrier,
        residual_mm: 0.0,
        iterations: 1,
        ending: Ending::Converged,
    }
}

fn curve(points: &[(f64, f64, f64)]) -> Curve {
    let points = points.iter().map(|&(stroke, height, error)| point(stroke, height, error)).collect();
    Curve { points, kinks: Vec::new(), tolerance_mm: 1e-6, solved: 0, resolved: true }
}

#[test]
fn a_summary_is_that_of_the_polygon() {
    let mesh = Mesh::nominal(Pair::new(&spur()).unwrap()).unwrap();
    let p = mesh.pair().rack().pitch_mm;
    let heights =
        [(-2.0, 0.25, -1e-3), (-1.0, 0.75, 2e-3), (1.0, 0.75, 5e-3), (1.5, -0.5, 0.0), (2.5, -0.5 + 5e-12, 1e-3)];
    let summary = curve(&heights).summary(&mesh).unwrap();
    near(summary.mean_mm, (0.5 + 1.5 + 0.0625 - 0.5) / 4.5, "mean");
    near(summary.max_mm, 0.75, "highest");
    near(summary.min_mm, -0.5, "lowest");
    near(summary.peak_to_peak_mm, 1.25, "height");
    near(summary.max_stroke_mm, -1.0, "first of two highest");
    near(summary.min_stroke_mm, 1.5, "first of two lowest");
    near(summary.largest_rate, 2.5, "steepest");
    near(summary.transmission_error_rad, 6e-3, "transmission error");
    near(summary.transmission_error_mm, 6e-3 / (2.0 * std::f64::consts::PI / (20.0 * p)), "the same as travel");
    // a pitch covers them all; half as far apart as a pitch is, only neighbours count
    near(summary.tooth_to_tooth_mm, 1.25, "within a pitch");
    let apart = |step: f64| {
        let points = [(0.0, 0.0), (1.0, 0.3), (2.0, 0.5), (3.0, 0.1), (4.0, 0.9), (5.0, 0.2), (6.0, 1.0), (7.0, 0.95)];
        let points: Vec<_> = points.iter().map(|&(s, height)| (s * step * p + 3.0, height, 0.0)).collect();
        curve(&points).summary(&mesh).unwrap().tooth_to_tooth_mm
    };
    near(apart(1.1), 0.0, "nobody within a pitch");
    near(apart(1.0), 0.8, "neighbours just within a pitch");
    near(apart(0.5), 0.8, "the next but one too");
    near(apart(0.26), 0.9, "three steps");
    near(apart(0.1), 1.0, "all");
    // steps shorter than rounding allows say nothing of the slope, and one point alone has no range
    let close = [(0.0, 0.0, 0.0), (2e-6 * p, 1e-3, 0.0), (1.0, 0.5, 0.0)];
    near(curve(&close).summary(&mesh).unwrap().largest_rate, 0.499 / (1.0 - 2e-6 * p), "slope between distant points");
    let one = curve(&[(1.0, 0.25, 0.0)]).summary(&mesh).unwrap();
    assert_eq!((one.mean_mm, one.min_mm, one.max_mm, one.largest_rate), (0.25, 0.25, 0.25, 0.0));
    assert!(curve(&[]).summary(&mesh).is_none());
}

#[test]
fn ranges_and_tolerances_that_are_none_are_errors() {
    let mesh = Mesh::nominal(Pair::new(&spur()).unwrap()).unwrap();
    for (from, to) in [(2.0, 1.0), (f64::NAN, 1.0), (1.0, f64::NAN), (f64::NEG_INFINITY, 0.0), (-1e308, 1e308)] {
        assert!(matches!(mesh.curve(from, to, 1e-6), Err(MeshError::EmptyRange { .. })), "{from} {to}");
    }
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(mesh.curve(0.0, 1.0, tolerance), Err(MeshError::NotPositive { .. })), "{tolerance}");
        assert!(matches!(mesh.measure_rack(tolerance, [0]), Err(MeshError::NotPositive { .. })), "{tolerance}");
        assert!(matches!(mesh.measure_pinion(tolerance), Err(MeshError::NotPositive { .. })), "{tolerance}");
    }
    let point = mesh.curve(1.5, 1.5, 1e-6).unwrap();
    assert!(point.points.iter().all(|at| at.stroke_mm == 1.5) && point.resolved);
}

/// A pitch is begun with 32 steps, and a curve without height is not refined but for its kinks.
#[test]
fn a_curve_begins_with_so_many_steps() {
    let pair = Pair::new(&spur()).unwrap();
    let p = pair.rack().pitch_mm;
    // at the middle of each step flank meets flank as at its ends: one more stroke for each
    let mesh = Mesh::nominal(pair).unwrap();
    for (from, pitches, steps) in [(0.0, 0.01, 2), (0.1, 0.25, 8), (-3.0, 2.0, 64), (7.7, 11.0, 352)] {
        let curve = mesh.curve(from, from + pitches * p, 1e-6).unwrap();
        let kinks = curve.kinks.len();
        let plain = 2 * steps + 1;
        // halvings on both sides of a kink, until it does not show
        assert!(curve.solved >= plain && curve.solved <= plain + 26 * kinks, "{} {steps} {kinks}", curve.solved);
        assert!(kinks as f64 <= 4.0 * pitches + 2.0 && curve.resolved, "{kinks}");
        let strokes: Vec<f64> = curve.points.iter().map(|at| at.stroke_mm).collect();
        assert_eq!((strokes[0], strokes[strokes.len() - 1]), (from, from + pitches * p));
        assert!(strokes.windows(2).all(|two| two[0] < two[1]), "{strokes:?}");
    }
}

/// Kinks are where the carriers change, and both sides of one that shows are kept, while other points keep their distance.
/// A kink that bends the curve by a thousandth of the tolerance is not looked for any further, but is where it is said
/// to be, to less than a tooth's part in a hundred thousand, or in five hundred where the same teeth carry on.
#[test]
fn harmless_kinks_are_located_well_enough_and_no_better() {
    let pair = Pair::new(&spur()).unwrap();
    let pitch = pair.rack().pitch_mm;
    let one = |tooth, kind| RackDeviation { teeth: ToothRange::single(tooth).unwrap(), kind };
    let list = [one(1, RackDeviationKind::Pitch(0.02)), one(3, RackDeviationKind::Right(0.01))];
    let rack = RackFlanks::new(&pair, &list).unwrap();
    let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::Fixed).unwrap();
    let [fine, coarse] = [1e-6, 1.0].map(|tolerance| mesh.curve(0.0, 5.0 * pitch, tolerance).unwrap());
    println!("{} {} {} {}", fine.kinks.len(), fine.solved, coarse.kinks.len(), coarse.solved);
    assert_eq!(fine.kinks.len(), coarse.kinks.len());
    for (fine, coarse) in fine.kinks.iter().zip(&coarse.kinks) {
        let off = coarse.stroke_mm - fine.stroke_mm;
        let teeth = |(right, left): (Carrier, Carrier)| (right.rack_tooth, left.rack_tooth);
        let near = if teeth(fine.before) == teeth(fine.after) { 2e-3 } else { 1e-5 };
        assert!(off.abs() <= near * pitch && (coarse.before, coarse.after) == (fine.before, fine.after), "{off:e}");
    }
    // 32 steps a pitch, a middle in each, and twelve halvings with two middles each at a kink
    let expected = 161 + 160 + 24 * coarse.kinks.len();
    assert!(coarse.resolved && coarse.solved <= expected, "{} {expected}", coarse.solved);
}

/// Whether an edge that touches near its end is a corner says rounding, again and again: that is not looked at as closely as a
/// kink that shows.
#[test]
fn names_that_flicker_take_few_strokes() {
    let spec = "[pair]\nnormal_module = 0.5\nnormal_pressure_angle = 25\n\
        [rack]\nface_width = 5\naddendum = 0.425\nhelix_angle = 5\ncrowning = \"30 um\"\n\
        [pinion]\nteeth = 300\nhelix_angle = 0\nprofile_shift = 0.3\nface_width = 6.5\ntip_diameter = 151.15\nprofile_slope = \"5 um\"\n\
        [support]\nroll = \"free\"\nroll_axis_depth = 0\n";
    let ended = run(&["mesh", "-", "--from", "2.6", "--to", "2.8", "-f", "csv"], spec);
    let lines = ended.stdout.lines().count();
    assert!(ended.code == Some(0) && (20..300).contains(&lines), "{lines}: {}", ended.stderr);
}

/// A tolerance below what a solve leaves is given up at once, and said so; many steps are refined in blocks, of which
/// each counts.
#[test]
fn a_curve_finer_than_rounding_is_not_resolved() {
    let pair = Pair::new(&spur()).unwrap();
    let lead = RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Lead(0.002) };
    let rack = RackFlanks::new(&pair, &[lead]).unwrap();
    let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::Fixed).unwrap();
    let curve = mesh.curve(0.0, 10.0 * pair.rack().pitch_mm, 1e-18).unwrap();
    println!("{} {}", curve.solved, curve.points.len());
    assert!(!curve.resolved && curve.solved < 1500, "{}", curve.solved);
}

#[test]
fn kinks_are_where_carriers_change() {
    let pair = Pair::new(&steering()).unwrap();
    let p = pair.rack().pitch_mm;
    let step = RackDeviation { teeth: ToothRange::single(1).unwrap(), kind: RackDeviationKind::Thickness(0.03) };
    let rack = RackFlanks::new(&pair, &[step]).unwrap();
    let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::Fixed).unwrap();
    let curve = mesh.curve(-p, 4.0 * p, 1e-7).unwrap();
    let mut shown = 0;
    for kink in &curve.kinks {
        near(mesh.at(kink.stroke_mm).unwrap().delta_cd_mm, kink.delta_cd_mm, "height of a kink");
        let rise = |s: f64| (mesh.at(s + 1e-5).unwrap().delta_cd_mm - mesh.at(s).unwrap().delta_cd_mm) / 1e-5;
        let bend = rise(kink.stroke_mm + 1e-7) - rise(kink.stroke_mm - 1.01e-5);
        if bend.abs() > 1e-3 {
            shown += 1;
            // both sides are kept, as near as the tolerance needs
            let sides: Vec<f64> =
                curve.points.iter().map(|at| at.stroke_mm - kink.stroke_mm).filter(|by| by.abs() < 1e-7 * p).collect();
            assert!(sides.len() == 2 && sides[1] == 0.0 && sides[0] > -2e-9 * p, "{sides:?}");
        }
    }
    assert!(shown >= 4, "{shown}");
    let mut gaps: Vec<f64> = curve.points.windows(2).map(|two| two[1].stroke_mm - two[0].stroke_mm).collect();
    gaps.sort_by(f64::total_cmp);
    let close = gaps.iter().filter(|&&gap| gap < 0.99e-6 * p).count();
    assert!(close <= curve.kinks.len(), "{close} {}", curve.kinks.len());
    println!("{} solved, {} points, {} kinks, {shown} shown", curve.solved, curve.points.len(), curve.kinks.len());
    // the polygon is within the tolerance
    for two in curve.points.windows(2) {
        for share in [0.25, 0.5, 0.75] {
            let at = |a: f64, b: f64| a + share * (b - a);
            let middle = mesh.at(at(two[0].stroke_mm, two[1].stroke_mm)).unwrap();
            let off = middle.delta_cd_mm - at(two[0].delta_cd_mm, two[1].delta_cd_mm);
            assert!(off.abs() <= 1e-7, "{off:e} {middle:?}");
        }
    }
}

/// A ball of diameter D rests in a space of width e at the height (D/2 − (e/2) cos α)/sin α.
#[test]
fn balls_in_a_rack_rest_where_geometry_says() {
    let pair = Pair::new(&spur()).unwrap();
    let (alpha, p) = (pair.normal_pressure_angle_rad(), pair.rack().pitch_mm);
    let one = |tooth, kind| RackDeviation { teeth: ToothRange::single(tooth).unwrap(), kind };
    let list = [
        one(1, RackDeviationKind::Right(-0.04)),
        one(2, RackDeviationKind::Left(-0.02)),
        one(5, RackDeviationKind::Lead(0.003)),
        one(6, RackDeviationKind::Lead(0.003)),
    ];
    let rack = RackFlanks::new(&pair, &list).unwrap();
    let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::Fixed).unwrap();
    let space = p - pair.rack().tooth_thickness_mm;
    for diameter in [2.5, 3.3, 4.0] {
        let height = |space: f64| (0.5 * diameter - 0.5 * space * alpha.cos()) / alpha.sin();
        let readings = mesh.measure_rack(diameter, -3..8).unwrap();
        assert_eq!(readings.len(), 11);
        for reading in readings {
            // wider by what both flanks stand back, and to the side by half of the difference
            let (wider, aside) = match reading.space {
                1 => (0.06, -0.01),
                _ => (0.0, 0.0),
            };
            let place = (reading.space as f64 + 0.5) * p;
            if (4..=6).contains(&reading.space) {
                let lead = if reading.space == 5 { 0.003 } else { 0.0015 };
                assert!((reading.lead_rad - lead).abs() < 1e-7, "{reading:?}");
                continue;
            }
            near(reading.over_pin_mm, height(space + wider) + 0.5 * diameter, "over the ball");
            near(reading.height_deviation_mm, -0.5 * wider / alpha.tan(), "height deviation");
            near(reading.position_deviation_mm, aside, "position deviation");
            near(reading.position_mm, place + aside, "position");
            near(reading.lead_rad, 0.0, "lead");
        }
    }
}

/// The same across inclined teeth, where the nominal space is as wide as the normal section says.
#[test]
fn balls_in_a_helical_rack_rest_where_its_normal_section_says() {
    let mut data = spur();
    data.rack.helix_angle_rad = -0.5;
    data.pinion.helix_angle_rad = 0.5;
    data.pinion.tip_diameter_mm += 40.0 / 0.5_f64.cos() - 40.0;
    data.pinion.root_form_diameter_mm = None;
    let pair = Pair::new(&data).unwrap();
    let mesh = Mesh::nominal(pair).unwrap();
    let alpha = pair.normal_pressure_angle_rad();
    let space = std::f64::consts::PI * pair.normal_module_mm() - pair.rack().tooth_thickness_mm;
    for diameter in [2.5, 3.3, 4.0] {
        let height = (0.5 * diameter - 0.5 * space * alpha.cos()) / alpha.sin();
        for reading in mesh.measure_rack(diameter, -2..3).unwrap() {
            near(reading.over_pin_mm, height + 0.5 * diameter, "over the ball");
            near(reading.position_mm, (reading.space as f64 + 0.5) * pair.rack().pitch_mm, "position");
            near(reading.lead_rad, 0.0, "lead");
        }
    }
    assert!(matches!(mesh.measure_rack(0.0, [0]), Err(MeshError::NotPositive { .. })));
}

/// The centre's angle α_K solves inv α_K = D/(2 r_b cos β_b) − η_b, found here by halving.
#[test]
fn balls_in_a_pinion_rest_where_geometry_says() {
    let pair = Pair::new(&steering()).unwrap();
    let p = *pair.pinion();
    let list = [
        PinionDeviation { teeth: ToothRange::single(2).unwrap(), kind: PinionDeviationKind::Left(0.03) },
        PinionDeviation { teeth: ToothRange::single(7).unwrap(), kind: PinionDeviationKind::Right(-0.01) },
    ];
    let flanks = PinionFlanks::new(&pair, &list).unwrap();
    let teeth = flanks.teeth().to_vec();
    let mesh = Mesh::new(pair, RackFlanks::nominal(&pair), flanks, Support::Fixed).unwrap();
    let half = std::f64::consts::PI / f64::from(p.teeth) - p.base_half_angle_rad;
    let radius = |diameter: f64, narrower: f64| {
        let inv = diameter / (2.0 * p.base_radius_mm * p.base_helix_angle_rad.cos()) - half + narrower;
        let (mut low, mut high) = (0.0_f64, 1.4_f64);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if middle.tan() - middle < inv { low = middle } else { high = middle }
        }
        p.base_radius_mm / low.cos()
    };
    let at_reference = mesh.pinion_ball_mm();
    near(
        radius(at_reference, 0.0),
        p.base_radius_mm / p.transverse_pressure_angle_rad.cos(),
        "at the reference circle",
    );
    for diameter in [at_reference, 1.1 * at_reference] {
        let readings = mesh.measure_pinion(diameter).unwrap();
        assert_eq!(readings.len(), 8);
        for (j, reading) in readings.iter().enumerate() {
            let (before, here, after) = (&teeth[(j + 7) % 8], &teeth[j], &teeth[(j + 1) % 8]);
            let narrower = here.right.arc_mm - after.left.arc_mm;
            near(reading.radius_mm, radius(diameter, narrower / (2.0 * p.reference_radius_mm)), "radius");
            near(reading.radial_mm, 0.5 * narrower / p.transverse_pressure_angle_rad.tan(), "radial");
            near(reading.position_mm, 0.5 * (here.right.arc_mm + after.left.arc_mm), "position");
            near(reading.left_pitch_mm, here.left.arc_mm - before.left.arc_mm, "left pitch");
            near(reading.right_pitch_mm, here.right.arc_mm - before.right.arc_mm, "right pitch");
        }
        assert!(readings.iter().any(|reading| reading.left_pitch_mm.abs() > 0.02));
        assert!(readings.iter().any(|reading| reading.right_pitch_mm.abs() > 0.005));
    }
    // a ball that falls through to the base circle, and one that no space holds
    assert!(mesh.measure_pinion(0.3).is_err() && mesh.measure_pinion(1e5).is_err());
}

#[test]
fn sides_have_names() {
    assert_eq!((FlankSide::Right.to_string(), FlankSide::Left.to_string()), ("right".into(), "left".into()));
}

/// A wide rack on a slim pinion has narrow valleys: the search from the last stroke finds the one that a fresh search finds.
#[test]
fn a_rolling_rack_takes_the_lowest_valley_wherever_it_comes_from() {
    let spec = "[pair]\nnormal_module = 0.2\nnormal_pressure_angle = 15\n[rack]\nface_width = 30\naddendum = 0.12\n\
        crowning = \"2 um\"\n[pinion]\nteeth = 20\nhelix_angle = -10\nprofile_shift = 0.3\nface_width = 39\n\
        tip_diameter = 4.5217\ncrowning = \"2 um\"\n[support]\nroll = \"free\"\nroll_axis_depth = 3.4\n\
        [[rack.deviation]]\nteeth = \"3..\"\nlead = \"0.08 deg\"\n[[rack.deviation]]\nteeth = \"4\"\nlead = \"0.13 deg\"\n";
    let spec = Spec::parse("spec.toml", spec).expect("a valid spec");
    let mesh = spec.mesh(&MeasuredTables::default()).expect("a mesh").mesh;
    let mut walker = Sampler::new(&mesh);
    for step in 0..20 {
        let stroke = 5.45 + 0.005 * f64::from(step);
        let (walked, fresh) = (walker.at(stroke).unwrap(), mesh.at(stroke).unwrap());
        let off = walked.center_distance_mm - fresh.center_distance_mm;
        assert!(off.abs() < 1e-7, "{stroke}: {off} {} {}", walked.roll_rad, fresh.roll_rad);
    }
}
