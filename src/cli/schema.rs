//! `rackmesh schema`: the spec's JSON Schema.

use serde_json::Value;

use super::output::{Failure, Output, Status};
use crate::spec::json_schema;

pub(super) const ABOUT: &str = "Print the spec's JSON Schema, from which editors complete it";

#[derive(Debug, clap::Args)]
#[command(after_help = "Example:
  rackmesh schema > rackmesh.schema.json
Editors with a TOML language server (Taplo, Tombi) find it by the first line of a spec, which `init` writes:
  #:schema rackmesh.schema.json
or for all specs by their names, *.rack.toml, which a rule in .taplo.toml or tombi.toml gives.")]
pub(super) struct Args {}

impl Args {
    #[expect(clippy::unused_self, reason = "every subcommand is called the same way")]
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        output.text(&(laid_out(&json_schema(), 2) + "\n"))?;
        Ok(Status::Pass)
    }
}

/// JSON with a line for each key of the outer tables.
fn laid_out(value: &Value, depth: usize) -> String {
    let Some(table) = value.as_object().filter(|_| depth > 0) else { return value.to_string() };
    let line = |(key, value)| format!("{}: {}", Value::from(key as &String as &str), laid_out(value, depth - 1));
    let lines: Vec<_> = table.iter().map(line).collect();
    format!("{{\n{}\n}}", lines.join(",\n"))
}
