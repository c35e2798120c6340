//! The cells of a table with their owners, and the refusal of a table that is not closed. The reader makes it where a table is not
//! closed, `read` for any table; it has no path to a result.

mod proposal;
mod refusal;

pub(crate) use proposal::Unclosed;
pub use proposal::{ColumnAccount, LineAccount, Proposal};
