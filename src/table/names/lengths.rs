//! The length over which f_Hβ is evaluated, as headings call it. Asked where a column names no error.

use std::sync::LazyLock;

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

/// The same as names are compared: every cell of the first rows is.
static PLAIN: LazyLock<[String; NAMES.len()]> = LazyLock::new(|| NAMES.map(plain));

fn plain(text: &str) -> String {
    fold(text).replace(['_', '-'], " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Whether a heading is the evaluation length of f_Hβ.
pub(crate) fn is_evaluation_length(text: &str) -> bool {
    PLAIN.contains(&plain(&split_unit(text).0))
}
