//! Keys set on the command line: `errors.rack_pitch=12um` replaces the value of the file, or adds the key, before the spec is
//! read. So the reader refuses the same in an option as in a file, with the same words.

use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::reader::type_in_words;
use crate::diagnostic::{Diagnostic, Source};

/// The option before a setting.
pub(crate) const SET: &str = "--set ";

/// The options as a text that diagnostics point into, one a line; `None` if there are none.
pub(super) fn options(settings: &[String]) -> Option<Arc<Source>> {
    let lines: Vec<_> = settings.iter().map(|setting| format!("{SET}{setting}")).collect();
    (!lines.is_empty()).then(|| Arc::new(Source::new("command line", lines.join("\n"))))
}

/// One option: the texts on both sides of its `=`, with places as if the options followed the text of the file.
pub(super) struct Setting<'a> {
    key: Piece<'a>,
    value: Option<Piece<'a>>,
    /// The value as the only entry of a list, whose place is the value's own.
    list: String,
}

/// The options after a file of so many bytes.
pub(super) fn settings<'a>(written: &'a [String], file_length: usize) -> Vec<Setting<'a>> {
    let mut start = file_length + 1;
    let setting = |text: &'a String| {
        start += SET.len();
        let (key, value) = text.split_once('=').map_or((text.as_str(), None), |(key, value)| (key, Some(value)));
        let value = value.map(|text| Piece { text, start: start + key.len() + 1 }.trimmed());
        let key = Piece { text: key, start }.trimmed();
        start += text.len() + 1;
        let list = value
            .map_or_else(String::new, |Piece { text, start }| format!("[{:blanks$}{text}]", "", blanks = start - 1));
        Setting { key, value, list }
    };
    written.iter().map(setting).collect()
}

/// Puts the settings into the table of a file; reports those that cannot be.
pub(super) fn set_all<'t>(top: &mut DeTable<'t>, settings: &'t [Setting<'_>], source: &Arc<Source>) -> Vec<Diagnostic> {
    let refused = settings.iter().enumerate().filter_map(|(index, setting)| {
        let key = setting.key.text;
        // an earlier setting would be lost with this one
        let is_lost = |before: &Setting<'_>| {
            before.key.text.strip_prefix(key).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let problem = match setting.typed_value() {
            None => format!("`{key}` has no value"),
            Some(_) if settings[..index].iter().any(is_lost) => format!("`{key}` is set twice"),
            Some(value) => set(top, setting.key, value).err()?,
        };
        let help = "write --set KEY=VALUE once for each key, such as --set errors.rack_pitch=12um; what is no table is set \
                    as a whole: --set 'errors.rack_pitch={ value = \"12um\", extent = \"each\" }'";
        Some(Diagnostic::usage(problem).help(help).at(source, setting.key.span(), ""))
    });
    refused.collect()
}

impl Setting<'_> {
    /// The value that TOML makes of the text, or else the text.
    fn typed_value(&self) -> Option<Spanned<DeValue<'_>>> {
        let value = self.value?;
        let entry = DeValue::parse(&self.list).ok().and_then(|list| match list.into_inner() {
            DeValue::Array(entries) if entries.len() == 1 => entries.into_iter().next(),
            _ => None,
        });
        // a value that ends early is not the whole text
        let entry = entry.filter(|entry| entry.span() == value.span());
        Some(entry.unwrap_or_else(|| Spanned::new(value.span(), DeValue::String(value.text.into()))))
    }
}

/// Sets a key, and adds the tables that it is in; says why it cannot.
fn set<'t>(top: &mut DeTable<'t>, key: Piece<'_>, value: Spanned<DeValue<'t>>) -> Result<(), String> {
    let mut table = top;
    let mut names = key.names();
    let Some(last) = names.pop() else { return Ok(()) };
    for name in names {
        let words = format!("`{}` has no keys to set: it is", name.get_ref());
        let empty = Spanned::new(name.span(), DeValue::Table(DeTable::new()));
        match table.entry(name).or_insert(empty).get_mut() {
            DeValue::Table(inner) => table = inner,
            other => return Err(format!("{words} {}", type_in_words(other))),
        }
    }
    // from here on the place of the key is the option
    table.remove(last.get_ref().as_ref());
    table.insert(last, value);
    Ok(())
}

/// A part of an option, and where it stands.
#[derive(Clone, Copy)]
struct Piece<'a> {
    text: &'a str,
    start: usize,
}

impl Piece<'_> {
    fn span(self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }

    fn trimmed(self) -> Self {
        let start = self.start + self.text.len() - self.text.trim_start().len();
        Self { text: self.text.trim(), start }
    }

    /// The names of a key and of the tables that it is in.
    fn names(self) -> Vec<Spanned<DeString<'static>>> {
        let mut start = self.start;
        let names = self.text.split('.').map(|name| {
            let name = Piece { text: name, start };
            start += name.text.len() + 1;
            Spanned::new(name.trimmed().span(), DeString::Owned(name.trimmed().text.to_owned()))
        });
        names.collect()
    }
}
