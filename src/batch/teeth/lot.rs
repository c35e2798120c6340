//! The parts of one table of teeth, each solved and judged.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use super::{JudgedTeeth, TeethJudge, TeethRequest};
use crate::batch::outcome::{Part, RowPlace};
use crate::deviation;
use crate::diagnostic::Diagnostics;
use crate::function::{Check, JudgedYoke, Target, YokeJudge};
use crate::judge::{LimitTarget, NearestEnd, Verdict};
use crate::mesh::Summary;
use crate::spec::MeasuredTables;
use crate::table::{Encoding, LineFault, Place, ToothedPart};

/// The parts of one table.
pub(super) struct Lot {
    pub(super) parts: Vec<ToothedPart>,
    pub(super) part: deviation::Part,
    /// Whether the table names its parts.
    pub(super) has_names: bool,
    pub(super) file: Arc<str>,
    /// The unit that the number of a row's place counts.
    pub(super) unit: Place,
    pub(super) encoding: Encoding,
    /// The header as it stands in the file.
    pub(super) header: Vec<u8>,
    pub(super) judge: TeethJudge,
}

/// Refuses parts that two tables name, because neither has all of their rows.
pub(super) fn refuse_in_two(lots: &mut [Lot]) {
    let mut tables: HashMap<(deviation::Part, String), Vec<usize>> = HashMap::new();
    for (number, lot) in lots.iter().enumerate().filter(|(_, lot)| lot.has_names) {
        for part in &lot.parts {
            tables.entry((lot.part, part.name.clone())).or_default().push(number);
        }
    }
    let files: Vec<_> = lots.iter().map(|lot| Arc::clone(&lot.file)).collect();
    for (number, lot) in lots.iter_mut().enumerate() {
        for part in &mut lot.parts {
            let named = tables.get(&(lot.part, part.name.clone())).filter(|_| lot.has_names);
            let Some(other) = named.and_then(|tables| tables.iter().find(|other| **other != number)) else { continue };
            let message = format!("{} has rows of this part, too: put all of them into one table", files[*other]);
            part.fault.get_or_insert(LineFault { line: part.line, message });
        }
    }
}

/// A part's curve in short.
pub(super) struct Solved {
    pub(super) summary: Summary,
    pub(super) judged: JudgedTeeth,
    /// What the yoke does.
    pub(super) yoke: Option<Arc<JudgedYoke>>,
    /// From the first to the last stroke that is covered.
    pub(super) strokes: Range<f64>,
    /// Whether some strokes that were asked for are not covered.
    pub(super) is_cut: bool,
}

impl Solved {
    /// The outcome of the limits on the yoke.
    pub(super) fn checks(&self) -> &[Check] {
        self.yoke.as_ref().map_or(&[], |yoke| &yoke.checks)
    }

    /// The verdict on all limits.
    pub(super) fn verdict(&self) -> Option<Verdict> {
        self.judged.evaluation.verdict_with(self.checks())
    }

    pub(super) fn verdict_on(&self, on: Target) -> Option<String> {
        self.yoke.as_ref()?.verdict_on(on).map(|verdict| verdict.name().to_owned())
    }

    /// Whether the part fails by its status or a limit on its yoke, and breaks none on ΔCD.
    pub(super) fn fails_otherwise(&self) -> bool {
        let evaluation = &self.judged.evaluation;
        let is_inside = evaluation.verdict != Some(Verdict::Fail) || evaluation.rejection().is_some();
        self.verdict() == Some(Verdict::Fail) && is_inside
    }

    /// The end of the limit that the part is nearest to.
    pub(super) fn nearest(&self) -> Option<NearestEnd> {
        let mut checks = self.judged.evaluation.limits.iter().filter(|check| check.on == LimitTarget::CenterDistance);
        checks.find_map(|check| check.limit.nearest(self.judged.evaluation.judged.ok()?))
    }

    /// Why the part does not pass, or has no verdict.
    pub(super) fn reason(&self) -> Option<String> {
        let evaluation = &self.judged.evaluation;
        let of_limit = || Some(format!("ΔCD {}", self.nearest()?));
        let fails = evaluation.verdict == Some(Verdict::Fail);
        let of_errors = if fails { evaluation.rejection().or_else(of_limit) } else { evaluation.open_because() };
        let all: Vec<_> = of_errors.into_iter().chain(self.checks().iter().filter_map(Check::reason)).collect();
        (!all.is_empty()).then(|| all.join("; "))
    }
}

/// The part with its place and margin; without a limit, the margin is how far its largest ΔCD is below 0.
pub(super) fn judged_part(part: &ToothedPart, solved: &Solved, lot: &Lot) -> Part {
    let evaluation = &solved.judged.evaluation;
    // an open verdict counts as nearest to a limit
    let open = f64::INFINITY;
    let (lowest, highest) = evaluation.judged.map_or((-open, open), |range| (range.lower.mm(), range.upper.mm()));
    let nearest = solved.nearest();
    let without_limit = -highest.abs().max(lowest.abs());
    Part {
        id: part.name.clone(),
        place: lot.place(part.line, part.record),
        verdict: solved.verdict(),
        margin_mm: nearest.map_or(without_limit, |nearest| nearest.inside_by.mm()),
        on: nearest.map(|_| LimitTarget::CenterDistance),
        result_mm: (lowest, highest),
        reason: solved.reason(),
        errors: Vec::new(),
        yoke: solved.yoke.clone(),
        judged_by: evaluation.judged_by,
        is_rejected: evaluation.is_rejected,
        fails_otherwise: solved.fails_otherwise(),
    }
}

impl Lot {
    pub(super) fn place(&self, line: u64, record: u64) -> RowPlace {
        RowPlace { file: Arc::clone(&self.file), line, record, in_words: self.unit.in_words(line) }
    }

    /// Solves one of its parts; `tables` are those of the part that is the same for all.
    pub(super) fn solved(
        &self,
        part: &ToothedPart,
        tables: &MeasuredTables,
        request: &TeethRequest,
        yoke: Option<&YokeJudge>,
    ) -> Result<Solved, LineFault> {
        if let Some(fault) = &part.fault {
            return Err(fault.clone());
        }
        let bad = |message: String| LineFault { line: part.line, message };
        let (from, to) = request.stroke_mm;
        let tables = tables.clone().with(part.teeth.clone());
        let first = |problems: Diagnostics| {
            bad(problems.0.first().map_or_else(|| problems.to_string(), |problem| problem.message.clone()))
        };
        let input = self.judge.measured_only().mesh(&tables).map_err(first)?;
        let mut judged = self.judge.judge(&input, &tables).map_err(first)?;
        judged.evaluation.reject_if(part.rejected_on.is_some());
        // every tooth of a pinion is measured; for a rack take the strokes at which measured spaces carry
        let covered = match part.teeth.part() {
            deviation::Part::Rack => judged.strokes.clone(),
            deviation::Part::Pinion => from..to,
        };
        let strokes = from.max(covered.start)..to.min(covered.end);
        if strokes.start > strokes.end {
            return Err(bad(format!(
                "the strokes whose contacts were measured are {:.3} to {:.3} mm, and none of them is asked for: see --from and --to",
                covered.start, covered.end
            )));
        }
        let curve = input.mesh.curve(strokes.start, strokes.end, request.tolerance_mm);
        let curve = curve.map_err(|error| bad(error.to_string()))?;
        let summary = curve.summary(&input.mesh);
        let summary = summary.ok_or_else(|| bad("the exact mesh has no points along the stroke".to_owned()))?;
        let is_cut = strokes != (from..to);
        let yoke = yoke.map(|yoke| {
            let is_same = !is_cut && yoke.strokes_mm == (from, to);
            self.judge.yoke(yoke, &judged, (&input, &tables), is_same.then_some(&curve))
        });
        Ok(Solved { summary, judged, yoke: yoke.map(|yoke| Arc::new(yoke.in_short())), is_cut, strokes })
    }
}
