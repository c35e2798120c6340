//! Shared by tests, benches and examples.
#![allow(dead_code, missing_docs, unreachable_pub, clippy::disallowed_methods, clippy::pedantic)]

pub mod brute;
pub mod convergence;
pub mod formulas;
pub mod kinds;
pub mod pairs;
pub mod paper;
pub mod random;

/// Whether `RACKMESH_LONG_TESTS=1` asks for a long run.
pub fn is_long() -> bool {
    std::env::var("RACKMESH_LONG_TESTS").is_ok_and(|value| value == "1")
}
