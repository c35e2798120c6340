//! The account of a table: its columns and lines with their owners, and the refusal of a table that is not closed. The reader makes
//! it for a table that is not closed, `rackmesh read` for any table. No result can be computed from it.

mod proposal;
mod refusal;

pub(crate) use proposal::Unclosed;
pub use proposal::{ColumnAccount, LineAccount, Proposal};
