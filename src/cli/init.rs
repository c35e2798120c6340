//! `rackmesh init`: a commented spec to start from.

use std::fs::File;
use std::io::Write as _;

use super::output::{Failure, Output, Status};
use super::target;
use crate::diagnostic::{Code, Diagnostic};
use crate::spec::TEMPLATE;

pub(super) const ABOUT: &str = "Write a commented spec to start from";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh init > rack.toml
  rackmesh init rack.toml    refuses to overwrite a file")]
pub(super) struct Args {
    /// The file to write; `-` is standard output.
    #[arg(default_value = "-")]
    file: String,
    /// Overwrite the file if it exists.
    #[arg(long)]
    force: bool,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        if self.file == "-" {
            output.text(TEMPLATE)?;
            return Ok(Status::Pass);
        }
        if self.force {
            target::write(&self.file, &[] as &[&str], TEMPLATE.as_bytes())?;
            return Ok(Status::Pass);
        }
        let written = File::create_new(&self.file).and_then(|mut file| file.write_all(TEMPLATE.as_bytes()));
        written.map_err(|error| {
            let diagnostic = Diagnostic::error(Code::FileAccess, format!("cannot write {}: {error}", self.file));
            if error.kind() == std::io::ErrorKind::AlreadyExists {
                diagnostic.help("choose another name, or overwrite it with --force")
            } else {
                diagnostic
            }
        })?;
        Ok(Status::Pass)
    }
}
