//! `rackmesh schema`: the spec's JSON Schema.

use super::output::{Failure, Output, Status};
use crate::spec::json_schema;

pub(super) const ABOUT: &str = "Print the spec's JSON Schema, from which editors complete it";

#[derive(Debug, clap::Args)]
#[command(after_help = "Example:
  rackmesh schema > rackmesh.schema.json
Then write as the first line of a spec, for editors with a TOML language server:
  #:schema rackmesh.schema.json")]
pub(super) struct Args {}

impl Args {
    #[expect(clippy::unused_self, reason = "every subcommand is called the same way")]
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        output.text(&format!("{:#}\n", json_schema()))?;
        Ok(Status::Pass)
    }
}
