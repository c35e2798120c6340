//! `--teeth`: parts with their teeth, through the exact mesh.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use super::bar::Bar;
use super::{Args, Ending, NO_LIMITS, mesh_basis};
use crate::batch::{RowFormat, Teeth, TeethRequest};
use crate::cli::long::Interruption;
use crate::cli::output::{Failure, Output, Status};
use crate::cli::{spec_files, tables};
use crate::diagnostic::{Code, Diagnostic};
use crate::judge::LimitTarget;
use crate::parallel::cores;
use crate::report::Format;
use crate::spec::Spec;

impl Args {
    /// Parts with their teeth, through the exact mesh.
    pub(super) fn run_teeth(
        &self,
        spec: &Arc<Spec>,
        found: &mut tables::Files<'_>,
        (format, summary_format): (RowFormat, Format),
        interruption: &Interruption,
        output: &mut Output,
    ) -> Result<Status, Failure> {
        let rows = self.request(format, spec)?;
        let basis = mesh_basis(spec, &rows.rule);
        let request =
            TeethRequest { stroke_mm: self.range.stroke.ends()?, tolerance_mm: self.range.tolerance.mm(), rows };
        if self.only_failures && spec.limit_on(LimitTarget::CenterDistance).is_none() {
            output.diagnostic(&Diagnostic::warning(Code::UnjudgedLimit, NO_LIMITS));
        }
        let measured = spec_files::measured_tables(spec, &self.spec, output)?;
        let workers = self.threads.map_or_else(cores, usize::from);
        let paths = found.paths.clone();
        let files: Vec<&str> = paths.iter().map(String::as_str).collect();
        let inputs = spec_files::inputs(spec, &self.spec, &files);
        let columns = Teeth::columns_written(self.columns.as_deref())?;
        let mut targets = self.targets(format, &inputs, spec, &|| columns.clone())?;
        let mut teeth = Teeth::new(spec, &measured, request, targets.sinks(), workers)?;
        let mut bar = Bar::new(&files, "parts", output);
        let failed = Self::run_each(found, &mut bar, |table, _| {
            Ok((teeth.take(table)?, interruption.stop().load(Ordering::Relaxed)))
        })?;
        let finished = teeth.finish(interruption.stop(), &mut |progress| bar.show(progress));
        bar.finish();
        let (failed, inputs) = (&failed, &inputs);
        let ending = Ending { spec, targets, failed, basis, interruption, inputs };
        self.end(ending, finished, summary_format, output)
    }
}
