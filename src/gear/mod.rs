//! Nominal geometry of a crossed helical rack and pinion, valid by construction.
//!
//! [`PairData`] holds the numbers of a drawing. [`Pair`] holds the same numbers, checked, with all that follows from them. The
//! spec builds it; the mesh, the deviations and the multibody model read it. All numbers are in mm and rad.
//!
//! # Conventions
//! The rack frame is right-handed. Seen from the pinion, X points right, along the rack's travel; Y points up, across the
//! rack; Z points towards the viewer. Z = 0 is the rack's reference plane. A right-hand helix angle is positive. The rack's
//! tooth line has the direction (sin β_r, cos β_r, 0). The pinion's axis has the direction (sin Σ, cos Σ, 0) with
//! Σ = β_r + β_p and passes over X = Y = 0 at the height Z = a, the centre distance. At a stroke s the centre line of rack
//! tooth i is X = i p_x − s + Y tan β_r, so teeth of rising index come into mesh as s rises.
//!
//! At s = 0 a tooth *space* of the pinion faces rack tooth 0. At the stroke (j + ½) p_x pinion tooth j sits in the space
//! between the rack's teeth j and j + 1. A *right* flank faces +X on the rack and the higher tooth index on the pinion. The
//! right flank of rack tooth i meets the left flank of pinion tooth i; the left flank of rack tooth i meets the right flank
//! of pinion tooth i − 1 (modulo z).

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
