//! The spec and the answer in the memory of a program, in place of files and a terminal.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use serde_json::Value;

use crate::batch::{ColumnKind, ResultColumns};
use crate::diagnostic::Diagnostic;
use crate::spec::Spec;

/// A spec that a program holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeldSpec {
    /// Its name in messages; the tables that it names are relative to it.
    pub name: String,
    /// Its text.
    pub text: String,
}

/// Results in columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ColumnTable {
    /// The names of the columns, and their kinds.
    pub columns: Vec<(String, ColumnKind)>,
    /// Their values.
    pub results: ResultColumns,
}

/// The answer of a command about a spec.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Answer {
    /// The result, as `--format json` writes it.
    pub json: Value,
    /// The result for people, in Markdown.
    pub markdown: String,
    /// A picture of the result in SVG, as by `--plot`, if there is something to draw.
    pub svg: Option<String>,
    /// The rows of a result that is a table.
    pub table: Option<ColumnTable>,
    /// Warnings.
    pub warnings: Vec<Diagnostic>,
    /// Remarks on the result.
    pub remarks: Vec<String>,
    /// The exit status: 0 to 3 as the command documents, or what belongs to the signal that ended it.
    pub status: u8,
}

/// Which parts of an answer are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Facts {
    /// All facts, the text for people and the picture.
    #[default]
    WithText,
    /// All facts.
    All,
    /// The facts that are compared from design to design.
    Brief,
    /// Those that no limit judges.
    Unjudged,
}

/// The request to a command, and its messages so far.
#[derive(Debug, Default)]
pub(super) struct Held {
    /// Specs, each with its own settings.
    pub(super) specs: VecDeque<(HeldSpec, Vec<String>)>,
    /// In its place, a spec that is read already.
    pub(super) read: Option<Spec>,
    pub(super) facts: Facts,
    /// Ends the run early.
    pub(super) stop: Arc<AtomicBool>,
    pub(super) answer: Answer,
}
