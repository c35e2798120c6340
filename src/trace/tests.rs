use super::search::Search;
use super::{DiagnosisRequest, Overlay, TracePoint};
use crate::spec::{MeasuredTables, Spec};

const PAIR: &str = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 20\n[rack]\nface_width = 20\naddendum = 1.6\n\
                    tip_relief = { amount = \"15 um\", start = 0.4 }\n[pinion]\nteeth = 9\nhelix_angle = 15\n\
                    profile_shift = 0.3\nface_width = 26\ntip_diameter = 23.2\nprofile_slope = \"6 um\"\n";

/// What an error does, by straight lines over the rotation, is what the solved mesh has, but for a tenth: of every error of
/// every tooth, of either sign, beside another error.
#[test]
fn rough_effects_are_near_those_of_the_mesh() {
    const SIZE_MM: f64 = 0.02;
    let spec = PAIR.to_owned() + "[[rack.deviation]]\nteeth = 3\nthickness = \"12 um\"\n";
    let mesh = Spec::parse("pair.toml", &spec).unwrap().mesh(&MeasuredTables::default()).unwrap().mesh;
    let point = |at: i32| TracePoint { stroke_mm: 1.03 * f64::from(at), delta_cd_mm: 0.0 };
    let points: Vec<TracePoint> = (0..56).map(point).collect();
    let overlay = Overlay::of(&mesh, &points, false).unwrap();
    let search = Search::new(&mesh, &overlay, DiagnosisRequest { noise_mm: Some(1e-3), is_master: false });
    let sight = search.sight(&[], &search.points, false).unwrap();
    let lines = search.lines(&[], &sight.strokes_mm).unwrap();
    let mut compared = 0;
    for error in &search.candidates {
        for size_mm in [-SIZE_MM, SIZE_MM] {
            let exact = search.effect(&[], *error, size_mm, sight.curve()).unwrap();
            let rough = search.rough_effect(&[], *error, size_mm, &lines).unwrap();
            let square = |of: &mut dyn Iterator<Item = f64>| of.map(|mm| mm * mm).sum::<f64>().sqrt();
            let apart = square(&mut exact.iter().zip(&rough).map(|(exact, rough)| rough - exact));
            let most = 0.1 * square(&mut exact.iter().copied()) + 1e-3;
            assert!(apart <= most, "{error:?} {size_mm}: {apart} of {most}");
            compared += usize::from(most > 3e-3);
        }
    }
    assert!(compared > 50, "{compared}");
}
