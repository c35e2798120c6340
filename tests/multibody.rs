//! The multibody model against the exact mesh, and its own promises.
#![allow(missing_docs, clippy::pedantic, clippy::disallowed_methods)]

mod common;

use std::ops::ControlFlow;

use common::paper;
use rackmesh::deviation::*;
use rackmesh::multibody::*;

fn go_on(_: &Sample) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn analytic() -> Parameters {
    Parameters { contact: ContactModel::Analytic(StripGrid::default()), ..Parameters::default() }
}

/// Every kind of the paper's errors, with what the exact mesh allows.
fn rows() -> Vec<(RackDeviationKind, f64)> {
    let mut rows = Vec::new();
    for e in [0.01, 0.02, 0.03, -0.01, -0.02, -0.03] {
        rows.push((RackDeviationKind::OverRoller(e), 2e-4));
    }
    for e in [0.02, -0.02] {
        rows.push((RackDeviationKind::Pitch(e), 1e-3));
        rows.push((RackDeviationKind::Lead((12.5 * e).to_radians()), 0.02 * 0.118));
    }
    rows
}

#[test]
fn quasi_static_differences_are_those_of_the_exact_mesh() {
    for parameters in [Parameters::default(), analytic()] {
        for (kind, allowed) in rows() {
            let scene = paper::scene(Some(kind), parameters);
            let outcome = scene.quasi_static(&mut go_on);
            assert_eq!(outcome.end, RunEnd::Completed);
            let (rigid, _) = paper::rigid_difference(&scene, &outcome);
            let found = outcome.rigid_difference_mm().unwrap();
            assert!((found - rigid).abs() <= allowed, "{kind:?}: {found} {rigid}");
        }
    }
}

#[test]
fn a_run_that_is_told_to_stop_keeps_what_it_has() {
    let scene = paper::scene(None, Parameters { stroke_mm: 1.0, ..Parameters::default() });
    let mut seen = 0;
    let outcome = scene.quasi_static(&mut |_| {
        seen += 1;
        if seen == 4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!(outcome.end, RunEnd::Interrupted);
    assert_eq!(outcome.samples.len(), 4);
    let whole = scene.quasi_static(&mut go_on);
    assert_eq!(whole.samples.len(), 11);
    assert_eq!(outcome.samples[..], whole.samples[..4]);
}
