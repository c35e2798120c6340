//! Tables of measured values, as measuring machines and spreadsheets write them.
//!
//! [`paste`] reads blocks that a person copied.
//!
//! The command line reads a file that a spec names (`rack.measured`, `pinion.measured`) and calls
//! [`rack_spaces`] or [`pinion_teeth`]; what comes out are rows of exact quantities, which the spec
//! module turns into deviations. Nothing here knows gear geometry.
//!
//! # The table
//! Separated by tabs, semicolons or commas, whichever the header has. Columns are found by their header,
//! in any order, with the unit behind the name: `over_pin [µm]`, `lead (deg)`, `position_mm`; without one,
//! lengths are in mm and angles in degrees. A cell may carry a unit of its own. Decimal commas are taken
//! where the separator is not a comma and the file shows that they are not thousands marks; what could be
//! either is refused. Other columns are passed over.

pub mod paste;
pub mod qdas;
mod sheet;
mod table;
mod teeth;
mod text;
mod written;
pub mod xlsx;

pub use sheet::Sheet;
#[cfg(feature = "batch")]
pub(crate) use table::name_and_unit;
pub use teeth::{Measured, PinionTeeth, PinionTooth, RackSpace, RackSpaces, pinion_teeth, rack_spaces};
pub use text::decode;
pub use written::DecimalMark;
