//! The refusal of a table that is not closed.

use super::proposal::{LineAccount, Proposal, REJECTED};
use crate::diagnostic::{Code, Diagnostic, ListLine};
use crate::quantity::shown;
use crate::table::block::Odd;
use crate::table::contract::Open;
use crate::table::layout::IsCurve;
use crate::table::propose::Guesses;

impl Proposal {
    /// The refusal: what has no owner, how the file differs from its contract, and the `[table]` that closes it.
    #[must_use]
    pub fn refusal(&self) -> Diagnostic {
        self.refused(Some(&self.block(Guesses::Shown)))
    }

    /// The same with the `[table]` that closes several tables, or with none.
    #[must_use]
    pub fn refused(&self, block: Option<&str>) -> Diagnostic {
        const SHOWN: usize = 40;
        // a block of one line is `[table]` alone, which closes nothing
        let block = block.filter(|block| block.lines().count() > 1);
        // no block takes the place of a column that is gone
        let block = block.filter(|_| !self.open.iter().any(|open| matches!(open, Open::Missing { .. })));
        let lines = self.rejected_lines().map(|line| format!("{}: {}: {}", line.place, line.is, shown(&line.text)));
        let count = self.open.len() + self.more + self.rejected_lines().count();
        let mut list: Vec<String> = self.open.iter().map(Open::in_words).chain(lines).take(SHOWN).collect();
        if let more @ 1.. = count.saturating_sub(SHOWN) {
            list.push(format!("and {more} more"));
        }
        list.extend(block.map(|_| "what closes the table, in the spec:".to_owned()));
        let mut list: Vec<_> = list.into_iter().map(|text| ListLine { text, is_copied: false }).collect();
        let copied = block.into_iter().flat_map(str::lines);
        list.extend(copied.map(|line| ListLine { text: format!("  {line}"), is_copied: true }));
        let of_columns =
            |open: &&Open| matches!(open, Open::Column { .. } | Open::Characteristic { .. } | Open::Missing { .. });
        let different = || self.open.iter().filter(of_columns);
        let mut difference: Vec<_> = different().take(SHOWN).map(Open::difference).collect();
        if let more @ 1.. = (different().count() + self.more).saturating_sub(SHOWN) {
            difference.push(format!("and {more} more"));
        }
        let layout = &self.rules.layout;
        let message = if difference.is_empty() || !layout.is_written {
            let things = if count == 1 { "a cell or line has" } else { "cells or lines have" };
            format!("{}: {things} no owner, so nothing is judged:", self.file)
        } else {
            format!("{}: it is not as its contract says, so nothing is judged: {}", self.file, difference.join("; "))
        };
        let others = self.open.iter().filter_map(|open| match open {
            Open::Wrong { help, .. } if !help.is_empty() => Some(help.as_str()),
            _ => None,
        });
        let how = match block {
            None if others.clone().next().is_some() => None,
            _ if layout.curve == IsCurve::Yes => {
                Some("write these lines into the spec, or say it with --column 'delta_cd=NAME[um]'")
            }
            _ if layout.is_written => Some(
                "say what each is, or that it is not used: `rackmesh read FILE SPEC --write` writes it into the spec",
            ),
            _ => Some(
                "no contract says yet what each is, or that it is not used: `rackmesh read FILE SPEC --write` writes one into the spec",
            ),
        };
        let help = how.into_iter().chain(others).collect::<Vec<_>>().join("; ");
        Diagnostic { list: list.into(), ..Diagnostic::error(Code::NotUnderstood, message) }.help(help)
    }

    /// How the file differs from its contract: `new column "Spindel"`, `column "fp" is gone`.
    #[must_use]
    pub fn difference(&self) -> Vec<String> {
        let of_open = self.open.iter().map(Open::difference);
        of_open.chain(self.rejected_lines().map(|line| format!("new {} {}", line.place, quoted(&line.text)))).collect()
    }

    fn rejected_lines(&self) -> impl Iterator<Item = &LineAccount> {
        self.lines.iter().filter(|line| line.is == REJECTED)
    }
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", shown(text))
}

impl Open {
    /// How this differs from the contract.
    fn difference(&self) -> String {
        match self {
            Self::Column { place, title, .. } if title.is_empty() => format!("new column {}", place + 1),
            Self::Column { title, .. } => format!("new column {}", quoted(title)),
            Self::Characteristic { title, .. } => format!("new characteristic {}", quoted(title)),
            Self::Missing { name, .. } => format!("column {} is gone", quoted(name)),
            Self::Line { line, text, .. } | Self::Row(Odd { line, text, .. }) => {
                format!("new line {line} {}", quoted(text))
            }
            Self::Comment { place, text } => format!("new comment in {place} {}", quoted(text)),
            other => other.in_words(),
        }
    }
}
