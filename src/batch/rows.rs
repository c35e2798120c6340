//! The row that is written for a part.

use super::evaluate::{Evaluator, Row};
use super::number::Decimals;
use super::plan::Output;
use super::request::RowFormat;
use super::results::{Results, exact_result};
use super::write;
use crate::decision::{Evaluation, Verdict};

impl Evaluator<'_> {
    /// Writes the row; `false` if a digit takes exact arithmetic.
    #[inline]
    pub(super) fn write_row(
        &mut self,
        row: Row<'_>,
        first_record: u64,
        results: &Results,
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

    pub(super) fn write_exact_row(
        &mut self,
        row: Row<'_>,
        first_record: u64,
        evaluation: &Evaluation,
        verdict: Option<Verdict>,
    ) {
        let plan = self.plan;
        for (index, output) in plan.outputs.iter().enumerate() {
            self.out.room(plan.names_length + 8);
            self.write_start(index);
            match exact_result(evaluation, plan, output) {
                None => self.write_text(row, first_record, index, verdict),
                Some(length) => {
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
