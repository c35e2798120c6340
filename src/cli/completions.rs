//! `rackmesh completions`: shell completions.

use std::ffi::OsStr;

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
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

/// Takes any text, and tells shells what it may be.
#[derive(Clone)]
pub(super) struct Suggested(pub(super) fn() -> Vec<PossibleValue>);

impl TypedValueParser for Suggested {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new((self.0)().into_iter()))
    }
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut super::command(), "rackmesh", &mut script);
        output.text(&String::from_utf8_lossy(&script))?;
        Ok(Status::Pass)
    }
}
