//! `mesh --measured`: a measured curve is read like every table, and laid on the computed one.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;

use super::bar::Bar;
use super::mesh::Stroke;
use super::output::{Failure, Output};
use super::spec_files::refuse_shared_input;
use super::tables::{self, Opener, ReadArgs};
use crate::diagnostic::{Code, Diagnostic};
use crate::formula::Model;
use crate::mesh::Mesh;
use crate::quantity::Length;
use crate::report::TracePart;
use crate::spec::{MeshInput, Spec, keys};
use crate::table::{IsCurve, Layout, Trace};
use crate::trace::{Diagnosis, DiagnosisRequest, Overlay, TraceError};

#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "A measured curve")]
pub(super) struct TraceArgs {
    /// What was measured: a value, or in `mesh` a curve, as a table of stroke and ΔCD.
    ///
    /// The curve is laid on the computed one.
    #[arg(long, value_name = "TABLE", conflicts_with_all = ["step", "points"])]
    measured: Option<PathBuf>,
    /// Take the measured curve where it is: fit no offset and no stroke shift.
    #[arg(long, requires = "measured")]
    no_fit: bool,
    /// Name the teeth whose errors explain the measured curve.
    #[arg(long, requires = "measured")]
    diagnose: bool,
    /// Standard deviation of the measurement's noise. Default: estimated from the curve.
    #[arg(long, requires = "diagnose", allow_hyphen_values = true, value_name = "LENGTH")]
    noise: Option<Length>,
}

impl TraceArgs {
    /// The measured curve, if one is given.
    pub(super) fn read(&self, spec: &Spec, how: &ReadArgs, output: &mut Output) -> Result<Option<Trace>, Failure> {
        let Some(path) = &self.measured else { return Ok(None) };
        let spec_path = PathBuf::from(&spec.source.name);
        refuse_shared_input(&spec_path, std::slice::from_ref(path))?;
        let mut spec = how.laid_out(spec.clone())?;
        spec.table.layout = Arc::new(Layout { curve: IsCurve::Yes, ..Layout::clone(&spec.table.layout) });
        let stop = Arc::default();
        let opened = Opener::new(how, &Arc::new(spec), Model::Exact, &stop).open(path)?;
        let trace = Trace::of_table(opened.table)?;
        if output.keep_reading(&trace.reading) {
            tables::say(std::slice::from_ref(&trace.reading), &opened.notes, output);
        }
        Ok(Some(trace))
    }

    /// The strokes of the options, else the measured ones, else those of the spec.
    pub(super) fn ends(stroke: &Stroke, spec: &Spec, trace: Option<&Trace>) -> Result<(f64, f64), Failure> {
        let points = trace.and_then(|trace| Some((trace.points.first()?.stroke_mm, trace.points.last()?.stroke_mm)));
        points.map_or_else(|| stroke.ends(spec), |points| stroke.ends_or(points))
    }

    /// The files that are read, with that of the measured curve.
    pub(super) fn inputs(&self, files: Vec<PathBuf>) -> Vec<PathBuf> {
        files.into_iter().chain(self.measured.iter().flat_map(|path| tables::files_read(path))).collect()
    }

    /// A measured curve on that of a mesh, over the strokes from one to another.
    pub(super) fn part(
        &self,
        trace: Trace,
        spec: &Spec,
        input: &MeshInput,
        (from, to): (f64, f64),
        output: &Output,
    ) -> Result<TracePart, Failure> {
        let Trace { name, mut points, without_value, .. } = trace;
        let all = points.len();
        points.retain(|point| (from..=to).contains(&point.stroke_mm));
        let failed = |error| match error {
            TraceError::Mesh(error) => Diagnostic::from(error),
            TraceError::Interrupted => Diagnostic::error(Code::NoResult, error.to_string()),
            other => Diagnostic::error(Code::BadTable, format!("{name}: {other}")),
        };
        let overlay = Overlay::of(&input.mesh, &points, !self.no_fit).map_err(failed)?;
        let is_master = spec.get(keys::PINION_MASTER).unwrap_or_default();
        let noise_mm = self.noise.map(Length::mm);
        if noise_mm.is_some_and(|noise_mm| noise_mm <= 0.0) {
            return Err(Diagnostic::usage("--noise is above 0").into());
        }
        let request = DiagnosisRequest { noise_mm, is_master };
        let diagnosis = self.diagnose.then(|| diagnosed(&input.mesh, &overlay, request, output));
        let diagnosis = diagnosis.transpose().map_err(failed)?;
        let mut notes = Vec::new();
        let mut note = |count: u64, what: &str| {
            if count > 0 {
                notes.push(format!("{count} of the rows of {name} {what}"));
            }
        };
        note(without_value, "have no value, and are left out");
        note((all - points.len()) as u64, "are at strokes outside --from and --to, and are left out");
        if is_master && !(input.pinion_deviations.is_empty() && input.pinion_rows.is_empty()) {
            notes.push(
                "the pinion is a master, and the spec has errors of its teeth: they are computed, too".to_owned(),
            );
        }
        Ok(TracePart { file: name.clone(), overlay, is_master, pair: *input.mesh.pair(), diagnosis, notes })
    }
}

/// The errors that explain a measured curve, with the progress of the search.
fn diagnosed(
    mesh: &Mesh,
    overlay: &Overlay,
    request: DiagnosisRequest,
    output: &Output,
) -> Result<Diagnosis, TraceError> {
    let mut bar = Bar::new(output);
    let mut watch = |found: usize, share: f64| {
        // a search of less than a second shows nothing
        if bar.seconds() > 1.0 {
            bar.show(None, || format!("errors of teeth: {found} found, {:.0} % of the next ones tried", 100.0 * share));
        }
        ControlFlow::Continue(())
    };
    let diagnosis = Diagnosis::of(mesh, overlay, request, &mut watch);
    bar.finish();
    diagnosis
}
