//! The lines of a contract that would close a table, which the command line can write into a spec. They are text for a person: only
//! a spec that was read becomes a contract, so that a guess never reaches an evaluator.

mod block;
pub(crate) mod guess;
pub(crate) mod lines;
mod mail;
mod own;
pub(crate) mod rules;

pub use block::Guesses;
pub use mail::table_in_sentences;
