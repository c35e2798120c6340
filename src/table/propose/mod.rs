//! The lines of a contract that would close a table. The command line can write them into a spec. They are text for a person: only a
//! spec that is read becomes a contract, so that a guess never reaches an evaluator.

mod block;
pub(crate) mod entry;
pub(crate) mod guess;
pub(crate) mod lines;
mod mail;
mod odd_rows;
mod own;
pub(crate) mod rules;

pub use block::Guesses;
pub use mail::table_in_sentences;
pub(crate) use odd_rows::OddRows;
