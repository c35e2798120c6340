//! `--set KEY=VALUE`, and the spec that is read with it, for every subcommand that takes a spec.

use std::borrow::Cow;
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
use crate::diagnostic::{Diagnostic, nearest};
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
        self.parse(&stream::name(path), &text(path)?, output)
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

/// The text of a spec or a layout; `-` is standard input.
pub(super) fn text(path: &Path) -> Result<String, Failure> {
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
    Ok(String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        Diagnostic::unreadable(name, &format!("it is not text in UTF-8 (byte {valid})")).help(spec::NOT_A_SPEC)
    })?)
}

/// The error in the arguments, with what is most likely meant: `--preload 2000` is `--set simulation.preload=2000`, and
/// `--json` is `--format json`.
pub(super) fn with_settings(arguments: &[OsString], mut error: clap::Error) -> clap::Error {
    if let Some(ContextValue::String(name)) = error.get(ContextKind::InvalidSubcommand) {
        let known = super::subcommands().map(|known| known.name);
        if let Some(nearest) = nearest(name, known) {
            let nearest = ContextValue::Strings(vec![nearest.to_owned()]);
            error.insert(ContextKind::SuggestedSubcommand, nearest);
        }
        return error;
    }
    let Some(ContextValue::String(option)) = error.get(ContextKind::InvalidArg).cloned() else { return error };
    let Some(name) = option.strip_prefix("--") else { return error };
    if error.kind() != ErrorKind::UnknownArgument {
        return error;
    }
    // no value begins with two hyphens, so that it would stand behind `--`
    error.remove(ContextKind::Suggested);
    let words: Vec<_> = arguments.iter().map(|word| word.to_string_lossy()).collect();
    let called = words.iter().find_map(|word| super::subcommands().find(|known| known.name == word));
    let Some(called) = called else { return error };
    let mut command = (called.arguments)(clap::Command::new(called.name).bin_name(format!("rackmesh {}", called.name)));
    let tips = tips(name, &command, called.name, &words);
    if !tips.is_empty() {
        // an option that only looks alike is no better
        error.remove(ContextKind::SuggestedArg);
        error.insert(ContextKind::Usage, ContextValue::StyledStr(command.render_usage()));
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
    }
    error
}

/// What an option that a command does not have may mean: a format, a key of the spec, an option of another command.
fn tips(name: &str, command: &clap::Command, called: &str, words: &[Cow<'_, str>]) -> Vec<StyledStr> {
    /// Of keys; more are no answer.
    const MOST: usize = 4;
    let argument = |id: &str| command.get_arguments().find(|argument| argument.get_id() == id);
    let formats = argument("format").map(clap::Arg::get_possible_values).unwrap_or_default();
    if formats.iter().any(|format| format.matches(name, false)) {
        return vec![format!("write --format {name}").into()];
    }
    if argument("set").is_none() {
        return of_others(name);
    }
    let option = format!("--{name}");
    let value = words.iter().enumerate().find_map(|(index, word)| match word.strip_prefix(option.as_str())? {
        "" => words.get(index + 1).map(|next| &**next).filter(|next| !next.starts_with("--")),
        rest => rest.strip_prefix('='),
    });
    let value = value.unwrap_or("…");
    let key = name.replace('-', "_");
    let all: Vec<_> = spec::keys().into_iter().map(|key| key.path).collect();
    let ending = |end: String| {
        let is_of_a_part = |path: &&String| path.ends_with(&end) && !path.starts_with("table.");
        all.iter().filter(is_of_a_part).collect::<Vec<_>>()
    };
    let mut paths = ending(format!(".{key}"));
    // an error is most likely meant, for a simulation one of its own keys
    let sections: &[&str] = if called == "simulate" { &["simulation", "errors"] } else { &["errors"] };
    let is_own = |path: &&String| sections.iter().any(|section| **path == format!("{section}.{key}"));
    if let Some(own) = paths.iter().copied().find(is_own) {
        paths = vec![own];
    } else if paths.is_empty() {
        paths = ending(format!("_{key}"));
    }
    let settings = paths.iter().take(MOST).map(|path| format!("write --set {path}={value}").into());
    settings.chain(of_others(name)).collect()
}

/// The commands that have an option, in words.
fn of_others(name: &str) -> Vec<StyledStr> {
    let has_it = |known: &&super::Subcommand| {
        let command = (known.arguments)(clap::Command::new(known.name));
        command.get_arguments().any(|argument| argument.get_long() == Some(name))
    };
    let commands: Vec<_> = super::subcommands().filter(has_it).map(|known| known.name).collect();
    let tip = || format!("--{name} is an option of {}", commands.join(", ")).into();
    (!commands.is_empty()).then(tip).into_iter().collect()
}

/// The beginnings of a setting that shells complete.
pub(super) fn keys() -> Vec<PossibleValue> {
    spec::keys().into_iter().map(|key| PossibleValue::new(key.path).help(key.doc)).collect()
}
