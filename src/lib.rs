//! Operating centre distance of a rack and pinion, predicted from their manufacturing errors.

pub mod decision;
pub mod deviation;
pub mod formula;
pub mod gear;
pub mod mesh;
pub mod quantity;
pub mod trig;
