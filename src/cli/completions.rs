//! `rackmesh completions`: shell completions.

use clap_complete::Shell;

use super::output::{Failure, Output, Status};

pub(super) const ABOUT: &str = "Print completions for a shell";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh completions bash > ~/.local/share/bash-completion/completions/rackmesh
  rackmesh completions zsh > ~/.zfunc/_rackmesh
  rackmesh completions fish > ~/.config/fish/completions/rackmesh.fish")]
pub(super) struct Args {
    /// The shell.
    shell: Shell,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut super::command(), "rackmesh", &mut script);
        output.text(&String::from_utf8_lossy(&script))?;
        Ok(Status::Pass)
    }
}
