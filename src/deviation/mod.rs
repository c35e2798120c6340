//! The deviations of a part.
//!
//! For the formulas, one value per kind of error ([`DeviationKind`]). For the mesh and the multibody model, one
//! displacement and one lead deviation per tooth and flank: [`RackFlanks`] and [`PinionFlanks`], made by the
//! spec layer from any number of deviations that add up, and from measured rows ([`RackSpaceRow`],
//! [`PinionToothRow`]). Nothing here reads a file or computes a contact.

mod error;
mod extent;
mod form;
mod kind;
mod measured;
mod pinion;
pub mod plausible;
mod rack;
mod tooth_range;
#[cfg(feature = "table")]
mod values;

pub use error::{DeviationError, DeviationQuantity};
pub(crate) use error::{MAX_LEAD_RAD, MAX_LENGTH_MM};
pub use extent::{Countable, Extent, UnknownExtent};
pub use form::{PinionForm, RackForm};
#[cfg(any(feature = "report", feature = "spec"))]
pub(crate) use kind::key_in_words;
pub use kind::{DeviationKind, DeviationValue, Part};
pub use measured::{
    PinionToothRow, RackSpaceRow, RowValue, pinion_flanks_from_rows, pitch_steps, rack_flanks_from_spaces,
};
pub use pinion::{PinionDeviation, PinionDeviationKind, PinionFlank, PinionFlanks, PinionTooth};
pub use rack::{RackDeviation, RackDeviationKind, RackFlank, RackFlanks, RackTooth};
pub use tooth_range::{FIRST_ODD_TOOTH, ToothRange, ToothRangeError};
#[cfg(feature = "table")]
pub use values::DeviationValues;
