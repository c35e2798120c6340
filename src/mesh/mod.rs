#![doc = include_str!("method.md")]
//!
//! # How it is found
//! ```text
//!   a |  \   \        /   /
//!     |   \   \      /   /       each line: the centre distance at which one flank pair touches, over the
//!     |    \   \    /   /        pinion's rotation θ; pairs on right flanks fall, those on left ones rise
//!     |     \   \  /   /
//! a(s)| . . .\ . \/ . / . .      each side asks for the highest of its lines; where both ask for the same,
//!     |       \  /\  /           what both need is smallest: that is the mesh at this stroke
//!     |        \/  \/
//!     +----------------------> θ
//! ```
//! From the bottom up, a file or folder each:
//! 1. `prepare`: of one flank pair, the planes of the rack tooth (flank, tip, end faces) and the involute helicoid of the
//!    pinion tooth as numbers; done once per tooth and kept.
//! 2. `contact`: the centre distance at which that pair touches. The helicoid is a set of straight generators; on each
//!    the highest demand has a closed form, and one maximum over the generators remains. If the helix fits the plane, a
//!    whole generator touches (`line`); at the line's end two closed forms know the corner (`corner`, `rack_corner`);
//!    anything else is searched (`climb`), flanks with crowning or relief peak by peak (`form`). Most pairs in reach are
//!    too far to carry, which one bound sees at once (`reach`).
//! 3. `demand`: one side, the highest of its pairs; beginning with the one that carried last. `sampler` keeps what is
//!    known of each from stroke to stroke.
//! 4. `solve`: the rotation at which both sides ask for the same, by Newton's method in a bracket.
//! 5. `roll`: for a rack that may roll, the roll with the smallest such centre distance, by bounds from known slopes
//!    (`contact/roll_rate`).
//! 6. `sample`: one stroke after the other, or many on all cores; `curve`: a range of strokes with its kinks, solved once
//!    where it repeats (`repeats`), `summary`: its figures; `rates`: how fast it moves, and what slides; `coverage`, `measure`: which strokes teeth carry at, and what a ball between them reads.
//!
//! Steps 2 to 5 end at rounding; only a curve has a tolerance. The closed forms and bounds change no result; each says how
//! much slower the mesh is without it.
//!
//! # Use
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
mod rates;
pub mod relations;
mod repeats;
mod roll;
mod sample;
mod sampler;
mod solve;
mod summary;

pub use contact::ContactKind;
pub use coverage::CarryingStrokes;
pub use curve::{Curve, Kink};
pub(crate) use demand::PairLine;
pub use measure::{PinionReading, RackReading};
pub use outcome::{Carrier, Ending, FlankSide, MeshError, MeshPoint, SOLVED_MM, Work};
pub(crate) use prepare::MatingFlanks;
pub use prepare::{Mesh, Support};
pub use rates::Rates;
pub use roll::LARGEST_ROLL_RAD;
pub use sampler::Sampler;
pub use summary::Summary;

/// First and last stroke by default, mm.
pub const STROKE_MM: (f64, f64) = (0.0, 50.0);

/// Tolerance of a curve by default, mm.
pub const TOLERANCE_MM: f64 = 1e-6;
pub(crate) use summary::largest_swing;
