//! The remarks of a file. Each is counted for the rule that leaves it out, as it comes; of those that no rule leaves out the first are
//! kept.

use crate::table::contract::File;
use crate::table::layout::Layout;
use crate::table::ledger::Tally;
use crate::table::pattern::Pattern;

/// Remarks that are kept at most, and their bytes.
const MOST: usize = 1000;
const MOST_BYTES: usize = 1 << 20;

/// A remark on a value (K0009), an event in words (K0005), a remark on a part (K1900) or a characteristic (K2900), or a text under
/// a key that is not known. Each needs a rule.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Remark {
    /// Its key.
    pub(super) key: u16,
    /// Its line.
    pub(super) line: u32,
    /// What it says.
    pub(super) text: String,
}

/// The remarks of a file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Remarks {
    /// The first that no rule leaves out, and their bytes.
    pub(super) kept: Vec<Remark>,
    bytes: usize,
    /// How many more there are.
    pub(super) more: usize,
    /// The rules, with what each leaves out.
    pub(super) left_out: Vec<(Pattern, Tally)>,
}

impl Remark {
    /// Its place and what a rule is compared with.
    fn told(&self) -> (String, String) {
        (format!("line {}", self.line), format!("K{:04}: {}", self.key, self.text))
    }
}

impl Remarks {
    /// No remarks yet, and the rules for those to come.
    pub(super) fn of(rules: &[Pattern]) -> Self {
        let left_out = rules.iter().map(|rule| (rule.clone(), Tally::default())).collect();
        Self { left_out, ..Self::default() }
    }

    pub(super) fn add(&mut self, remark: Remark) {
        let (place, text) = remark.told();
        if let Some((_, tally)) = self.left_out.iter_mut().find(|(rule, _)| rule.fits(&text)) {
            tally.add(0, 0, &format!("{place}: {text}"));
        } else if self.kept.len() < MOST && self.bytes + remark.text.len() <= MOST_BYTES {
            self.bytes += remark.text.len();
            self.kept.push(remark);
        } else {
            self.more += 1;
        }
    }

    /// Tells a file its remarks.
    pub(super) fn tell(&self, file: &mut File<'_>, layout: &Layout) {
        file.more += self.more;
        for (place, text) in self.kept.iter().map(Remark::told) {
            file.comment(layout, &place, &text);
        }
        for (rule, tally) in &self.left_out {
            file.comments(layout, rule, tally);
        }
    }
}
