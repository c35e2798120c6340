//! What a program holds in place of files and a terminal: the spec that is asked about, and the answer.

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
    /// What messages call it, and what the tables that it names are beside.
    pub name: String,
    /// Its text.
    pub text: String,
}

/// Results in columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ColumnTable {
    /// The names of the columns, and what they hold.
    pub columns: Vec<(String, ColumnKind)>,
    /// Their values.
    pub results: ResultColumns,
}

/// What a command says of a spec.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Answer {
    /// The result, as `--format json` writes it.
    pub json: Value,
    /// The result for people, in Markdown.
    pub markdown: String,
    /// A picture of the result in SVG: what `--plot` draws, if there are two values to draw between.
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

/// What is wanted of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Facts {
    /// All facts, the text for people and the picture.
    #[default]
    WithText,
    /// All facts.
    All,
    /// Those that are compared from design to design.
    Brief,
}

/// What a command is asked, and what it said so far.
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
