//! `--set KEY=VALUE`, and the spec that is read with it, for every subcommand that takes a spec.

use std::ffi::OsString;
use std::io::Read as _;
use std::path::Path;

use clap::builder::{PossibleValue, StyledStr};
use clap::error::{ContextKind, ContextValue, ErrorKind};

use super::completions::Suggested;
use super::held::HeldSpec;
use super::output::{Failure, Output};
use super::stream;
use super::target::is_dash;
use crate::diagnostic::Diagnostic;
use crate::spec::{self, LARGEST_SPEC, Spec};

#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct SetArgs {
    /// Set a key of the spec: `errors.rack_pitch=12um`
    ///
    /// It takes the place of what the file says; may be repeated. `rackmesh explain keys` lists all keys.
    #[arg(long, value_name = "KEY=VALUE", value_parser = Suggested(keys), hide_possible_values = true)]
    set: Vec<String>,
}

impl SetArgs {
    /// Reads and parses the spec at `path`; `-` is standard input.
    pub(super) fn read_spec(&self, path: &Path, output: &mut Output) -> Result<Spec, Failure> {
        if let Some(spec) = output.read_spec() {
            return Ok(spec);
        }
        if let Some((HeldSpec { name, text }, own)) = output.held_spec() {
            return Self { set: [own, self.set.clone()].concat() }.parse(&name, &text, output);
        }
        let mut bytes = Vec::new();
        let name = &stream::name(path);
        let most = LARGEST_SPEC as u64 + 1;
        let read = if is_dash(path) {
            super::line::no_waiting();
            std::io::stdin().lock().take(most).read_to_end(&mut bytes)
        } else {
            std::fs::File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes))
        };
        read.map_err(|error| Diagnostic::unreadable(name, &error))?;
        spec::refuse_size(name, &bytes)?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let valid = error.utf8_error().valid_up_to();
            Diagnostic::unreadable(name, &format!("it is not text in UTF-8 (byte {valid})"))
        })?;
        self.parse(name, &text, output)
    }

    /// The spec of the options alone.
    pub(super) fn without_file(&self, output: &mut Output) -> Result<Spec, Failure> {
        self.parse("no spec", "", output)
    }

    fn parse(&self, name: &str, text: &str, output: &mut Output) -> Result<Spec, Failure> {
        let spec = Spec::parse_with(name, text, &self.set)?;
        spec.suspicions().iter().for_each(|found| output.diagnostic(found));
        Ok(spec)
    }

    /// Whether nothing is set.
    pub(super) fn is_empty(&self) -> bool {
        self.set.is_empty()
    }
}

/// The error in the arguments, with how to set the key that an unknown option names: `--preload 2000` is
/// `--set simulation.preload=2000`.
pub(super) fn with_settings(arguments: &[OsString], mut error: clap::Error) -> clap::Error {
    let Some(ContextValue::String(option)) = error.get(ContextKind::InvalidArg) else { return error };
    let words: Vec<_> = arguments.iter().map(|word| word.to_string_lossy()).collect();
    let takes_settings = |known: &&super::Subcommand| {
        let command = (known.arguments)(clap::Command::new(known.name));
        words.iter().any(|word| word == known.name)
            && command.get_arguments().any(|argument| argument.get_id() == "set")
    };
    let Some(called) = super::subcommands().find(takes_settings) else { return error };
    let Some(key) = option.strip_prefix("--").map(|option| option.replace('-', "_")) else { return error };
    let value = words.iter().enumerate().find_map(|(index, word)| match word.strip_prefix(option.as_str())? {
        "" => words.get(index + 1).map(|next| &**next).filter(|next| !next.starts_with("--")),
        rest => rest.strip_prefix('='),
    });
    let value = value.unwrap_or("…");
    let mut paths: Vec<_> = spec::keys().into_iter().map(|key| key.path).collect();
    paths.retain(|path| path.rsplit('.').next() == Some(key.as_str()));
    // an error is most likely meant, for a simulation one of its own keys
    let sections: &[&str] = if called.name == "simulate" { &["simulation", "errors"] } else { &["errors"] };
    let own = sections.iter().map(|section| format!("{section}.{key}")).find(|own| paths.contains(own));
    if let Some(own) = own {
        paths = vec![own];
    }
    let tips: Vec<_> = paths.iter().map(|path| StyledStr::from(format!("write --set {path}={value}"))).collect();
    if error.kind() == ErrorKind::UnknownArgument && !tips.is_empty() {
        // a merely similar option is no better
        error.remove(ContextKind::SuggestedArg);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
    }
    error
}

/// The beginnings of a setting that shells complete.
pub(super) fn keys() -> Vec<PossibleValue> {
    spec::keys().into_iter().map(|key| PossibleValue::new(key.path).help(key.doc)).collect()
}
