//! How often the error of a tooth is found in a measured curve: `cargo bench --bench diagnosis`. Synthetic traces of two turns
//! of the pinion at 0.1 mm with 1 µm of noise, of several pairs: with an error of a random tooth whose curve has an rms of
//! 1 µm at least, and without one. The strokes of every trace are shifted at random.

use std::ops::ControlFlow;
use std::time::Instant;

use rackmesh::deviation::Part;
use rackmesh::mesh::Mesh;
use rackmesh::spec::{MeasuredTables, Spec};
use rackmesh::trace::{Diagnosis, DiagnosisRequest, Overlay, ToothError, ToothErrorKind, TracePoint};

/// The pairs: contact ratios above and below 2, with and without ripple of their own.
const PAIRS: [&str; 4] = [
    "[pair]\nnormal_module = 2\nnormal_pressure_angle = 19.9\n[rack]\nface_width = 19.7\naddendum = 1.70\n[pinion]\nteeth = 8\n\
     helix_angle = 21\nprofile_shift = 0.3\nface_width = 30\ntip_diameter = 19.738\n",
    "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nface_width = 20\naddendum = 2\n[pinion]\nteeth = 12\n\
     profile_shift = 0.3\nface_width = 24\ntip_diameter = 29.2\n",
    "[pair]\nnormal_module = 1.9\nnormal_pressure_angle = 20\n[rack]\nface_width = 22\naddendum = 1.6\nhelix_angle = -8\n[pinion]\nteeth = 7\n\
     helix_angle = 28\nprofile_shift = 0.4\nface_width = 30\ntip_diameter = 20.2\n",
    "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nface_width = 20\naddendum = 1.6\ntip_relief = { amount = \"15 um\", start = 0.4 }\n\
     [pinion]\nteeth = 9\nhelix_angle = 15\nprofile_shift = 0.3\nface_width = 26\ntip_diameter = 23.2\nprofile_slope = \"6 um\"\n",
];
const SPACING_MM: f64 = 0.1;
const NOISE_MM: f64 = 1e-3;
const LEAST_RMS_MM: f64 = 1e-3;
/// The largest stroke shift, as a share of the pitch.
const LARGEST_SHIFT: f64 = 0.45;

/// Numbers between 0 and 1, the same ones every time.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// Of the normal distribution, by Box and Muller.
    #[expect(clippy::disallowed_methods, reason = "a bench need not be the same on every platform")]
    fn normal(&mut self) -> f64 {
        let (radius, angle) = ((-2.0 * (1.0 - self.unit()).ln()).sqrt(), std::f64::consts::TAU * self.unit());
        radius * angle.cos()
    }
}

fn mesh(text: &str) -> Mesh {
    let spec = Spec::parse("pair.toml", text).expect("the spec is right");
    spec.mesh(&MeasuredTables::default()).expect("the pair meshes").mesh
}

/// An error of a tooth: part, kind, tooth, size in µm.
type Error = (Part, ToothErrorKind, i64, f64);

/// The spec with the error.
fn with_error(pair: &str, (part, kind, tooth, um): Error, face_mm: f64) -> String {
    let size = match kind {
        ToothErrorKind::Lead => format!("\"{} rad\"", um / 1000.0 / face_mm),
        _ => format!("\"{um} um\""),
    };
    let part = part.name();
    format!("{pair}[[{part}.deviation]]\nteeth = {tooth}\n{kind} = {size}\n")
}

/// A trace, and the rms of what its error does.
fn trace(base: &Mesh, mesh: &Mesh, random: &mut Random) -> (Vec<TracePoint>, f64) {
    let turn = base.pair().rack().pitch_mm * f64::from(base.pair().pinion().teeth);
    let count = (2.0 * turn / SPACING_MM) as usize;
    let strokes: Vec<f64> = (0..=count).map(|at| at as f64 * SPACING_MM).collect();
    let curve = |mesh: &Mesh| -> Vec<f64> {
        mesh.sample(&strokes).into_iter().map(|point| point.expect("it meshes").delta_cd_mm).collect()
    };
    let (plain, wrong) = (curve(base), curve(mesh));
    let effect: Vec<f64> = wrong.iter().zip(&plain).map(|(wrong, plain)| wrong - plain).collect();
    let mean = effect.iter().sum::<f64>() / effect.len() as f64;
    let rms = (effect.iter().map(|mm| (mm - mean) * (mm - mean)).sum::<f64>() / effect.len() as f64).sqrt();
    let offset = 0.01 * (random.unit() - 0.5);
    let shift_mm = LARGEST_SHIFT * base.pair().rack().pitch_mm * (2.0 * random.unit() - 1.0);
    let points = strokes.iter().zip(&wrong);
    let points = points.map(|(stroke_mm, mm)| TracePoint {
        stroke_mm: stroke_mm + shift_mm,
        delta_cd_mm: mm + offset + NOISE_MM * random.normal(),
    });
    (points.collect(), rms)
}

fn diagnosed(base: &Mesh, points: &[TracePoint]) -> Diagnosis {
    let overlay = Overlay::of(base, points, true).expect("it meshes");
    let mut watch = |_, _| ControlFlow::Continue(());
    Diagnosis::of(base, &overlay, DiagnosisRequest::default(), &mut watch).expect("it meshes")
}

fn main() {
    let count: u32 = std::env::args().skip(1).find_map(|word| word.parse().ok()).unwrap_or(100);
    let verbose = std::env::args().any(|word| word == "--verbose");
    let mut random = Random(20_261_128);
    let (mut named, mut sized, mut first, mut seconds, mut slowest) = (0, 0, 0, 0.0, 0.0_f64);
    let mut tried = 0;
    while tried < count {
        let pair = PAIRS[random.below(PAIRS.len())];
        let base = mesh(pair);
        let part = [Part::Rack, Part::Pinion][random.below(2)];
        let kinds = ToothErrorKind::ALL.into_iter().filter(|kind| match part {
            Part::Rack => *kind != ToothErrorKind::Radial,
            Part::Pinion => !matches!(kind, ToothErrorKind::OverRoller | ToothErrorKind::Pitch),
        });
        let kinds: Vec<_> = kinds.collect();
        let teeth = base.pair().pinion().teeth as usize;
        let tooth = random.below(if part == Part::Rack { 2 * teeth + 1 } else { teeth }) as i64;
        let sign = if random.unit() < 0.5 { -1.0 } else { 1.0 };
        let um = sign * (5.0 + 35.0 * random.unit());
        let face_mm =
            if part == Part::Rack { base.pair().rack().face_width_mm } else { base.pair().pinion().face_width_mm };
        let error = (part, kinds[random.below(kinds.len())], tooth, um);
        let wrong = mesh(&with_error(pair, error, face_mm));
        let (points, rms) = trace(&base, &wrong, &mut random);
        if rms < LEAST_RMS_MM {
            continue;
        }
        tried += 1;
        let begun = Instant::now();
        let diagnosis = diagnosed(&base, &points);
        let took = begun.elapsed().as_secs_f64();
        (seconds, slowest) = (seconds + took, slowest.max(took));
        let of_first = diagnosis.errors.first();
        let off = |mm: f64| (1000.0 * mm - um).abs();
        // both signs of an error may be there
        let right = of_first.and_then(|found| {
            let own = std::iter::once((found.error, found.value_mm, found.interval_mm));
            let all =
                own.chain(found.alternatives.iter().map(|other| (other.error, other.value_mm, other.interval_mm)));
            let right = all.filter(|(found, ..)| (found.part, found.kind, found.tooth) == (error.0, error.1, error.2));
            right.min_by(|a, b| off(a.1).total_cmp(&off(b.1)))
        });
        // an end that the curve does not tell is open
        let is_open = right.is_some_and(|(.., interval)| {
            let [from, to] = interval.map(|end| end.map(|mm| 1000.0 * mm));
            (from.is_none() || to.is_none()) && from.is_none_or(|from| from <= um) && to.is_none_or(|to| um <= to)
        });
        let is_close = right.is_some_and(|(_, mm, _)| off(mm) <= 2.0);
        let is_sized = is_close || is_open;
        named += usize::from(right.is_some());
        sized += usize::from(is_sized);
        first += usize::from(of_first.is_some_and(|found| {
            (found.error.part, found.error.kind, found.error.tooth) == (error.0, error.1, error.2)
        }));
        if verbose || !is_sized {
            let found: Vec<String> = diagnosis
                .errors
                .iter()
                .map(|found| {
                    let ToothError { part, kind, tooth } = found.error;
                    format!(
                        "{} {kind} {tooth} {:+.1} ({} alternatives)",
                        part.name(),
                        1000.0 * found.value_mm,
                        found.alternatives.len()
                    )
                })
                .collect();
            println!(
                "  {:?} {} {} {um:+.1} µm, rms {:.1}: {} {right:?} open {is_open}",
                error.0,
                error.1,
                error.2,
                1000.0 * rms,
                found.join(", ")
            );
        }
    }
    println!(
        "{named} of {count} named, {first} of them first; {sized} of the right size, to 2 µm or within an open end; {:.2} s each, {slowest:.2} s at most",
        seconds / f64::from(count)
    );
    let mut alarms = 0;
    for at in 0..count as usize {
        let base = mesh(PAIRS[at % PAIRS.len()]);
        let (points, _) = trace(&base, &base, &mut random);
        alarms += usize::from(!diagnosed(&base, &points).errors.is_empty());
    }
    println!("{alarms} of {count} traces without an error get one");
}
