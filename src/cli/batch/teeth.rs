//! `--teeth`: parts with their teeth, through the exact mesh.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::bar::Bar;
use super::{Args, Ending, NO_LIMITS, failures, unread};
use crate::batch::{Dialect, RowFormat, RunError, Teeth, TeethRequest};
use crate::cli::output::{Failure, Output, Status};
use crate::cli::{mesh, office};
use crate::decision::LimitTarget;
use crate::diagnostic::{Code, Diagnostic};
use crate::report::{Basis, Format};
use crate::spec::Spec;

impl Args {
    /// Parts with their teeth, through the exact mesh.
    pub(super) fn run_teeth(
        &self,
        spec: &Arc<Spec>,
        files: &[&str],
        (format, summary_format): (RowFormat, Format),
        stop: &Arc<AtomicBool>,
        output: &mut Output,
    ) -> Result<Status, Failure> {
        let rows = self.request(format, spec)?;
        if rows.rule.needs_uncertainty() {
            let message = format!("a mesh has no uncertainty of its own for the rule {}", rows.rule);
            return Err(Diagnostic::error(Code::BadRule, message)
                .help("give the guard band: --rule guard=VALUE")
                .into());
        }
        let request = TeethRequest {
            stroke_mm: (self.range.from.mm(), self.range.to.mm()),
            tolerance_mm: self.range.tolerance.mm(),
            decimals: self.decimals,
            format,
            columns: rows.columns,
            rows: rows.rows,
            statistics: rows.statistics,
            rule: rows.rule.clone(),
            id: self.id.clone(),
            strict: self.strict,
            failures_kept: rows.failures_kept,
            problems_kept: rows.problems_kept,
        };
        if self.only_failures && !spec.limits.iter().any(|(on, _)| *on == LimitTarget::CenterDistance) {
            output.diagnostic(&Diagnostic::warning(Code::UnjudgedLimit, NO_LIMITS));
        }
        let tables = mesh::measured_tables(spec, &self.spec)?;
        let dialect = Dialect { separator: self.separator, decimal_comma: self.decimal_comma };
        let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let workers = self.threads.map_or_else(cores, usize::from);
        let collected = office::Collected::default();
        let mut targets = self.targets(&collected, &|| Teeth::column_kinds(self.columns.as_deref()))?;
        let mut teeth = Teeth::new(spec, &tables, request, targets.sinks(), workers)?;
        let mut failed = Vec::new();
        let mut bar = Bar::new(files, "parts");
        for file in files {
            let input = self.table(file, spec, stop, dialect, None).map_err(failures);
            if let Ok((input, _)) = &input {
                let understood = teeth.understood(&input.header);
                if !understood.is_empty() {
                    output.remark(&format!("{}: {}", input.header.name, understood.join(", ")));
                }
            }
            match input.and_then(|(input, _)| {
                teeth.run(input, stop, &mut |progress| bar.show(progress)).map_err(|diagnostic| vec![diagnostic])
            }) {
                Ok(Ok(())) => {}
                Ok(Err(RunError::Read(error))) => failed.push(unread(file, &error)),
                Ok(Err(RunError::Write(error))) => return Err(Failure::Write(error)),
                Err(diagnostics) => failed.extend(diagnostics),
            }
            bar.next();
            if teeth.is_over() {
                break;
            }
        }
        bar.finish();
        let finished = teeth.finish();
        let limits = spec.limits();
        let judged = limits.into_iter().filter(|(on, _)| *on == LimitTarget::CenterDistance).collect();
        let basis = Basis {
            model: "exact mesh",
            stack: None,
            rule: rows.rule,
            limits: judged,
            quantity_limits: Teeth::quantity_limits(spec),
            taken_as_exact: Vec::new(),
        };
        let ending = Ending { spec, targets, collected: &collected, failed: &failed, basis, unjudged: false };
        self.end(ending, finished, summary_format, output)
    }
}
