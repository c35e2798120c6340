//! What each fuzz target checks of an arbitrary input: one module a target, one function `check` each.
//! Called by the fuzzer's targets and by `tests/it/fuzz_corpus.rs`; must not need the fuzzer.

pub mod mesh;
pub mod spec;
pub mod table;
