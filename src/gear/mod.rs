//! Nominal geometry of a crossed helical rack and pinion, valid by construction.
//!
//! [`PairData`] is what a drawing says; [`Pair`] is what it means: the same numbers after every domain
//! has been checked, with all derived values. The spec layer builds it, the mesh, the deviations and the
//! multibody model take it. It knows nothing of deviations, files or units other than mm and rad.
//!
//! # Conventions
//! The rack frame is right-handed. Seen from the pinion X points right, along the rack's travel, Y up,
//! across the rack, and Z towards the viewer; Z = 0 is the rack's reference plane. Helix angles are
//! positive for right hands. A right-hand rack's tooth line has the direction (sin β_r, cos β_r, 0), the
//! pinion's axis (sin Σ, cos Σ, 0) with Σ = β_r + β_p, over X = 0, Y = 0 at the height Z = a. At a stroke s
//! tooth i of the rack has its centre line at X = i p_x − s + Y tan β_r, so teeth of rising index come
//! into mesh as s rises.
//!
//! At s = 0 a tooth *space* of the pinion faces rack tooth 0. Pinion tooth j sits, at the stroke
//! (j + ½) p_x, in the space between the rack's teeth j and j + 1. A *right* flank faces +X on the rack and
//! the higher tooth index on the pinion; the right flank of rack tooth i meets the left flank of
//! pinion tooth i, the left flank of rack tooth i the right flank of pinion tooth i − 1 (modulo z).

mod check;
mod data;
mod error;
mod hand;
mod pair;

pub(crate) use check::clip;
#[cfg(test)]
pub(crate) use check::tests::example;
pub use check::{ContactRatio, GeometryWarning, thickness_offset_mm, undercut_limit};
pub use data::{PairData, PinionData, RackData};
pub use error::{GeometryError, PairSize};
pub use hand::Hand;
pub use pair::{MOST_TEETH, Pair, Pinion, Rack};
