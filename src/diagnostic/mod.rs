//! Diagnostics: what is wrong, where, and what to do about it.
//!
//! Readers and checks build a [`Diagnostic`]; the command line shows it. Each kind of problem has a
//! stable [`Code`], whose page `rackmesh explain CODE` prints. Every module may use this one; it uses
//! none.

mod code;
mod harmless;
#[cfg(feature = "table")]
mod nearest;
#[cfg(feature = "spec")]
mod render;
mod wrap;

pub use code::Code;
pub use harmless::{harmless, harmless_lines, is_formula, is_steering};
#[cfg(feature = "spec")]
pub(crate) use nearest::nearest;
#[cfg(feature = "table")]
pub(crate) use nearest::nearest_or;
#[cfg(feature = "spec")]
pub use render::render;
pub use wrap::wrap;

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A text that diagnostics point into.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Source {
    /// The file's name, as the user gave it.
    pub name: String,
    /// The text: the whole one, or a line of it.
    pub text: String,
    /// Lines of the file before it.
    pub lines_before: usize,
    /// A text that counts as following this one, with a byte between them: what the command line adds to a file.
    pub next: Option<Arc<Self>>,
}

impl Source {
    /// A text that stands alone.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self { name: name.into(), text: text.into(), lines_before: 0, next: None }
    }

    /// The text that holds these bytes, this one or the next, and their place in it.
    #[must_use]
    pub fn holding(self: &Arc<Self>, span: Range<usize>) -> (Arc<Self>, Range<usize>) {
        let offset = self.text.len() + 1;
        match &self.next {
            Some(next) if span.start >= offset => (Arc::clone(next), span.start - offset..span.end - offset),
            _ => (Arc::clone(self), span),
        }
    }
}

/// How serious a problem is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// There is no result.
    Error,
    /// There is a result, but the reader should know this.
    Warning,
}

/// A place in a source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The text.
    pub source: Arc<Source>,
    /// Bytes of it.
    pub span: Range<usize>,
    /// What stands there, in a few words; may be empty.
    pub label: Box<str>,
}

impl Place {
    /// Line and column, both from 1; the column counts characters.
    #[must_use]
    pub fn line_and_column(&self) -> (usize, usize) {
        let text = &self.source.text;
        let mut start = self.span.start.min(text.len());
        while !text.is_char_boundary(start) {
            start -= 1;
        }
        let before = &text[..start];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        (self.source.lines_before + before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}

/// A line below a message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListLine {
    /// What it says.
    pub text: String,
    /// Whether a user copies it, such as a line of a spec. Such a line is not wrapped.
    pub is_copied: bool,
}

/// One problem.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// The kind of problem.
    pub code: Code,
    /// How serious it is.
    pub severity: Severity,
    /// What is wrong.
    pub message: String,
    /// What the message is about, a line each.
    pub list: Box<[ListLine]>,
    /// Where, if it is in a file.
    pub place: Option<Place>,
    /// The file that it is about, where no place in it is known.
    pub file: Option<Arc<str>>,
    /// What to do.
    pub help: Option<Box<str>>,
}

impl Diagnostic {
    /// An error.
    pub fn error(code: Code, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: Severity::Error,
            message: message.into(),
            list: Box::default(),
            place: None,
            file: None,
            help: None,
        }
    }

    /// An error in what was asked for.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::error(Code::Usage, message)
    }

    /// Turns an error of a computation into a diagnostic: `map_err(Diagnostic::with_code(code))`.
    pub fn with_code<E: std::fmt::Display>(code: Code) -> impl FnOnce(E) -> Self {
        move |error| Self::error(code, error.to_string())
    }

    /// A file that cannot be read, and why.
    #[must_use]
    pub fn unreadable(name: &str, problem: &dyn std::fmt::Display) -> Self {
        Self::error(Code::FileAccess, format!("cannot read {name}: {problem}")).about(name)
    }

    /// A warning.
    pub fn warning(code: Code, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, message) }
    }

    /// Adds where the problem is, if that is known.
    #[must_use]
    pub fn at(
        mut self,
        source: &Arc<Source>,
        span: impl Into<Option<Range<usize>>>,
        label: impl Into<Box<str>>,
    ) -> Self {
        if let Some(span) = span.into() {
            let (source, span) = source.holding(span);
            self.place = Some(Place { source, span, label: label.into() });
        }
        self
    }

    /// Adds the file that the problem is about, unless one is known.
    #[must_use]
    pub fn about(mut self, file: &str) -> Self {
        self.file.get_or_insert_with(|| file.into());
        self
    }

    /// What is wrong and what to do, as a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        match &self.help {
            Some(help) => format!("{}; {help}", self.message_with_list()),
            None => self.message_with_list(),
        }
    }

    /// What is wrong, with its list below.
    #[must_use]
    pub fn message_with_list(&self) -> String {
        self.list.iter().fold(self.message.clone(), |text, line| text + "\n  " + &line.text)
    }

    /// Adds what to do.
    #[must_use]
    pub fn help(mut self, help: impl Into<Box<str>>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// `file:line:column: error[code]: message`, on one line.
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            let (line, column) = place.line_and_column();
            write!(f, "{}:{line}:{column}: ", place.source.name)?;
        }
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        write!(f, "{severity}[{}]: {}", self.code, self.message_with_list())
    }
}

/// Why there is no result: one problem or several, found in one go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostics(pub Vec<Diagnostic>);

impl From<Diagnostic> for Diagnostics {
    fn from(diagnostic: Diagnostic) -> Self {
        Self(vec![diagnostic])
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, diagnostic) in self.0.iter().enumerate() {
            if index > 0 {
                f.write_str("\n")?;
            }
            diagnostic.fmt(f)?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}
