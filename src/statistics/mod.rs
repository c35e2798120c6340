//! Statistics that know nothing of gears: [distribution](self) functions and quantiles, [`capability`].

pub mod capability;
mod distribution;
mod moments;

pub use distribution::*;
pub(crate) use moments::LengthMoments;
