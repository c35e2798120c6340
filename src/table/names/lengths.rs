//! The length over which f_Hβ is evaluated, as headings call it. Asked where a column names no error.

use super::split_unit;
use super::words::fold;

const NAMES: [&str; 16] = [
    "evaluation length",
    "evaluated length",
    "eval length",
    "length of evaluation",
    "l_beta",
    "lbeta",
    "l beta",
    "lβ",
    "auswertelange",
    "auswertelaenge",
    "auswertebereich",
    "prufbereich",
    "pruefbereich",
    "longueur d'evaluation",
    "longueur evaluee",
    "評価長さ",
];

/// Whether a heading is the evaluation length of f_Hβ.
pub(crate) fn is_evaluation_length(text: &str) -> bool {
    let (name, _) = split_unit(text);
    let plain = |text: &str| fold(text).replace(['_', '-'], " ").split_whitespace().collect::<Vec<_>>().join(" ");
    let name = plain(&name);
    NAMES.iter().any(|known| plain(known) == name)
}
