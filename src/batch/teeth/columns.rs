//! The row of a part with its teeth. The batch of such parts calls it; it computes nothing.

use std::ops::Range;

use super::lot::Solved;
use crate::batch::columns::ColumnKind;
use crate::batch::output::End;
use crate::diagnostic::{Diagnostic, nearest_or};
use crate::function::{FIGURES, Figure, KNOWN_FIGURES, Target};
use crate::quantity::tidy;
use crate::table::ToothedPart;

/// A column that is written.
#[derive(Debug, Clone, Copy)]
pub(super) enum Column {
    /// A text about a part.
    Text(fn(&ToothedPart, &Solved) -> Option<String>),
    /// A result, mm.
    Number(NumberOf),
    /// An end of the judged range, mm.
    End(End, NumberOf),
    /// A figure of the yoke.
    Yoke(Figure),
}

/// A result; `None` if there is none.
type NumberOf = fn(&Solved) -> Option<f64>;

impl Column {
    pub(super) const fn kind(self) -> ColumnKind {
        match self {
            Self::Text(_) => ColumnKind::Text,
            Self::Number(_) | Self::End(..) | Self::Yoke(_) => ColumnKind::Number,
        }
    }

    /// The result without digits that are rounding of the solution; `None` if there is none.
    pub(super) fn number(self, solved: &Solved) -> Option<f64> {
        match self {
            Self::Number(of) | Self::End(_, of) => of(solved).map(tidy),
            Self::Yoke(of) => of(solved.yoke.as_ref()?).map(tidy),
            Self::Text(_) => None,
        }
    }
}

/// The columns that can be written; the first of them are the default.
pub(super) const COLUMNS: [(&str, Column); 17] = [
    ("part_id", Column::Text(|part, _| Some(part.name.clone()))),
    ("mean_delta_cd_mm", Column::Number(|solved| Some(solved.summary.mean_mm))),
    ("min_delta_cd_mm", Column::Number(|solved| Some(solved.summary.min_mm))),
    ("max_delta_cd_mm", Column::Number(|solved| Some(solved.summary.max_mm))),
    ("peak_to_peak_mm", Column::Number(|solved| Some(solved.summary.peak_to_peak_mm))),
    ("tooth_to_tooth_mm", Column::Number(|solved| Some(solved.summary.tooth_to_tooth_mm))),
    ("lower_mm", Column::End(End::Lower, |solved| Some(solved.judged.evaluation.judged.ok()?.lower.mm()))),
    ("upper_mm", Column::End(End::Upper, |solved| Some(solved.judged.evaluation.judged.ok()?.upper.mm()))),
    ("margin_mm", Column::Number(|solved| Some(solved.nearest()?.inside_by.mm()))),
    ("verdict", Column::Text(|_, solved| Some(solved.verdict()?.name().to_owned()))),
    ("reason", Column::Text(|_, solved| solved.reason())),
    ("from_stroke_mm", Column::Number(|solved| Some(solved.strokes.start))),
    ("to_stroke_mm", Column::Number(|solved| Some(solved.strokes.end))),
    ("nearest_limit", Column::Text(|_, solved| solved.nearest().map(|end| format!("center_distance.{}", end.name())))),
    ("min_stroke_mm", Column::Number(|solved| Some(solved.summary.min_stroke_mm))),
    ("max_stroke_mm", Column::Number(|solved| Some(solved.summary.max_stroke_mm))),
    ("transmission_error_mm", Column::Number(|solved| Some(solved.summary.transmission_error_mm))),
];
const WRITTEN: usize = 13;
/// The columns with statistics.
pub(super) const QUANTITIES: Range<usize> = 1..8;

/// The verdicts on the limits of a yoke.
const VERDICTS: [(&str, Column); Target::ALL.len()] = [
    ("yoke_play_verdict", Column::Text(|_, solved| solved.verdict_on(Target::YokePlay))),
    ("pinion_torque_verdict", Column::Text(|_, solved| solved.verdict_on(Target::PinionTorque))),
    ("torque_fluctuation_verdict", Column::Text(|_, solved| solved.verdict_on(Target::TorqueFluctuation))),
    ("lift_off_force_verdict", Column::Text(|_, solved| solved.verdict_on(Target::LiftOffForce))),
];

/// The columns of these names, else the default ones; with a yoke in the spec also those of its figures.
pub(super) fn columns_asked(
    names: Option<&[String]>,
    has_yoke: bool,
) -> Result<Vec<(&'static str, Column)>, Diagnostic> {
    let of_yoke =
        FIGURES.into_iter().take(KNOWN_FIGURES).map(|(name, figure)| (name, Column::Yoke(figure))).chain(VERDICTS);
    let of_yoke: Vec<_> = of_yoke.filter(|_| has_yoke).collect();
    let Some(names) = names else { return Ok([&COLUMNS[..WRITTEN], &of_yoke].concat()) };
    let all = [&COLUMNS[..], &of_yoke].concat();
    let column = |name: &String| {
        all.iter().find(|(known, _)| known == name).copied().ok_or_else(|| {
            let known: Vec<_> = all.iter().map(|(name, _)| *name).collect();
            Diagnostic::usage(format!("there is no column `{name}` to write"))
                .help(nearest_or(name, &known, || format!("the results are {}", known.join(", "))))
        })
    };
    names.iter().map(column).collect()
}
