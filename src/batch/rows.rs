//! The row that is written for a part. Called by the row evaluator; computes nothing.

use super::evaluate::{Evaluator, Row};
use super::number::{Decimals, Places};
use super::output::Output;
use super::request::RowFormat;
use super::results::{Results, spread_of};
use super::uncertain::RowUncertainty;
use super::write;
use crate::judge::Verdict;

impl Evaluator<'_> {
    /// Writes the row.
    #[inline]
    pub(super) fn write_row(
        &mut self,
        row: Row<'_>,
        results: &Results,
        uncertainty: Option<&RowUncertainty>,
        verdict: Option<Verdict>,
    ) {
        let plan = self.plan;
        self.out.room(40 * plan.outputs.len() + plan.names_length);
        for (index, output) in plan.outputs.iter().enumerate() {
            self.write_start(index);
            match output {
                Output::Id | Output::Copied(_) | Output::Verdict | Output::Without => {
                    self.write_text(row, index, verdict);
                    self.out.room(40 * plan.outputs.len() + plan.names_length);
                }
                output if output.is_uncertain() => self.write_uncertain(output, results, uncertainty),
                output => match (results.of(output), plan.decimals) {
                    (Some(result), Decimals::Places(places)) => Places::new(places).write(&mut self.out, result),
                    (Some(result), Decimals::Full) => {
                        self.out.extend(crate::quantity::plain(result.mm()).as_bytes());
                    }
                    (None, _) if plan.format == RowFormat::JsonLines => self.out.extend(b"null"),
                    (None, _) => {}
                },
            }
        }
        self.write_end();
    }

    /// Writes an output that takes the uncertainties; nothing, or null, where there is none.
    #[inline(never)]
    fn write_uncertain(&mut self, output: &Output, results: &Results, uncertainty: Option<&RowUncertainty>) {
        let number = |value: f64| self.plan.decimals.text(value);
        let written = uncertainty.and_then(|known| {
            Some(match output {
                Output::Standard(of) => number(spread_of(&known.spreads, *of).standard_mm),
                Output::Expanded(of) => {
                    let spread = spread_of(&known.spreads, *of);
                    number(spread.coverage_factor * spread.standard_mm)
                }
                Output::Conformance(limit) => {
                    number(known.inside(*limit).or_else(|| results.conformance(self.plan, &known.spreads, *limit))?)
                }
                Output::Simulated(of, statistic) => number(statistic.of(known.simulation_of(*of)?)),
                Output::Validated => known.validated?.to_string(),
                _ => (!known.spreads.upper.folded).to_string(),
            })
        });
        let none = if self.plan.format == RowFormat::JsonLines { "null" } else { "" };
        self.out.extend(written.as_deref().unwrap_or(none).as_bytes());
        self.out.room(40 * self.plan.outputs.len() + self.plan.names_length);
    }

    /// What stands before the value of the column with that index.
    #[inline]
    fn write_start(&mut self, index: usize) {
        match self.plan.format {
            RowFormat::Csv if index > 0 => self.out.byte(b','),
            RowFormat::Tsv if index > 0 => self.out.byte(b'\t'),
            RowFormat::Csv | RowFormat::Tsv => {}
            RowFormat::JsonLines => self.out.extend(&self.plan.json_names[index]),
        }
    }

    #[inline]
    fn write_end(&mut self) {
        if self.plan.format == RowFormat::JsonLines {
            self.out.byte(b'}');
        }
        self.out.byte(b'\n');
    }

    /// The part's name, a copied cell, the verdict, or what it is judged without.
    fn write_text(&mut self, row: Row<'_>, index: usize, verdict: Option<Verdict>) {
        let plan = self.plan;
        match &plan.outputs[index] {
            Output::Id => match row.block.name_bytes(row.index) {
                Some(name) => write::text(&mut self.out, name, plan.format),
                None => write::text(&mut self.out, row.id().as_bytes(), plan.format),
            },
            Output::Copied(_) => {
                let is_copied = |output: &&Output| matches!(output, Output::Copied(_));
                let number = plan.outputs[..index].iter().filter(is_copied).count();
                write::text(&mut self.out, row.block.copied(row.index, number).unwrap_or_default(), plan.format);
            }
            Output::Without => write::text(&mut self.out, plan.without.as_bytes(), plan.format),
            _ => match (plan.format, verdict.map(Verdict::name)) {
                (RowFormat::JsonLines, None) => self.out.extend(b"null"),
                (RowFormat::JsonLines, Some(name)) => {
                    self.out.extend(b"\"");
                    self.out.extend(name.as_bytes());
                    self.out.extend(b"\"");
                }
                (_, name) => self.out.extend(name.unwrap_or("").as_bytes()),
            },
        }
    }
}
