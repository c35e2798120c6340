#![doc = include_str!("method.md")]
//!
//! Called by the command line, the reports and anyone who has a [`Pair`](crate::gear::Pair) and its deviations. A
//! [`Mesh`] holds both; [`Mesh::at`] solves one stroke, [`Mesh::sample`] many on all cores
//! ([`Mesh::sample_blocks`] with bounded memory), a [`Sampler`] one after the
//! other on one core, [`Mesh::curve`] a whole range with its kinks. It must not know TOML, print, or read files.
//!
//! What follows from this in closed form, with figures: [`relations`].

mod contact;
mod coverage;
mod curve;
mod demand;
mod measure;
mod outcome;
mod prepare;
pub mod relations;
mod roll;
mod sample;
mod solve;
mod summary;
mod trail;

pub use contact::ContactKind;
pub use coverage::CarryingStrokes;
pub use curve::{Curve, Kink};
pub use measure::{PinionReading, RackReading};
pub use outcome::{Carrier, Ending, FlankSide, MeshError, MeshPoint, Work};
pub use prepare::{Mesh, Support};
pub use roll::LARGEST_ROLL_RAD;
pub use solve::Sampler;
pub use summary::Summary;
