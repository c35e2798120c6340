//! The bound against closed forms and against the exact mesh.

mod beside;
mod closed;
mod coverage;
mod nested;
pub(in crate::judge) mod property;
pub(in crate::judge) mod random;
mod tight;
#[cfg(feature = "spec")]
mod verdict;
