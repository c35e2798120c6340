//! The rejected rows of a run that are perhaps no parts, and the rules that leave them out.

use super::Guesses;
use super::block::lines;
use super::lines::Shapes;
use super::rules::{Suggestion, of_odd, settle};
use crate::table::block::{Block, Odd};

/// Rows that are kept, at most.
const MOST_ROWS: usize = 100;

/// Rejected rows that are perhaps no parts: by their name, or because nothing but it stands there.
#[derive(Debug, Default)]
pub(crate) struct OddRows {
    shapes: Shapes,
    rows: Vec<Odd>,
    count: usize,
}

impl OddRows {
    /// Adds those of the next block.
    pub(crate) fn add(&mut self, block: &mut Block) {
        if !self.shapes.is_full() {
            let rejected = block.rejected_rows();
            let names = (0..block.rows()).filter(|row| !rejected.contains(row)).filter_map(|row| block.name(row));
            names.for_each(|name| self.shapes.see(&name));
        }
        let odd = block.odd.drain(..).filter(|odd| odd.is_no_name || !odd.has_text);
        for row in odd {
            self.count += 1;
            if self.rows.len() < MOST_ROWS {
                self.rows.push(row);
            }
        }
    }

    /// One list of rules that leave all of them out; `None` if there are none. Where no part has a name to compare with, only a name that
    /// no part can have tells such a row.
    pub(crate) fn remedy(&self) -> Option<String> {
        let has_names = !self.shapes.is_empty();
        let odd = self.rows.iter().filter(|row| row.is_no_name || has_names);
        let mut rules: Vec<Suggestion> = odd.filter_map(|row| of_odd(row, &self.shapes)).collect();
        settle(&mut rules);
        let each: Vec<String> = rules.iter().flat_map(|known| lines(&known.rule, Guesses::Filled)).collect();
        let more = match self.count - self.rows.len() {
            0 => String::new(),
            more => format!(" and so on: {more} more are not looked at"),
        };
        (!each.is_empty()).then(|| {
            format!("rejected lines that may be no parts are left out by ignore_lines = [{}]{more}", each.join(", "))
        })
    }
}
