//! The keys of one value, which stands in `[errors]` or in a column of a table.

use super::kind::{AnyKey, Key, Kind, angle, key, length, text, word};
use crate::deviation::Countable;
use crate::formula::domain;
use crate::quantity::{Angle, Domain, Length};

/// In an entry of `[errors]`, beside its value: whether the value holds for every part of a table.
pub(crate) const EVERY_PART: &str = "every_part";

/// In an entry of `[errors]` for the pinion's pitch, beside its value or alone: the diameter at which it was measured.
pub(crate) const MEASURED_AT: &str = "measured_at";

/// In an entry of `[errors]`, beside its value or alone, of a column or of `[budget]`: on which teeth an error is.
pub(crate) const EXTENT: &str = "extent";

/// In place of a measured value: repeated readings, whose mean counts and whose spread is its uncertainty.
pub(crate) const READINGS: &str = "values";

/// The keys of an uncertainty, beside the uncertain value.
pub(crate) const UNCERTAINTY_KEYS: [&str; 6] = ["u", "U", "k", "half_width", "distribution", "dof"];

/// What a column holds: the value itself, or its difference from nominal.
pub(crate) const COLUMN_KIND: Key<&'static str> = word(&["measured", "deviation"]).with(
    "kind",
    "Whether the column holds measured values or deviations. Default: measured if there is a nominal value.",
);

pub(crate) const COLUMN_NAME: Key<String> =
    text().with("name", "The column's name in the header, if it is not the error's own.");

pub(crate) const LENGTH_NOMINAL: Key<Length> =
    length(Domain::any("nominal value", "M_nom")).with("nominal", "Nominal value of what was measured.");

pub(crate) const ANGLE_NOMINAL: Key<Angle> =
    angle(Domain::any("nominal value", "β_nom")).with("nominal", "Nominal value of what was measured.");

pub(crate) const EVALUATION_LENGTH: Key<Length> =
    length(domain::EVALUATION_LENGTH).with("length", "Evaluation length of f_Hβ.");

pub(super) const fn column_extent(of: Countable) -> AnyKey {
    key(
        EXTENT,
        Kind::Extent(of),
        "On which teeth each value is. Default: as [errors] says, or as of any measured value.",
    )
}

/// The diameter at which a pitch of the pinion was measured.
pub(crate) const COLUMN_MEASURED_AT: Key<Length> = length(domain::MEASUREMENT_CIRCLE).with(
    MEASURED_AT,
    "Diameter of the circle on which f_p was measured; its values are scaled to the reference circle. Default: that circle.",
);
