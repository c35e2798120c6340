//! `--set KEY=VALUE`, and the spec that is read with it: what every subcommand that takes a spec has in common.

use std::ffi::OsStr;
use std::io::Read as _;
use std::path::Path;

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};

use super::held::HeldSpec;
use super::output::{Failure, Output};
use super::stream;
use super::target::is_dash;
use crate::diagnostic::Diagnostic;
use crate::spec::{self, LARGEST_SPEC, Spec};

#[derive(Debug, Clone, Default, clap::Args)]
pub(super) struct SetArgs {
    /// Set a key of the spec, in place of what the file says: `errors.rack_pitch=12um`; may be repeated. The keys are
    /// those of `rackmesh explain keys`.
    #[arg(long, value_name = "KEY=VALUE", value_parser = Keys, hide_possible_values = true)]
    set: Vec<String>,
}

impl SetArgs {
    /// Reads and parses the spec at `path`; `-` is standard input.
    pub(super) fn read_spec(&self, path: &Path, output: &mut Output) -> Result<Spec, Failure> {
        if let Some(HeldSpec { name, text }) = output.held_spec() {
            return self.parse(&name, &text, output);
        }
        let mut bytes = Vec::new();
        let name = &stream::name(path);
        let most = LARGEST_SPEC as u64 + 1;
        let read = if is_dash(path) {
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

/// Takes any text, and tells shells the keys that it may begin with.
#[derive(Clone)]
struct Keys;

impl TypedValueParser for Keys {
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
        Some(Box::new(spec::keys().into_iter().map(|key| PossibleValue::new(key.path).help(key.doc))))
    }
}
