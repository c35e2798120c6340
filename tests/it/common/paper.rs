//! The pair chosen for the paper's tables, with one deviation from tooth 4 on.

use super::pairs;
use rackmesh::deviation::*;
use rackmesh::gear::{Pair, PairData, PinionData, RackData};
use rackmesh::multibody::{Outcome, Parameters, Scene, Steady};

pub fn pair() -> Pair {
    let mut data = pairs::steering();
    data.pinion.face_width_mm = 25.0;
    Pair::new(&data).unwrap()
}

/// A spur pair with short teeth: over most of a pitch one tooth touches on each side.
pub fn spur() -> Pair {
    Pair::new(&PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: 20_f64.to_radians(),
        rack: RackData { helix_angle_rad: 0.0, face_width_mm: 15.0, addendum_mm: 1.2, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 20,
            helix_angle_rad: 0.0,
            profile_shift: 0.0,
            tip_diameter_mm: 42.1,
            root_form_diameter_mm: None,
            face_width_mm: 20.0,
            tooth_thickness_deviation_mm: 0.0,
        },
    })
    .unwrap()
}

pub fn scene(kind: Option<RackDeviationKind>, parameters: Parameters) -> Scene {
    let pair = pair();
    let teeth = "4..".parse().unwrap();
    let deviations: Vec<_> = kind.into_iter().map(|kind| RackDeviation { teeth, kind }).collect();
    let rack = RackFlanks::new(&pair, &deviations).unwrap();
    Scene::new(pair, rack, PinionFlanks::nominal(&pair), parameters).unwrap()
}

/// Mean ΔCD of the exact mesh over the same strokes.
pub fn rigid_mean(scene: &Scene, part: &Steady) -> f64 {
    let n = 400;
    let strokes: Vec<f64> =
        (0..n).map(|i| part.from_mm + (part.to_mm - part.from_mm) * (i as f64 + 0.5) / n as f64).collect();
    scene.mesh().sample(&strokes).into_iter().map(|point| point.unwrap().delta_cd_mm).sum::<f64>() / n as f64
}

/// The exact mesh's difference between both parts, and its nominal part.
pub fn rigid_difference(scene: &Scene, outcome: &Outcome) -> (f64, f64) {
    let mean = |part: Option<Steady>| part.map_or(f64::NAN, |part| rigid_mean(scene, &part));
    (mean(outcome.deviating) - mean(outcome.nominal), mean(outcome.nominal))
}
