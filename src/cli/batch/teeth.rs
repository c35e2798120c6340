//! `--teeth`: parts with their teeth, through the exact mesh.

use std::sync::Arc;

use super::bar::Bar;
use super::{Args, Ending, NO_LIMITS, mesh_basis, unfinished};
use crate::batch::{RowFormat, Teeth, TeethRequest};
use crate::cli::long::Interruption;
use crate::cli::output::{Failure, Output, Status};
use crate::cli::{mesh, tables};
use crate::diagnostic::{Code, Diagnostic};
use crate::judge::LimitTarget;
use crate::parallel::cores;
use crate::report::Format;
use crate::spec::Spec;
use crate::table::Want;

impl Args {
    /// Parts with their teeth, through the exact mesh.
    pub(super) fn run_teeth(
        &self,
        spec: &Arc<Spec>,
        found: &mut tables::Files,
        (format, summary_format): (RowFormat, Format),
        interruption: &Interruption,
        output: &mut Output,
    ) -> Result<Status, Failure> {
        let rows = self.request(format, spec)?;
        let request = TeethRequest {
            stroke_mm: (self.range.stroke.from.mm(), self.range.stroke.to.mm()),
            tolerance_mm: self.range.tolerance.mm(),
            decimals: self.decimals,
            format,
            columns: rows.columns,
            rows: rows.rows,
            statistics: rows.statistics,
            rule: rows.rule.clone(),
            partial: self.partial,
            strict: self.strict,
            failures_kept: rows.failures_kept,
            problems_kept: rows.problems_kept,
        };
        if self.only_failures && !spec.limits.iter().any(|(on, _)| *on == LimitTarget::CenterDistance) {
            output.diagnostic(&Diagnostic::warning(Code::UnjudgedLimit, NO_LIMITS));
        }
        let measured = mesh::measured_tables(spec, &self.spec)?;
        let workers = self.threads.map_or_else(cores, usize::from);
        let paths = found.paths();
        let files: Vec<&str> = paths.iter().map(String::as_str).collect();
        let inputs = self.inputs(spec, &files);
        let mut targets = self.targets(&inputs, &|| Teeth::columns_written(self.columns.as_deref()))?;
        let mut teeth = Teeth::new(spec, &measured, request, targets.sinks(), workers)?;
        let mut failed = std::mem::take(&mut found.failed);
        let mut bar = Bar::new(&files, "parts", output);
        let adjust = |want: Want| Want { teeth: Some(true), ..want };
        for path in &files {
            let opened = match found.take_first() {
                Some(opened) => Ok(opened),
                None => self.reading.open(path, spec, self.model.into(), interruption.stop(), &adjust),
            };
            let run = opened.map_err(tables::diagnostics).and_then(|opened| {
                let run = teeth.run(opened.table, interruption.stop(), &mut |progress| bar.show(progress));
                run.map_err(|diagnostics| diagnostics.0)
            });
            match run {
                Ok(run) => failed.extend(unfinished(path, run)?),
                Err(diagnostics) => failed.extend(diagnostics),
            }
            bar.next();
            if teeth.is_over() {
                break;
            }
        }
        bar.finish();
        let finished = teeth.finish();
        let basis = mesh_basis(spec, &rows.rule);
        let (failed, inputs) = (&failed, &inputs);
        let ending = Ending { spec, targets, failed, basis, interruption, inputs };
        self.end(ending, finished, summary_format, output)
    }
}
