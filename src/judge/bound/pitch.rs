//! What steps between teeth do: how many of them act at once. Read by the bound; knows no other error.

use super::known::KnownPair;
use super::{ContactPath, ErrorRange, Extent};
use crate::deviation::Part;

/// Paths of contact this near to a whole number of pitches are taken for the worse.
const SLACK: f64 = 1e-9;

fn whole(pitches: f64) -> f64 {
    pitches.floor()
}

/// Steps of a part one way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Way {
    RackGrows,
    RackShrinks,
    PinionGrows,
    PinionShrinks,
}

impl Way {
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
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Counts {
    /// On lines, whatever the errors.
    on_lines: f64,
    /// On the nominal path, and how much less each further step lifts because edges stand back, mm.
    nominal: f64,
    stands_back: Vec<f64>,
    /// At most, beside other errors, and in the gaps of lines.
    beside_others: f64,
    in_gaps: f64,
}

impl Counts {
    pub(super) fn new(known: &KnownPair, way: Way) -> Self {
        let length = |path: &ContactPath| way.length(path);
        let at_least = |path: &ContactPath| whole(length(path) + SLACK);
        let nominal = at_least(&known.levels[0].path);
        let last = &known.levels[known.levels.len() - 1];
        let mut stands_back = Vec::new();
        let mut count = nominal;
        while stands_back.last().is_none_or(|last: &f64| last.is_finite()) {
            count += 1.0;
            stands_back.push(known.stands_back(length, count));
        }
        Self {
            on_lines: whole(length(&known.line) - SLACK),
            nominal,
            stands_back,
            beside_others: at_least(&last.path),
            in_gaps: at_least(&known.level(2.0 * known.gap()).path),
        }
    }

    /// What steps in line lift at most. One more that only edges reach lifts less by what those stand back.
    fn most(&self, step: f64) -> f64 {
        let mut count = self.nominal;
        let mut most = count * step;
        for &stands_back in &self.stands_back {
            count += 1.0;
            most = most.max(count * step - stands_back);
            // what is still farther out adds a step at most, and stands back by more
            if stands_back > step {
                break;
            }
        }
        most
    }

    /// What steps in line lift at most beside other errors, which may pay for what edges stand back.
    fn most_raw(&self, step: f64) -> f64 {
        (self.beside_others * step).max(self.most(step))
    }

    /// How far steps in line may lower, whichever flanks carry: those on edges, too, where lines leave gaps.
    fn least_raw(&self, step: f64) -> f64 {
        self.in_gaps * step
    }
}

/// Steps of ΔCD `step` each, of a pair.
pub(super) fn of_pair(part: Part, extent: Extent, grows: bool, step: f64, known: &KnownPair) -> ErrorRange {
    let range = match (part, extent) {
        (Part::Rack, Extent::One | Extent::Part | Extent::All) => {
            let (way, other) =
                if grows { (Way::RackGrows, Way::RackShrinks) } else { (Way::RackShrinks, Way::RackGrows) };
            let counts = known.counts(way);
            let raw_lower_mm = -known.counts(other).least_raw(step);
            let on_lines = (counts.on_lines - 1.0) * step;
            let lower_mm = if known.carries_lines() { on_lines.max(raw_lower_mm) } else { raw_lower_mm };
            ErrorRange {
                raw_lower_mm,
                lower_mm,
                upper_mm: counts.most(step),
                raw_upper_mm: counts.most_raw(step),
                in_contact: None,
            }
        }
        (Part::Rack, _) => {
            let keeps = known.carries_lines() && known.line.has_both_flanks_of_a_rack_tooth();
            either_sign(known, [Way::RackGrows, Way::RackShrinks], step, keeps)
        }
        (Part::Pinion, _) => {
            let keeps = known.carries_lines() && known.line.has_both_flanks_of_a_pinion_tooth();
            either_sign(known, [Way::PinionGrows, Way::PinionShrinks], step, keeps)
        }
    };
    limited(range, extent, step)
}

/// One step, of any pair.
pub(super) fn one_of_any_pair(step: f64, both_flanks: bool) -> ErrorRange {
    let lower_mm = if both_flanks { 0.0 } else { -step };
    ErrorRange { lower_mm, ..ErrorRange::either_way(step) }
}

fn either_sign(known: &KnownPair, ways: [Way; 2], step: f64, keeps: bool) -> ErrorRange {
    let largest =
        |of: fn(&Counts, f64) -> f64| ways.map(|way| of(known.counts(way), step)).into_iter().fold(0.0, f64::max);
    let raw = largest(Counts::least_raw);
    ErrorRange {
        raw_lower_mm: -raw,
        lower_mm: if keeps { 0.0 } else { -raw },
        upper_mm: largest(Counts::most),
        raw_upper_mm: largest(Counts::most_raw),
        in_contact: None,
    }
}

/// One step only, or a run that need not be where the teeth are in contact.
fn limited(range: ErrorRange, extent: Extent, step: f64) -> ErrorRange {
    let most = match extent {
        Extent::One => step,
        Extent::Part => f64::INFINITY,
        Extent::All | Extent::Each | Extent::Total => return range.counted(step),
    };
    let low = |value: f64| value.min(0.0).max(-most);
    let high = |value: f64| value.max(0.0).min(most);
    ErrorRange {
        raw_lower_mm: low(range.raw_lower_mm),
        lower_mm: low(range.lower_mm),
        upper_mm: high(range.upper_mm),
        raw_upper_mm: high(range.raw_upper_mm),
        in_contact: None,
    }
    .counted(step)
}

impl ErrorRange {
    /// With the number of steps that add up.
    fn counted(self, step: f64) -> Self {
        let count = (self.upper_mm / step - SLACK).ceil().clamp(0.0, 1e6) as u32;
        Self { in_contact: (step > 0.0).then_some(count), ..self }
    }
}
