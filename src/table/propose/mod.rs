//! What would close a table: the account of what it holds, and the lines of a contract. Made by the reader where a table is not
//! closed, and by `read` of any table; written into a spec by the command line. It is text for a person: a contract comes from
//! a spec that was read, and nothing here becomes one, so that a guess never reaches an evaluator.

mod block;
mod guess;
mod lines;
mod mail;
mod own;
mod proposal;
mod refusal;
mod rules;

pub use block::Guesses;
pub use mail::table_in_sentences;
pub(crate) use proposal::Unclosed;
pub use proposal::{ColumnAccount, LineAccount, Proposal};
