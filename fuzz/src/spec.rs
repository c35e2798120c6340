//! The spec reader: any text is read or refused, every refusal can be shown, and what was read can be
//! evaluated and meshed or says why not.

use rackmesh::evaluation::evaluate;
use rackmesh::formula::Model;
use rackmesh::judge::{Combined, Stack};
use rackmesh::spec::{MeasuredTables, Spec};

/// Reads the input as a spec and asks for everything that follows from it.
pub fn check(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let spec = match Spec::parse("fuzz.toml", text) {
        Ok(spec) => spec,
        Err(diagnostics) => {
            assert!(!diagnostics.to_string().is_empty());
            return;
        }
    };
    if let (Ok(errors), Ok(basis)) = (spec.part_deviations(), spec.basis())
        && let Ok(evaluation) = evaluate(&errors, &spec.limits(), Model::Exact, Stack::Range, &basis)
    {
        let Combined { range, rss } = evaluation.combined;
        assert!([range, rss].into_iter().flatten().all(|of| of.lower <= of.upper));
    }
    if let Ok(input) = spec.mesh(&MeasuredTables::default()) {
        for stroke in [0.0, 17.3] {
            if let Ok(point) = input.mesh.at(stroke) {
                assert!(point.delta_cd_mm.is_finite());
            }
        }
    }
}
