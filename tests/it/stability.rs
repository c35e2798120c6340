//! Numerical stability of the formulas and the exact mesh: inputs at the edges of every domain, relations between
//! related inputs that hold whatever the numbers are, monotone where physics says so, and the work that an answer
//! takes.
//!
//! The default run is short; `RACKMESH_LONG_TESTS=1` runs 40 times as many cases.
#![allow(clippy::pedantic, clippy::disallowed_methods)]

mod formulas;
mod scenes;

use crate::common::pairs::spur;
use crate::common::random::{self, Random};
use rackmesh::deviation::*;
use rackmesh::formula::{Influence, Law, Model};
use rackmesh::gear::{GeometryWarning, Pair, PairData, PinionData, RackData};
use rackmesh::mesh::{ContactKind, Mesh, MeshError, Sampler, Support, Work};
use rackmesh::quantity::{Angle, DomainError, Length};
use scenes::Scene;

fn cases(short: u64) -> std::ops::Range<u64> {
    0..if crate::common::is_long() { 40 * short } else { short }
}

fn mm(value: f64) -> Length {
    Length::from_mm(value).unwrap()
}

fn deg(value: f64) -> Angle {
    Angle::from_degrees(value).unwrap()
}

// ---- the mesh: scenes and what can be done to them -------------------------------------------------

/// Some strokes of a scene.
fn strokes(scene: &Scene, seed: u64) -> Vec<f64> {
    let mut random = Random(seed ^ 0x5eed);
    let p = scene.pitch();
    (0..12).map(|_| random.range(-3.0, 9.0) * p).collect()
}

// ---- the mesh: relations ---------------------------------------------------------------------------

#[test]
fn a_mirror_image_has_the_mirror_images_curve() {
    for seed in cases(60) {
        let mut scene = Scene::random(seed);
        scene.rack.retain(|d| !matches!(d.kind, RackDeviationKind::Pitch(_)));
        let (mesh, mirror) = (scene.mesh(), scene.mirrored().mesh());
        for s in strokes(&scene, seed) {
            let (a, b) = (mesh.at(s).unwrap(), mirror.at(-s).unwrap());
            assert!((a.delta_cd_mm - b.delta_cd_mm).abs() < 1e-11, "seed {seed}, stroke {s}: {a:?} {b:?}");
            assert!((a.pinion_angle_rad + b.pinion_angle_rad).abs() < 1e-12, "seed {seed}, stroke {s}");
        }
    }
}

#[test]
fn other_units_give_the_same_curve_in_other_units() {
    for seed in cases(40) {
        let scene = Scene::random(seed);
        let mesh = scene.mesh();
        for f in [1.0 / 256.0, 0.3, 64.0] {
            let scaled = scene.scaled(f).mesh();
            for s in strokes(&scene, seed) {
                let (a, b) = (mesh.at(s).unwrap().center_distance_mm, scaled.at(s * f).unwrap().center_distance_mm);
                assert!((a * f - b).abs() < 1e-12 * b, "seed {seed}, stroke {s}, factor {f}: {a} {b}");
            }
        }
    }
}

#[test]
fn teeth_numbered_from_elsewhere_are_the_same_teeth() {
    for seed in cases(60) {
        let scene = Scene::random(seed);
        let (mesh, next) = (scene.mesh(), scene.renumbered().mesh());
        for s in strokes(&scene, seed) {
            let (a, b) = (mesh.at(s).unwrap(), next.at(s + scene.pitch()).unwrap());
            assert!((a.delta_cd_mm - b.delta_cd_mm).abs() < 1e-10, "seed {seed}, stroke {s}: {a:?} {b:?}");
        }
    }
}

#[test]
fn parts_and_order_of_deviations_do_not_matter() {
    for seed in cases(60) {
        let scene = Scene::random(seed);
        let (mesh, split) = (scene.mesh(), scene.split(0.37).mesh());
        for s in strokes(&scene, seed) {
            let (a, b) = (mesh.at(s).unwrap().delta_cd_mm, split.at(s).unwrap().delta_cd_mm);
            assert!((a - b).abs() < 1e-10, "seed {seed}, stroke {s}: {a} {b}");
        }
    }
}

#[test]
fn strokes_may_come_in_any_order() {
    for seed in cases(40) {
        let scene = Scene::random(seed);
        let mesh = scene.mesh();
        let p = scene.pitch();
        let rising: Vec<f64> = (0..150).map(|i| p * (f64::from(i) * 0.041 - 1.0)).collect();
        let mut forth = Sampler::new(&mesh);
        let mut back = Sampler::new(&mesh);
        let forth: Vec<_> = rising.iter().map(|&s| forth.at(s).unwrap().delta_cd_mm).collect();
        let back: Vec<_> = rising.iter().rev().map(|&s| back.at(s).unwrap().delta_cd_mm).collect();
        for ((a, b), s) in forth.iter().zip(back.iter().rev()).zip(&rising) {
            assert!((a - b).abs() < 1e-10, "seed {seed}, stroke {s}: {a} {b}");
        }
    }
}

/// The relations hold for a rack that rolls, too, and rolling never lifts the pinion.
#[test]
fn a_rolling_rack_keeps_the_relations() {
    for seed in cases(4) {
        let mut scene = Scene::random(seed);
        scene.rack.retain(|d| !matches!(d.kind, RackDeviationKind::Pitch(_)));
        let held = scene.mesh();
        let m = scene.data.normal_module_mm;
        scene.support = Support::FreeRoll { axis_depth_mm: 3.0 * m };
        let (mesh, mirror, next) = (scene.mesh(), scene.mirrored().mesh(), scene.renumbered().mesh());
        for s in strokes(&scene, seed).into_iter().take(3) {
            let a = mesh.at(s).unwrap();
            let (b, c) = (mirror.at(-s).unwrap(), next.at(s + scene.pitch()).unwrap());
            assert!(a.delta_cd_mm <= held.at(s).unwrap().delta_cd_mm + 1e-10, "seed {seed}, stroke {s}");
            assert!((a.delta_cd_mm - b.delta_cd_mm).abs() < 1e-9, "seed {seed}, stroke {s}: {a:?} {b:?}");
            assert!((a.delta_cd_mm - c.delta_cd_mm).abs() < 1e-9, "seed {seed}, stroke {s}: {a:?} {c:?}");
        }
    }
}

/// More material never lets the pinion sink.
#[test]
fn material_only_ever_lifts_the_pinion() {
    for seed in cases(60) {
        let scene = Scene::random(seed);
        let mut random = Random(seed ^ 0xface);
        let teeth = ToothRange::single(random.int(-2, 7)).unwrap();
        let pinion_tooth = ToothRange::single(random.int(0, i64::from(scene.data.pinion.teeth) - 1)).unwrap();
        let more = 10.0_f64.powf(random.range(-9.0, -1.5));
        let with = |change: &dyn Fn(&mut Scene)| {
            let mut other = scene.clone();
            change(&mut other);
            // a larger addendum or tip may leave no tooth tip: then there is nothing to compare
            Pair::new(&other.data).is_ok().then(|| other.mesh())
        };
        let rack = |kind| move |scene: &mut Scene| scene.rack.push(RackDeviation { teeth, kind });
        let pinion = |kind| move |scene: &mut Scene| scene.pinion.push(PinionDeviation { teeth: pinion_tooth, kind });
        let changes: [(&str, Option<Mesh>); 11] = [
            ("rack left", with(&rack(RackDeviationKind::Left(more)))),
            ("rack right", with(&rack(RackDeviationKind::Right(more)))),
            ("rack thickness", with(&rack(RackDeviationKind::Thickness(more)))),
            ("over-roller", with(&rack(RackDeviationKind::OverRoller(more)))),
            ("pinion left", with(&pinion(PinionDeviationKind::Left(more)))),
            ("pinion thickness", with(&pinion(PinionDeviationKind::Thickness(more)))),
            ("radial", with(&pinion(PinionDeviationKind::Radial(more)))),
            ("addendum", with(&|scene: &mut Scene| scene.data.rack.addendum_mm += more)),
            ("tip diameter", with(&|scene: &mut Scene| scene.data.pinion.tip_diameter_mm += more)),
            ("rack face", with(&|scene: &mut Scene| scene.data.rack.face_width_mm += more)),
            ("pinion face", with(&|scene: &mut Scene| scene.data.pinion.face_width_mm += more)),
        ];
        let mesh = scene.mesh();
        for s in strokes(&scene, seed).into_iter().take(4) {
            let before = mesh.at(s).unwrap().center_distance_mm;
            for (what, changed) in &changes {
                let Some(changed) = changed else { continue };
                let after = changed.at(s).unwrap().center_distance_mm;
                assert!(after >= before - 1e-11, "seed {seed}, stroke {s}, {what} +{more:e}: {before} → {after}");
            }
        }
    }
}

// ---- the mesh: edges of its domain -----------------------------------------------------------------

/// A pair for almost any numbers: diameters that suit them.
fn pair_of(module: f64, alpha: f64, helices: (f64, f64), teeth: u32, faces: (f64, f64)) -> Option<Pair> {
    let r = module * f64::from(teeth) / (2.0 * helices.1.cos());
    Pair::new(&PairData {
        normal_module_mm: module,
        normal_pressure_angle_rad: alpha,
        rack: RackData {
            helix_angle_rad: helices.0,
            face_width_mm: faces.0 * module,
            addendum_mm: 0.6 * module,
            tooth_thickness_mm: None,
        },
        pinion: PinionData {
            teeth,
            helix_angle_rad: helices.1,
            profile_shift: 0.3,
            tip_diameter_mm: 2.0 * (r + 0.9 * module),
            root_form_diameter_mm: None,
            face_width_mm: faces.1 * module,
            tooth_thickness_deviation_mm: 0.0,
        },
    })
    .ok()
}

/// Nominal pairs and disturbed ones at the ends of every range: an answer that says how it ended, or an error.
#[test]
fn extreme_pairs_have_an_answer_or_an_error() {
    const ALPHA: [f64; 6] = [1.0, 1.001, 14.5, 20.0, 44.999, 59.9];
    const HELIX: [f64; 9] = [0.0, 5e-324, 1e-12, -1e-6, 20.0, 45.0, -45.0, 79.0, -80.0];
    const TEETH: [u32; 7] = [1, 2, 5, 17, 60, 1000, 10_000];
    const FACE: [f64; 5] = [1e-3, 0.5, 10.0, 300.0, 1e5];
    let (mut solved, mut tried, mut unsettled) = (0, 0, 0);
    for seed in cases(30) {
        let mut random = Random(seed);
        let pick = |random: &mut Random, values: &[f64]| values[random.int(0, values.len() as i64 - 1) as usize];
        let alpha = pick(&mut random, &ALPHA).to_radians();
        let helices = (pick(&mut random, &HELIX).to_radians(), pick(&mut random, &HELIX).to_radians());
        let teeth = TEETH[random.int(0, 6) as usize];
        let faces = (pick(&mut random, &FACE), pick(&mut random, &FACE));
        let module = pick(&mut random, &[1e-3, 1.0, 2.5, 1e3]);
        let Some(pair) = pair_of(module, alpha, helices, teeth, faces) else { continue };
        let p = pair.rack().pitch_mm;
        let one = |kind| RackDeviation { teeth: ToothRange::ALL, kind };
        let lists = [vec![], vec![one(RackDeviationKind::Lead(1e-3)), one(RackDeviationKind::Pitch(1e-3 * module))]];
        for (list, disturbed) in lists.iter().zip([false, true]) {
            // a lead error may lead a helix of 80° out of its domain
            let Ok(rack) = RackFlanks::new(&pair, list) else { continue };
            let mesh = Mesh::new(pair, rack, PinionFlanks::nominal(&pair), Support::Fixed).unwrap();
            for s in [0.0, 0.3 * p, -7.77 * p, 1e6 * p] {
                tried += 1;
                match mesh.at(s) {
                    Ok(point) => {
                        solved += 1;
                        let what = || format!("seed {seed}, stroke {s}: {point:?}\n{pair:?}");
                        assert!(
                            point.center_distance_mm.is_finite() && point.pinion_angle_rad.is_finite(),
                            "{}",
                            what()
                        );
                        assert!(point.iterations <= 120, "{}", what());
                        let size = pair.pinion().tip_radius_mm;
                        // a face so narrow that flanks leave it at once makes the demand jump: no rotation balances it
                        unsettled += i32::from(!point.converged());
                        assert!(point.converged() || point.residual_mm != 0.0, "{}", what());
                        let line = |kind| kind == ContactKind::Line;
                        if !disturbed && line(point.right.contact) && line(point.left.contact) {
                            let rounding = 1e-13 * (size + (faces.0 + faces.1) * module) + f64::EPSILON * s.abs();
                            assert!(point.delta_cd_mm.abs() <= pair.gain().max(1.0) * rounding * 10.0, "{}", what());
                        }
                    }
                    Err(MeshError::NoContact { .. } | MeshError::RackToothOrder { .. }) => {}
                    // the flanks of a single tooth start above its middle; crossed faces narrower than a module may
                    // hold no flank
                    Err(MeshError::TipOnTip { .. }) if disturbed || teeth == 1 || faces.0.min(faces.1) < 1.0 => {}
                    Err(other) => panic!("seed {seed}, stroke {s}, disturbed {disturbed}: {other}\n{pair:?}"),
                }
            }
        }
    }
    println!("{solved} of {tried} positions solved, {unsettled} without balance");
    assert!(solved * 2 > tried && solved > 75 && unsettled * 8 < solved, "{solved} of {tried}, {unsettled}");
}

/// Where a flank pair reaches the end of its contact the curve goes on: the line of contact meets the tip edge there,
/// and one stroke of rounding decides which of them is named.
#[test]
fn contact_exactly_at_an_edge_is_as_contact_next_to_it() {
    // the roll angle at the contact is ν − c, linear in the stroke: at the tip for this one
    let pair = Pair::new(&spur()).unwrap();
    let mesh = Mesh::nominal(pair).unwrap();
    let p = *pair.pinion();
    let alpha = p.transverse_pressure_angle_rad;
    let per_mm = pair.rotation_per_stroke_rad();
    for roll in [p.tip_roll_rad, p.start_roll_rad] {
        // c of tooth 0 is (1/2) 2π/z − s 2π/(z p) − ψ_b, and ν = π/2 − … measured from the same line: solve for s
        let at_pitch_point = alpha.tan();
        let s = (roll - at_pitch_point) / per_mm;
        for s in [s.next_down(), s, s.next_up(), -s, s + 1e-12, s - 1e-12] {
            let point = mesh.at(s).unwrap();
            assert!(point.converged() && point.delta_cd_mm.abs() < 1e-12, "{point:?}");
        }
    }
    // with deviations every change of contact is an edge: the curve has no gap there
    for seed in cases(6) {
        let scene = Scene::random(seed);
        let mesh = scene.mesh();
        let p = scene.pitch();
        let curve = mesh.curve(0.0, 2.0 * p, 1e-4).unwrap();
        for kink in &curve.kinks {
            let at = |s: f64| mesh.at(s).unwrap().delta_cd_mm;
            let here = at(kink.stroke_mm);
            for s in
                [kink.stroke_mm.next_down(), kink.stroke_mm.next_up(), kink.stroke_mm - 1e-9, kink.stroke_mm + 1e-9]
            {
                assert!((at(s) - here).abs() < 1e-8, "seed {seed}, stroke {s}: {} {here}", at(s));
            }
        }
    }
}

/// Two teeth that ask for exactly the same: the answer is theirs, and the same bits every time.
#[test]
fn tied_teeth_do_not_flicker() {
    let pair = Pair::new(&spur()).unwrap();
    let thick =
        |tooth| RackDeviation { teeth: ToothRange::single(tooth).unwrap(), kind: RackDeviationKind::Thickness(0.02) };
    let mesh = |list: &[RackDeviation]| {
        Mesh::new(pair, RackFlanks::new(&pair, list).unwrap(), PinionFlanks::nominal(&pair), Support::Fixed).unwrap()
    };
    let (one, two) = (mesh(&[thick(3)]), mesh(&[thick(3), thick(4)]));
    let expected = 0.02 / (2.0 * 20.0_f64.to_radians().tan());
    let s = 3.5 * pair.rack().pitch_mm;
    let both = two.at(s).unwrap();
    assert!((both.delta_cd_mm - expected).abs() < 1e-12, "{both:?}");
    assert!(one.at(s).unwrap().delta_cd_mm <= both.delta_cd_mm + 1e-12);
    let mut sampler = Sampler::new(&two);
    for _ in 0..50 {
        let again = sampler.at(s).unwrap();
        assert_eq!((again.right, again.left), (both.right, both.left));
        assert_eq!(again.delta_cd_mm.to_bits(), sampler.at(s).unwrap().delta_cd_mm.to_bits());
    }
}

/// Faces that cover each other at one point only, crossed at a right angle: there is contact when a flank stands just
/// there, and none otherwise.
#[test]
fn faces_that_never_meet_are_no_contact() {
    let eighth = std::f64::consts::FRAC_PI_4;
    let pair = pair_of(2.0, 20.0_f64.to_radians(), (eighth, eighth), 20, (5e-3, 5e-3)).unwrap();
    let mesh = Mesh::nominal(pair).unwrap();
    let ends: Vec<_> = (0..40).map(|i| mesh.at(f64::from(i) * 0.31)).collect();
    let none = ends.iter().filter(|end| matches!(end, Err(MeshError::NoContact { .. }))).count();
    assert!(none >= 35, "{none} of {}: {ends:?}", ends.len());
    assert!(mesh.curve(0.0, 10.0, 1e-6).is_err());
}

/// Far out only the stroke's own digits limit the answer: the same stroke told from a near tooth gives the same.
#[test]
fn tooth_a_thousand_million_is_as_tooth_one() {
    for (seed, far) in cases(20).flat_map(|seed| [1_000_000_i64, -1_000_000, 1_000_000_000].map(|far| (seed, far))) {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let far = far - far % i64::from(pair.pinion().teeth);
        let p = pair.rack().pitch_mm;
        let (lead, shift) = (random.range(-0.01, 0.01), random.range(-0.05, 0.05));
        let mesh = |first: i64| {
            let list = [
                RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Lead(lead) },
                RackDeviation {
                    teeth: ToothRange::new(Some(first), None).unwrap(),
                    kind: RackDeviationKind::Shift(shift),
                },
            ];
            Mesh::new(pair, RackFlanks::new(&pair, &list).unwrap(), PinionFlanks::nominal(&pair), Support::Fixed)
                .unwrap()
        };
        // s − far p without rounding: the product's error is a fused multiply-add away, and s is next to it
        let product = far as f64 * p;
        let s = product + random.range(-1.0, 1.0) * p;
        let here = (s - product) - (far as f64).mul_add(p, -product);
        let (a, b) = (mesh(far + 1).at(s).unwrap(), mesh(1).at(here).unwrap());
        assert!(
            (a.delta_cd_mm - b.delta_cd_mm).abs() < 1e-11,
            "seed {seed}, {far}: {} {}",
            a.delta_cd_mm,
            b.delta_cd_mm
        );
        assert_eq!(a.right.rack_tooth - far, b.right.rack_tooth);
    }
}

/// A flat flank makes everything sensitive, and the pair says so with the number.
#[test]
fn a_sensitive_pair_says_so() {
    let warned = |degrees: f64| {
        let pair = pair_of(2.0, degrees.to_radians(), (0.0, 0.2), 100, (10.0, 10.0)).unwrap();
        let found = pair.warnings().into_iter().find_map(|warning| match warning {
            GeometryWarning::Sensitive { gain, .. } => Some(gain),
            _ => None,
        });
        let list = |value| [RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::Right(value) }];
        let mesh = |value| {
            Mesh::new(pair, RackFlanks::new(&pair, &list(value)).unwrap(), PinionFlanks::nominal(&pair), Support::Fixed)
        };
        let moved = mesh(1e-6).unwrap().at(0.5).unwrap().delta_cd_mm - mesh(0.0).unwrap().at(0.5).unwrap().delta_cd_mm;
        assert!((moved / 1e-6 / pair.gain() - 1.0).abs() < 1e-4, "{degrees}°: {} {}", moved / 1e-6, pair.gain());
        found
    };
    assert_eq!((warned(20.0), warned(14.5)), (None, None));
    assert!(warned(8.0).is_some_and(|gain| (3.55..3.57).contains(&gain)));
}

// ---- the mesh: work --------------------------------------------------------------------------------

fn work(mesh: &Mesh, strokes: impl IntoIterator<Item = f64>) -> Work {
    let mut sampler = Sampler::new(mesh);
    for s in strokes {
        sampler.at(s).unwrap();
    }
    sampler.work()
}

fn rack_mesh(pair: &Pair, list: &[RackDeviation], support: Support) -> Mesh {
    Mesh::new(*pair, RackFlanks::new(pair, list).unwrap(), PinionFlanks::nominal(pair), support).unwrap()
}

#[test]
fn only_teeth_in_reach_are_looked_at_and_only_those_that_can_carry_are_searched() {
    let pair = Pair::new(&spur()).unwrap();
    let p = pair.rack().pitch_mm;
    let along = |n: u32| (0..n).map(move |i| f64::from(i) * 0.002 * p);
    let on = |range: ToothRange, kind| RackDeviation { teeth: range, kind };
    let fixed = |list: &[RackDeviation]| rack_mesh(&pair, list, Support::Fixed);

    let plain = work(&fixed(&[]), along(1000));
    assert_eq!(plain.strokes, 1000);
    // flanks that fit need one rotation; two pitches bring four teeth into reach beside those already there
    assert!(plain.rotations <= 1100, "{plain:?}");
    assert!(plain.prepared <= 2 * (pair.contact_ratio().total.ceil() as u64 + 12), "{plain:?}");
    assert!(plain.in_reach <= 14 * plain.rotations && plain.searched <= 4 * plain.rotations, "{plain:?}");

    // a deviation that no stroke reaches costs nothing; nor does a long rack
    let elsewhere = on(ToothRange::new(Some(1000), None).unwrap(), RackDeviationKind::Lead(0.01));
    assert_eq!(work(&fixed(&[elsewhere]), along(1000)), plain);

    // tilted flanks are searched more often, and a rolling rack tries many rotations
    let lead = on(ToothRange::ALL, RackDeviationKind::Lead(0.004));
    let tilted = work(&fixed(&[lead]), along(1000));
    assert!(tilted.searched > plain.searched && tilted.rotations > plain.rotations, "{tilted:?} {plain:?}");
    assert!(tilted.rotations <= 4 * tilted.strokes, "{tilted:?}");
    let rolling = rack_mesh(&pair, &[lead], Support::FreeRoll { axis_depth_mm: 8.0 });
    assert!(work(&rolling, along(20)).rotations > 20 * 4);

    // a neighbour's solution is a start: strokes near each other cost less than strokes apart
    let apart = work(&fixed(&[lead]), (0..1000).map(|i| f64::from(i) * 7.3 * p));
    assert!(apart.prepared > 4 * tilted.prepared && apart.searched > tilted.searched, "{apart:?} {tilted:?}");
}

#[test]
fn a_coarser_curve_solves_fewer_strokes() {
    let pair = Pair::new(&spur()).unwrap();
    let lead = RackDeviation { teeth: ToothRange::new(Some(2), None).unwrap(), kind: RackDeviationKind::Lead(0.004) };
    let mesh = rack_mesh(&pair, &[lead], Support::Fixed);
    let solved = |tolerance: f64| mesh.curve(0.0, 50.0, tolerance).unwrap().solved;
    let counts = [1e-2, 1e-4, 1e-6].map(solved);
    assert!(counts[0] <= counts[1] && counts[1] < counts[2], "{counts:?}");
    let nominal = rack_mesh(&pair, &[], Support::Fixed).curve(0.0, 50.0, 1e-6).unwrap();
    assert!(nominal.solved < counts[2] && nominal.resolved, "{} {counts:?}", nominal.solved);
}
