//! What would close a table, as the lines of a contract; written into a spec by the command line. It is text for a person: a contract
//! comes from a spec that was read, and nothing here becomes one, so that a guess never reaches an evaluator.

mod block;
pub(crate) mod guess;
pub(crate) mod lines;
mod mail;
mod own;
pub(crate) mod rules;

pub use block::Guesses;
pub use mail::table_in_sentences;
