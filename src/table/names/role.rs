//! What the columns of a table with a row per characteristic hold, as measuring programs call them.

use super::unit::split_unit;
use super::vocabulary::Sense;
use super::words::Words;
use super::{Field, bare};

/// A column of a table with a row per characteristic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// Which part the row is of.
    Part,
    /// What was measured.
    Name,
    /// The nominal value.
    Nominal,
    /// The measured value.
    Measured,
    /// Measured minus nominal.
    Deviation,
    /// The upper tolerance or limit, or the tolerance to both sides.
    Upper,
    /// The lower tolerance or limit.
    Lower,
    /// The unit of the row.
    Unit,
    /// How uncertain the measured value is.
    Uncertainty,
    /// Whether the value is within its tolerance, or by how much it is not.
    Status,
}

/// What a heading of a table with a row per characteristic says; `None` for what is none of it, as a column of values
/// that is called after its part (`Teil 1`).
pub(crate) fn role(text: &str) -> Option<Role> {
    let (name, _) = split_unit(bare(text));
    let known = Words::of(&name).known()?;
    if let [word] = known.as_slice()
        && let Some(role) =
            word.senses.iter().find_map(|sense| if let Sense::Role(role) = sense { Some(*role) } else { None })
    {
        return Some(role);
    }
    let senses: Vec<Sense> = known.iter().map(|word| role_sense(&word.senses)).collect::<Option<_>>()?;
    let has = |sense: Sense| senses.contains(&sense);
    if has(PART) {
        let of_part = |sense: &Sense| matches!(sense, &PART | Sense::Rack | Sense::Pinion | Sense::Filling);
        let ordinal = known.iter().any(|word| word.senses.contains(&Sense::Ordinal));
        let numbers_lines = ordinal && !has(Sense::Rack) && !has(Sense::Pinion);
        return (senses.iter().all(of_part) && !numbers_lines).then_some(Role::Part);
    }
    let tolerance = has(Sense::Tolerance) || has(Sense::Limit);
    let upper = has(Sense::Upper) || has(Sense::Greatest) || (has(Sense::Plus) && tolerance);
    let lower = has(Sense::Lower) || has(Sense::Least) || (has(Sense::Minus) && tolerance);
    match (upper, lower) {
        (true, true) => return None,
        (true, false) => return Some(Role::Upper),
        (false, true) => return Some(Role::Lower),
        (false, false) => {}
    }
    if tolerance {
        return Some(Role::Upper);
    }
    // Soll-Ist: the difference, and which sign it has is not said
    if has(Sense::Nominal) && has(Sense::Measured) {
        return None;
    }
    let by_word = [
        (Sense::Uncertainty, Role::Uncertainty),
        (Sense::Deviation, Role::Deviation),
        (Sense::Nominal, Role::Nominal),
        (Sense::Measured, Role::Measured),
    ];
    by_word.into_iter().find(|(sense, _)| has(*sense)).map(|(_, role)| role)
}

const PART: Sense = Sense::Alone(&[Field::PartId]);

/// What a word can say of a column; `None` if it is not used for one.
fn role_sense(senses: &[Sense]) -> Option<Sense> {
    let of_column = |sense: &Sense| {
        matches!(
            sense,
            &PART
                | Sense::Rack
                | Sense::Pinion
                | Sense::Deviation
                | Sense::Measured
                | Sense::Nominal
                | Sense::Upper
                | Sense::Lower
                | Sense::Plus
                | Sense::Minus
                | Sense::Tolerance
                | Sense::Limit
                | Sense::Uncertainty
                | Sense::Greatest
                | Sense::Least
                | Sense::Filling
        )
    };
    senses.iter().copied().find(of_column)
}

/// What rows and columns beside the parts are called that are made of them.
const STATISTICS: [&str; 48] = [
    "mittelwert",
    "mittel",
    "mean",
    "average",
    "avg",
    "moyenne",
    "平均",
    "平均値",
    "min",
    "minimum",
    "max",
    "maximum",
    "最小",
    "最大",
    "最小値",
    "最大値",
    "std",
    "stdev",
    "std dev",
    "stddev",
    "standardabw",
    "standardabweichung",
    "standard deviation",
    "écart-type",
    "標準偏差",
    "sigma",
    "range",
    "spannweite",
    "étendue",
    "summe",
    "sum",
    "total",
    "anzahl",
    "count",
    "cpk",
    "cp",
    "ppk",
    "pp",
    "cmk",
    "cm",
    "s",
    "x quer",
    "xquer",
    "x-bar",
    "xbar",
    "x̄",
    "median",
    "variance",
];

/// Whether a name is that of a statistic of parts, and not of a part.
pub(crate) fn is_statistic(name: &str) -> bool {
    let plain = name.trim().trim_end_matches([':', '.', '=']).trim().to_lowercase();
    STATISTICS.contains(&plain.as_str())
}
