//! How many steps between teeth act at once, by the length of the path of contact. Made once for a pair; knows no error.

use super::field::ContactPath;
use super::levels::{Levels, SLACK};

/// The direction of the steps of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StepDirection {
    RackGrows,
    RackShrinks,
    PinionGrows,
    PinionShrinks,
}

impl StepDirection {
    pub(super) const ALL: [Self; 4] = [Self::RackGrows, Self::RackShrinks, Self::PinionGrows, Self::PinionShrinks];

    /// The length within which its steps add up, in pitches, of a path of contact.
    fn length(self, path: &ContactPath) -> f64 {
        match self {
            Self::RackGrows => path.ratio - 2.0 * path.offset,
            Self::RackShrinks => path.ratio + 2.0 * path.offset,
            Self::PinionGrows => path.ratio + 2.0 * path.offset - 1.0,
            Self::PinionShrinks => path.ratio - 2.0 * path.offset + 1.0,
        }
    }
}

/// How many steps of one way act at once.
#[derive(Debug)]
pub(super) struct Counts {
    /// On lines, whatever the errors.
    pub(super) on_lines: f64,
    /// On the nominal path, and how much less each further step lifts because edges stand back, mm.
    nominal: f64,
    stands_back: Vec<f64>,
    /// The most that can act at once, beside other errors and in the gaps of lines.
    beside_others: f64,
    in_gaps: f64,
}

impl Counts {
    pub(super) fn new(way: StepDirection, levels: &Levels, line: &ContactPath, gap_mm: f64) -> Self {
        let length = |path: &ContactPath| way.length(path);
        let at_least = |path: &ContactPath| (length(path) + SLACK).floor();
        let nominal = at_least(&levels.nominal().path);
        let mut stands_back = Vec::new();
        let mut count = nominal;
        while stands_back.last().is_none_or(|last: &f64| last.is_finite()) {
            count += 1.0;
            stands_back.push(levels.stands_back(length, count));
        }
        Self {
            on_lines: (length(line) - SLACK).floor(),
            nominal,
            stands_back,
            beside_others: at_least(&levels.last().path),
            in_gaps: at_least(&levels.level(2.0 * gap_mm).path),
        }
    }

    /// What steps in line lift at most. A further step that only edges reach lifts less, by what the edges stand back.
    pub(super) fn most(&self, step: f64) -> f64 {
        let mut count = self.nominal;
        let mut most = count * step;
        for &stands_back in &self.stands_back {
            count += 1.0;
            most = most.max(count * step - stands_back);
            // a step still farther out adds one step at most, and stands back by more
            if stands_back > step {
                break;
            }
        }
        most
    }

    /// What steps in line lift at most beside other errors, which may pay for what edges stand back.
    pub(super) fn most_raw(&self, step: f64) -> f64 {
        (self.beside_others * step).max(self.most(step))
    }

    /// How far steps in line may lower ΔCD, whichever flanks carry: flanks on edges, too, where lines leave gaps.
    pub(super) fn least_raw(&self, step: f64) -> f64 {
        self.in_gaps * step
    }
}
