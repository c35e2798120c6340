//! Shared by the tests of the mesh.
#![allow(dead_code, missing_docs, unreachable_pub, clippy::pedantic)]

pub mod brute;
pub mod paper;
pub mod random;
