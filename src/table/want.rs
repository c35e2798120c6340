//! What is known about a table before it is read: what the spec says of its columns, and what the user says of the file.
//! Filled by the spec and the command line; asked by every step of the reading.

use std::sync::Arc;

use super::field::ValueKind;
use super::layout::Layout;
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::{Diagnostics, harmless};
use crate::quantity::{Length, Unit};

/// What the spec says of a column of values.
#[derive(Debug, Clone)]
pub struct GivenColumn {
    /// The error.
    pub kind: DeviationKind,
    /// The unit of its numbers.
    pub unit: Option<Unit>,
    /// Whether it holds measured values or deviations.
    pub holds: Option<ValueKind>,
    /// The nominal value, or what is missing to compute it.
    pub nominal: Option<Result<DeviationValue, Diagnostics>>,
    /// The evaluation length of f_Hβ.
    pub length: Option<Length>,
}

/// What is known about a table before it is read.
#[derive(Debug, Clone, Default)]
pub struct Want {
    /// The errors of the spec, in its order.
    pub expected: Vec<DeviationKind>,
    /// What the spec says of their columns.
    pub given: Vec<GivenColumn>,
    /// The normal module: no length may be further from its nominal value.
    pub module: Option<Length>,
    /// The rack's face width, over which f_Hβ is evaluated where nothing else is said.
    pub face_width: Option<Length>,
    /// The pinion's face width, over which f_Hβ of its teeth is evaluated.
    pub pinion_face_width: Option<Length>,
    /// How many teeth the pinion has.
    pub pinion_teeth: Option<i64>,
    /// The nominal measure over the pin, if the spec tells it.
    pub over_pin: Option<Length>,
    /// Whether each row is a tooth or a space; found from the headings unless given.
    pub teeth: Option<bool>,
    /// The contract by which a table is read.
    pub layout: Arc<Layout>,
}

impl Want {
    /// The contract by which a table is read, with what is known of its rows.
    pub(crate) fn contract(&self) -> Arc<Layout> {
        if self.teeth == Some(true) {
            return Arc::new(Layout { teeth: true, ..Layout::clone(&self.layout) });
        }
        Arc::clone(&self.layout)
    }

    /// The unit of an error's numbers: that of the spec, or else in which it is usually measured, its size in mm, or its deviation in µm.
    pub(crate) fn usual_unit(&self, kind: DeviationKind) -> &'static str {
        if let Some(unit) = self.given(kind).and_then(|given| given.unit) {
            return unit.symbol();
        }
        let is_size = self.given(kind).is_some_and(|given| matches!(given.nominal, Some(Ok(_))));
        if is_size { "mm" } else { "um" }
    }

    /// What the spec says of the column of an error.
    pub(crate) fn given(&self, kind: DeviationKind) -> Option<&GivenColumn> {
        self.given.iter().find(|given| given.kind == kind)
    }
}

/// A text in quotes, as a spec writes it.
pub(crate) fn quoted(text: &str) -> String {
    let escapes = [('\\', "\\\\"), ('"', "\\\""), ('\n', "\\n"), ('\r', "\\r"), ('\t', "\\t")];
    let escaped = escapes.into_iter().fold(text.to_owned(), |text, (c, escape)| text.replace(c, escape));
    format!("\"{}\"", harmless(&escaped))
}
