//! `rackmesh man`: manual pages.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{self, Stdio};

use clap::Command;

use super::output::{Failure, Output, Status};
use super::target;

pub(super) const ABOUT: &str = "Show the manual page, or write those of all subcommands";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh man
  rackmesh man > rackmesh.1
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
            write_pages(&with_all_options(command), dir)?;
            return Ok(Status::Pass);
        }
        let mut page = Vec::new();
        clap_mangen::Man::new(with_all_options(super::command())).render(&mut page)?;
        if output.screen().width.is_none() {
            output.text(&String::from_utf8_lossy(&page))?;
        } else if !is_shown(&page) {
            output.text(&super::command().render_long_help().to_string())?;
        }
        Ok(Status::Pass)
    }
}

/// Shows a page by the system's `man`; returns whether that worked.
fn is_shown(page: &[u8]) -> bool {
    let man = process::Command::new("man").args(["-l", "-"]).stdin(Stdio::piped()).stderr(Stdio::null()).spawn();
    let Ok(mut man) = man else { return false };
    // no line is drawn over the page
    super::line::no_waiting();
    // leaving the pager early closes the pipe
    let _ = man.stdin.take().map(|mut pipe| pipe.write_all(page));
    man.wait().is_ok_and(|status| status.success())
}

/// A command whose pages describe the options that `-h` leaves out, too.
fn with_all_options(command: Command) -> Command {
    command.mut_subcommands(with_all_options).mut_args(|argument| argument.hide_short_help(false))
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
