//! Shared by the tests of the mesh.
#![allow(dead_code, missing_docs, unreachable_pub, clippy::disallowed_methods, clippy::pedantic)]

pub mod brute;
pub mod convergence;
pub mod kinds;
pub mod pairs;
pub mod paper;
pub mod random;
