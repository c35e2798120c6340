//! The problems of a spec: the first hundred, and how many there are. The readers of the sections fill it. A spec with a
//! million mistakes is refused as fast as one with a few.

use crate::diagnostic::Diagnostic;

/// Problems that are put into words.
const SHOWN: usize = 100;

/// Problems as they are found.
#[derive(Debug, Default)]
pub(super) struct Found {
    first: Vec<Diagnostic>,
    count: usize,
}

impl Found {
    /// The number of all problems.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Adds a problem, which is put into words only if it is among the first.
    pub(super) fn add(&mut self, problem: impl FnOnce() -> Diagnostic) {
        self.count += 1;
        if self.count <= SHOWN {
            self.first.push(problem());
        }
    }

    /// The problems that are put into words, ordered by `key`, and one more that counts the others.
    pub(super) fn sorted<K: Ord>(mut self, key: impl Fn(&Diagnostic) -> K) -> Vec<Diagnostic> {
        self.first.sort_by_key(key);
        let more = self.count - self.first.len();
        if let Some(last) = self.first.last().filter(|_| more > 0) {
            let problems = if more == 1 { "1 more problem".to_owned() } else { format!("{more} more problems") };
            let counted =
                Diagnostic { severity: last.severity, ..Diagnostic::error(last.code, format!("and {problems}")) };
            self.first.push(counted);
        }
        self.first
    }
}

impl Extend<Diagnostic> for Found {
    fn extend<I: IntoIterator<Item = Diagnostic>>(&mut self, problems: I) {
        problems.into_iter().for_each(|problem| self.add(|| problem));
    }
}
