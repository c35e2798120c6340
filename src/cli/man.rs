//! `rackmesh man`: manual pages.

use std::path::PathBuf;

use super::output::{Failure, Output, Status};
use crate::diagnostic::{Code, Diagnostic};

pub(super) const ABOUT: &str = "Print the manual page, or write those of all subcommands";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh man | man -l -
  rackmesh man --dir ~/.local/share/man/man1")]
pub(super) struct Args {
    /// Write one page per subcommand to this folder.
    #[arg(long)]
    dir: Option<PathBuf>,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        if let Some(dir) = &self.dir {
            let written = std::fs::create_dir_all(dir).and_then(|()| clap_mangen::generate_to(super::command(), dir));
            written.map_err(|error| {
                Diagnostic::error(Code::FileAccess, format!("cannot write to {}: {error}", dir.display()))
            })?;
            return Ok(Status::Pass);
        }
        let mut page = Vec::new();
        clap_mangen::Man::new(super::command()).render(&mut page)?;
        output.text(&String::from_utf8_lossy(&page))?;
        Ok(Status::Pass)
    }
}
