//! Specs with limits near the bound: `eval` never passes where a placement in the exact mesh fails.

use std::fmt::Write as _;

use super::property::extremes;
use super::random::{self, Drawn, Random};
use crate::deviation::{DeviationKind, Extent};
use crate::evaluation::evaluate;
use crate::formula::Model;
use crate::gear::Pair;
use crate::judge::reached::placed::Placed;
use crate::judge::{Stack, Verdict};
use crate::parallel;
use crate::spec::Spec;

/// Specs of the default run, and of the long one.
const SPECS: usize = 100;
const LONG: usize = 5_000;
/// What the mesh may leave a limit by, mm.
const TOLERANCE_MM: f64 = 1e-9;

/// The geometry of a pair as a spec has it.
fn geometry(pair: &Pair) -> String {
    let (rack, pinion) = (pair.rack(), pair.pinion());
    format!(
        "[pair]\nnormal_module = {}\nnormal_pressure_angle = {:.9}\n\
         [rack]\nhelix_angle = {:.9}\nface_width = {}\naddendum = {}\ntooth_thickness = {}\n\
         [pinion]\nteeth = {}\nhelix_angle = {:.9}\nprofile_shift = {}\nface_width = {}\ntip_diameter = {}\n\
         root_form_diameter = {}\n",
        pair.normal_module_mm(),
        pair.normal_pressure_angle_rad().to_degrees(),
        rack.helix_angle_rad.to_degrees(),
        rack.face_width_mm,
        rack.addendum_mm,
        rack.tooth_thickness_mm,
        pinion.teeth,
        pinion.helix_angle_rad.to_degrees(),
        pinion.profile_shift,
        pinion.face_width_mm,
        2.0 * pinion.tip_radius_mm,
        2.0 * pinion.root_form_radius_mm,
    )
}

/// Errors of different kinds, as a spec has them and as they are put on teeth.
fn errors(random: &mut Random, pair: &Pair) -> (String, Vec<Drawn>) {
    let (mut text, mut drawn) = (String::from("[errors]\n"), Vec::new());
    for (kind, index) in DeviationKind::ALL.into_iter().zip(0..) {
        if !random.chance(0.4) {
            continue;
        }
        let is_pitch = matches!(kind, DeviationKind::RackPitch | DeviationKind::PinionPitch);
        let extent = Extent::EVERY[random.below(if is_pitch { 5 } else { 4 }) as usize];
        let size = random.sign() * random.range(0.0, 0.03);
        let value = if kind == DeviationKind::RackLead { size * 6.0 * std::f64::consts::PI / 180.0 } else { size };
        let one = random::drawn(pair, index, extent, value, None);
        let written = if kind == DeviationKind::RackLead { one.value.to_degrees() } else { one.value };
        let _ = writeln!(text, "{} = {{ value = {written:.12}, extent = \"{extent}\" }}", kind.key());
        drawn.push(one);
    }
    (text, drawn)
}

/// What is wrong with the verdict on a spec; `None` if there is nothing to judge.
fn check(seed: u64) -> Option<Result<Verdict, String>> {
    let mut random = Random(seed ^ 0x7665_7264_6963_7400);
    let geometry = geometry(&random::pair(&mut random));
    let pair = Spec::parse("pair", &geometry).ok()?.given_pair().ok()??;
    let (errors, drawn) = errors(&mut random, &pair.pair);
    if drawn.is_empty() {
        return None;
    }
    let text = |limits: &str| format!("{geometry}{errors}{limits}");
    let judged = |text: &str| {
        let spec = Spec::parse("spec", text).expect("the spec is valid");
        let (errors, basis) = (spec.part_deviations().expect("errors"), spec.basis().ok()?);
        evaluate(&errors, &spec.limits(), Model::Paper, Stack::Range, &basis).ok()
    };
    let range = judged(&text(""))?.combined.range.ok()?;
    let mut near = |end: f64| end + random.sign() * random.range(0.0, 0.02) * end.abs().max(0.01);
    let (a, b) = (near(range.lower.mm()), near(range.upper.mm()));
    let (lower, upper) = (a.min(b), a.max(b));
    let with_limits = text(&format!("[limits]\ncenter_distance = {{ lower = {lower:.9}, upper = {upper:.9} }}\n"));
    let verdict = judged(&with_limits)?.verdict?;
    let mut placed = Placed::new(&pair.pair);
    for one in &drawn {
        placed.put(&mut random, one);
    }
    let reached = extremes(&placed.mesh(&pair).ok()?, 24)?;
    let fails = reached.lower < lower - TOLERANCE_MM || reached.upper > upper + TOLERANCE_MM;
    if verdict == Verdict::Pass && fails {
        return Some(Err(format!("seed {seed}: reached {reached:?}\n{with_limits}")));
    }
    Some(Ok(verdict))
}

#[test]
fn a_pass_never_fails_in_the_mesh() {
    let long = std::env::var("RACKMESH_LONG_TESTS").is_ok_and(|value| value == "1");
    let specs = if long { LONG } else { SPECS };
    let (results, _) = parallel::map(parallel::cores(), specs, || (), |(), index| check(index as u64));
    let judged: Vec<_> = results.into_iter().flatten().collect();
    let passed = judged.iter().filter(|result| **result == Ok(Verdict::Pass)).count();
    println!("{} of {specs} specs are judged, {passed} pass", judged.len());
    for wrong in judged.iter().filter_map(|result| result.as_ref().err()).take(5) {
        println!("{wrong}");
    }
    assert!(judged.iter().all(Result::is_ok));
    // both verdicts come up
    assert!(5 * passed > judged.len() && 5 * passed < 4 * judged.len() && 10 * judged.len() > 8 * specs);
}
