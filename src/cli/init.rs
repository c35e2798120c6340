//! `rackmesh init`: a commented spec to start from.

use std::io::Write as _;
use std::path::PathBuf;

use super::output::{Failure, Output, Status};
use super::target::{Target, is_dash, shown};
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
    file: PathBuf,
    /// Overwrite the file if it exists.
    #[arg(long)]
    force: bool,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        if is_dash(&self.file) {
            output.text(TEMPLATE)?;
            return Ok(Status::Pass);
        }
        if !self.force && self.file.symlink_metadata().is_ok() {
            let message = format!("cannot write {}: it exists", shown(&self.file));
            let help = "choose another name, or overwrite it with --force";
            return Err(Diagnostic::error(Code::FileAccess, message).help(help).into());
        }
        let mut target = Target::create(&self.file, &[] as &[PathBuf])?;
        target.write_all(TEMPLATE.as_bytes())?;
        // a file that appeared meanwhile is not overwritten either
        if self.force {
            target.finish()?;
        } else {
            target.finish_new()?;
        }
        Ok(Status::Pass)
    }
}
