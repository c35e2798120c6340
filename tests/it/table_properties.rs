//! Random tables, whatever dialect, encoding, shape or kind of file they are written in: the answers are the same, or the
//! table is refused; and no table of which something is not understood passes.
//!
//! The default run looks at the same tables each time; `RACKMESH_LONG_TESTS=1` looks at 50 times as many others.
#![allow(clippy::pedantic, clippy::disallowed_methods, unreachable_pub)]

mod changed;
mod file;
mod grid;
mod parts;
mod read;
mod same;
mod words;

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestError, TestRng, TestRunner};

/// Holds a property against so many cases.
fn check<S: Strategy>(cases: u32, strategy: S, property: impl Fn(S::Value) -> Result<(), TestCaseError>) {
    let is_long = crate::common::is_long();
    let cases = if is_long { 50 * cases } else { cases };
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 4000, ..Config::default() };
    let mut runner = if is_long {
        TestRunner::new(config)
    } else {
        TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
    };
    match runner.run(&strategy, property) {
        Ok(()) => {}
        // the text says it all, and what it was made from is long
        Err(TestError::Fail(reason, _)) => panic!("{reason}"),
        Err(aborted) => panic!("{aborted}"),
    }
}

fn failed(problem: &str, text: &str) -> TestCaseError {
    TestCaseError::fail(format!("{problem}\n---\n{text}\n---"))
}
