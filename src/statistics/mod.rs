//! Statistics that know nothing of gears: [distribution](self) functions and quantiles, [`capability`].

pub mod capability;
mod distribution;

pub use distribution::*;
