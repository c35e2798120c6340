//! The exact zero-backlash mesh: for each stroke the smallest centre distance at which no flank penetrates.
//!
//! Called by the command line, the reports and anyone who has a [`Pair`](crate::gear::Pair) and its deviations. A
//! [`Mesh`] holds both; [`Mesh::at`] solves one stroke, [`Mesh::sample`] many on all cores
//! ([`Mesh::sample_blocks`] with bounded memory), a [`Sampler`] one after the
//! other on one core, [`Mesh::curve`] a whole range with its kinks. It must not know TOML, print, or read files.
//!
//! # What is solved
//! For a rotation θ of the pinion let a(θ) be the smallest centre distance at which no point of any pinion flank
//! (finite involute helicoids: root form to tip, |w| ≤ b/2) lies strictly inside any rack tooth (the solid under
//! both flank planes and the tip plane, |y| ≤ k/2). Then a(s) = min a(θ): right rack flanks ask for less as the
//! pinion turns away from them, left ones for more, and the minimum is where both ask for the same. ΔCD = a − a_0.
//! The bodies are rigid; the rack's fixed unless [`Support::FreeRoll`] lets it roll about its own axis, which is
//! minimised over too.
//!
//! What follows from this in closed form, with figures: [`relations`].

mod contact;
mod curve;
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
pub use curve::{Curve, Kink};
pub use measure::{PinionReading, RackReading};
pub use outcome::{Carrier, Ending, FlankSide, MeshError, MeshPoint, Work};
pub use prepare::{Mesh, Support};
pub use solve::Sampler;
pub use summary::Summary;
