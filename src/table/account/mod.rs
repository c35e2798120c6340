//! What a table holds and who owns it, and what is said of one that is not closed. Made by the reader where a table is not closed,
//! and by `read` of any table; has no path to a result.

mod proposal;
mod refusal;

pub(crate) use proposal::Unclosed;
pub use proposal::{ColumnAccount, LineAccount, Proposal};
