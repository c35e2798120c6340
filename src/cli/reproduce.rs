//! `rackmesh reproduce`: the paper's tables beside ours.

use super::output::{Failure, Output, Status};
use crate::diagnostic::{Code, Diagnostic};
use crate::report::{Format, Reproduction};

pub(super) const ABOUT: &str = "Recompute the analytic columns of the paper's Tables 1 to 3";

#[derive(Debug, clap::Args)]
#[command(after_help = "Example:
  rackmesh reproduce

Exit status: 0 if every entry agrees to the printed digit, 1 if not.")]
pub(super) struct Args {
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let reproduction = Reproduction::new().map_err(|error| Diagnostic::error(Code::NoResult, error.to_string()))?;
        output.report(&reproduction, self.format)?;
        Ok(if reproduction.agrees() { Status::Pass } else { Status::Fail })
    }
}
