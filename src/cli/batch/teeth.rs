//! `--teeth`: parts with their teeth, through the exact mesh.

use std::sync::Arc;

use super::bar::Bar;
use super::targets::Targets;
use super::{Args, Ending, NO_LIMITS};
use crate::batch::{RowFormat, Teeth, TeethRequest};
use crate::cli::output::{Failure, Output, Status};
use crate::cli::rows_format::RowsFormat;
use crate::cli::signals::Interruption;
use crate::cli::{spec_files, tables};
use crate::diagnostic::{Code, Diagnostic};
use crate::judge::LimitTarget;
use crate::parallel::cores;
use crate::report::{Basis, Format};
use crate::spec::Spec;

impl Args {
    /// Parts with their teeth, through the exact mesh.
    pub(super) fn run_teeth(
        &self,
        spec: &Arc<Spec>,
        (found, mut targets): (&mut tables::Files<'_>, Targets),
        (written, format, summary_format): (RowsFormat, RowFormat, Format),
        interruption: &Interruption,
        output: &mut Output,
    ) -> Result<Status, Failure> {
        let rows = self.request((written, format), spec)?;
        let basis = Basis::of_teeth(spec, &rows.rule);
        let columns = Teeth::columns_written(spec, rows.columns.as_deref())?;
        let request = TeethRequest {
            stroke_mm: self.range.stroke.ends(spec)?,
            tolerance_mm: self.range.tolerance.mm(),
            travel_mm: self.range.stroke.travel(spec)?,
            rows,
        };
        let has_limit = spec.limit_on(LimitTarget::CenterDistance).is_some() || !spec.function_limits.is_empty();
        if self.only_failures && !has_limit {
            output.diagnostic(&Diagnostic::warning(Code::UnjudgedLimit, NO_LIMITS));
        }
        let measured = spec_files::measured_tables(spec, &self.spec, output)?;
        let workers = self.threads.map_or_else(cores, usize::from);
        let mut teeth = Teeth::new(spec, &measured, request, targets.sinks(format, || columns)?, workers)?;
        let mut bar = Bar::new(&found.paths, "parts", output);
        let told = found.failed.len();
        let failed = Self::run_each(found, &mut bar, |table, _| Ok((teeth.take(table)?, interruption.came())))?;
        let finished = teeth.finish(interruption.stop(), &mut |progress| bar.show(progress));
        bar.finish();
        let ending = Ending { spec, targets, failed: &failed, told, basis, interruption };
        self.end(ending, finished, summary_format, output)
    }
}
