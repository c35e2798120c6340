//! `rackmesh man`: manual pages.

use std::path::{Path, PathBuf};

use clap::Command;

use super::output::{Failure, Output, Status};
use super::target;

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
            target::create_folder(dir)?;
            let mut command = super::command().disable_help_subcommand(true);
            command.build();
            write_pages(&command, dir)?;
            return Ok(Status::Pass);
        }
        let mut page = Vec::new();
        clap_mangen::Man::new(super::command()).render(&mut page)?;
        output.text(&String::from_utf8_lossy(&page))?;
        Ok(Status::Pass)
    }
}

/// Writes the page of a command and those of its subcommands.
fn write_pages(command: &Command, dir: &Path) -> Result<(), Failure> {
    for subcommand in command.get_subcommands().filter(|subcommand| !subcommand.is_hide_set()) {
        write_pages(subcommand, dir)?;
    }
    let man = clap_mangen::Man::new(command.clone());
    let mut page = Vec::new();
    man.render(&mut page)?;
    target::write(dir.join(man.get_filename()), &[] as &[PathBuf], &page)
}
