//! Operating centre distance of a rack and pinion, predicted from their manufacturing errors.

pub mod trig;
