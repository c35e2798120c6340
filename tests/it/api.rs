//! What a program that uses the library may count on.

use std::error::Error;
use std::fmt::Debug;

fn error<T: Error + Debug + Send + Sync + 'static>() {}
fn value<T: Debug + Clone + Send + Sync + Unpin + 'static>() {}

/// Errors can be carried by any error type and across threads.
#[test]
fn errors_are_errors() {
    error::<rackmesh::quantity::DomainError>();
    error::<rackmesh::quantity::NumberError>();
    error::<rackmesh::quantity::QuantityError>();
    error::<rackmesh::gear::GeometryError>();
    error::<rackmesh::gear::GeometryWarning>();
    error::<rackmesh::deviation::DeviationError>();
    error::<rackmesh::deviation::ToothRangeError>();
    error::<rackmesh::standard::StandardError>();
    error::<rackmesh::mesh::MeshError>();
    error::<rackmesh::multibody::SimulationError>();
    error::<rackmesh::evaluation::EvaluationError>();
    error::<rackmesh::budget::BudgetError>();
    error::<rackmesh::judge::class::NoEffect>();
    error::<rackmesh::chance::MonteCarloError>();
    error::<rackmesh::chance::racks::RacksError>();
    error::<rackmesh::uncertainty::UncertaintyError>();
    error::<rackmesh::reproduction::ReproductionError>();
    error::<rackmesh::diagnostic::Diagnostics>();
    #[cfg(feature = "batch")]
    error::<rackmesh::batch::RunError>();
}

/// What is computed with can be shown, kept and handed to another thread.
#[test]
fn values_are_plain_values() {
    value::<rackmesh::quantity::Length>();
    value::<rackmesh::quantity::Angle>();
    value::<rackmesh::gear::Pair>();
    value::<rackmesh::gear::PairData>();
    value::<rackmesh::deviation::RackFlanks>();
    value::<rackmesh::deviation::PinionFlanks>();
    value::<rackmesh::formula::Law>();
    value::<rackmesh::formula::PartDeviation>();
    value::<rackmesh::standard::Wheel>();
    value::<rackmesh::standard::Permissible>();
    value::<rackmesh::mesh::Mesh>();
    value::<rackmesh::mesh::MeshPoint>();
    value::<rackmesh::mesh::Curve>();
    value::<rackmesh::mesh::Summary>();
    value::<rackmesh::multibody::Scene>();
    value::<rackmesh::multibody::Parameters>();
    value::<rackmesh::multibody::Outcome>();
    value::<rackmesh::evaluation::Evaluation>();
    value::<rackmesh::judge::Limit>();
    value::<rackmesh::judge::Rule>();
    value::<rackmesh::diagnostic::Diagnostic>();
    #[cfg(feature = "spec")]
    value::<rackmesh::spec::Spec>();
    #[cfg(feature = "report")]
    value::<rackmesh::report::Table>();
}
