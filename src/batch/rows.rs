//! The row that is written for a part. Called by the row evaluator; computes nothing.

use super::evaluate::{Evaluator, Row};
use super::number::Decimals;
use super::number::Places;
use super::output::Output;
use super::request::RowFormat;
use super::results::{Results, exact_result, fixed_spread, simulation_of, spread_of};
use super::uncertain::Known;
use super::write;
use crate::decision::uncertainty::Spreads;
use crate::decision::{Evaluation, Verdict};
use crate::formula::Fixed;
use crate::quantity::Length;

impl Evaluator<'_> {
    /// Writes the row; `false` if a digit takes exact arithmetic.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a call for each row costs a twentieth of all it takes")]
    pub(super) fn write_row(
        &mut self,
        row: Row<'_>,
        first_record: u64,
        results: &Results,
        spreads: Option<&Spreads>,
        verdict: Option<Verdict>,
    ) -> bool {
        let plan = self.plan;
        let Some(places) = &plan.places else { return false };
        self.out.room(40 * plan.outputs.len() + plan.names_length);
        for (index, output) in plan.outputs.iter().enumerate() {
            self.write_start(index);
            match output {
                Output::Id | Output::Copied(_) | Output::Verdict => {
                    self.write_text(row, first_record, index, verdict);
                    self.out.room(40 * plan.outputs.len() + plan.names_length);
                }
                Output::Standard(_)
                | Output::Expanded(_)
                | Output::Linear
                | Output::Conformance(_)
                | Output::Simulated(..)
                | Output::Validated => {
                    if !self.write_uncertain(output, places, results, spreads) {
                        return false;
                    }
                }
                output => {
                    if !places.write(&mut self.out, results.of(output)) {
                        return false;
                    }
                }
            }
        }
        self.write_end();
        true
    }

    /// Writes an output that takes the uncertainties; `false` if a digit takes exact arithmetic.
    #[inline(never)]
    fn write_uncertain(
        &mut self,
        output: &Output,
        places: &Places,
        results: &Results,
        spreads: Option<&Spreads>,
    ) -> bool {
        let Some(spreads) = spreads else { return false };
        let value = match output {
            Output::Standard(of) => {
                let spread = spread_of(spreads, *of);
                fixed_spread(spread.standard_mm, spread.rounding_mm)
            }
            Output::Expanded(of) => {
                let spread = spread_of(spreads, *of);
                fixed_spread(spread.coverage_factor * spread.standard_mm, spread.coverage_factor * spread.rounding_mm)
            }
            Output::Conformance(limit) => {
                /// What rounding of the results does to a probability, in 1e-15.
                const ROUNDING: i64 = 100_000;
                let probability = results.conformance(self.plan, spreads, *limit);
                #[expect(clippy::cast_possible_truncation, reason = "at most 10¹⁵")]
                let units = (probability * 1e15 + 0.5) as i64;
                Some(Fixed { units, bound: ROUNDING })
            }
            // simulations are no fast way
            Output::Simulated(..) | Output::Validated => return false,
            _ => {
                self.out.extend(if spreads.upper.folded { b"false" } else { b"true" });
                return true;
            }
        };
        value.is_some_and(|value| places.write(&mut self.out, value))
    }

    pub(super) fn write_exact_row(
        &mut self,
        row: Row<'_>,
        first_record: u64,
        evaluation: &Evaluation,
        known: Option<&Known>,
        verdict: Option<Verdict>,
    ) {
        let plan = self.plan;
        for (index, output) in plan.outputs.iter().enumerate() {
            self.out.room(plan.names_length + 8);
            self.write_start(index);
            match (exact_result(evaluation, plan, output), known) {
                (None, Some(known)) if output.is_uncertain() => {
                    let text = self.exact_uncertain(output, evaluation, known);
                    self.out.extend(text.as_bytes());
                }
                (None, _) => self.write_text(row, first_record, index, verdict),
                (Some(length), _) => {
                    let text = match plan.decimals {
                        Decimals::Places(places) => length.exact_mm().to_decimal_text(u16::from(places)),
                        Decimals::Full => crate::report::plain(length.mm()),
                    };
                    self.out.extend(text.as_bytes());
                }
            }
        }
        self.out.room(8);
        self.write_end();
    }

    /// The text of an output that takes the uncertainties.
    fn exact_uncertain(&self, output: &Output, evaluation: &Evaluation, known: &Known) -> String {
        let spreads = &known.spreads;
        let none = || if self.plan.format == RowFormat::JsonLines { "null".to_owned() } else { String::new() };
        let number = |value: f64| match (self.plan.decimals, Length::from_mm(value)) {
            (Decimals::Places(places), Ok(length)) => length.exact_mm().to_decimal_text(u16::from(places)),
            _ => crate::report::plain(value),
        };
        match output {
            Output::Standard(of) => number(spread_of(spreads, *of).standard_mm),
            Output::Expanded(of) => {
                let spread = spread_of(spreads, *of);
                number(spread.coverage_factor * spread.standard_mm)
            }
            Output::Conformance(limit) => {
                let decision = evaluation.limits.get(*limit).and_then(|check| check.decision.as_ref());
                let conformance = decision.and_then(|decision| decision.conformance);
                conformance.map_or_else(none, |conformance| number(conformance.probability))
            }
            Output::Simulated(of, statistic) => {
                known.simulation.as_ref().map_or_else(none, |part| number(statistic.of(simulation_of(part, *of))))
            }
            Output::Validated => known.validated.map_or_else(none, |validated| validated.to_string()),
            _ => (!spreads.upper.folded).to_string(),
        }
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

    /// The part's name, a copied field, or the verdict.
    fn write_text(&mut self, row: Row<'_>, first_record: u64, index: usize, verdict: Option<Verdict>) {
        let plan = self.plan;
        let field = match &plan.outputs[index] {
            Output::Id => row.id,
            Output::Copied(name) => {
                let earlier = plan.outputs[..index].iter().filter(|output| matches!(output, Output::Copied(_)));
                debug_assert!(!name.is_empty() || self.layout.copied.len() > earlier.clone().count());
                self.layout.copied.get(earlier.count()).and_then(|field| self.fields.get(*field)).copied()
            }
            _ => {
                let name = verdict.map(Verdict::name);
                return match (plan.format, name) {
                    (RowFormat::JsonLines, None) => self.out.extend(b"null"),
                    (RowFormat::JsonLines, Some(name)) => {
                        self.out.extend(b"\"");
                        self.out.extend(name.as_bytes());
                        self.out.extend(b"\"");
                    }
                    (_, name) => self.out.extend(name.unwrap_or("").as_bytes()),
                };
            }
        };
        if let Some(field) = field {
            let mut scratch = std::mem::take(&mut self.scratch);
            write::text(&mut self.out, field.content(row.bytes, &mut scratch), plan.format);
            self.scratch = scratch;
        } else {
            let number = (first_record + row.record - 1).to_string();
            write::text(&mut self.out, number.as_bytes(), plan.format);
        }
    }
}
