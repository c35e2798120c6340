//! What a program holds in place of files and a terminal: the spec that is asked about, and the answer.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use serde_json::Value;

use crate::diagnostic::Diagnostic;

/// A spec that a program holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeldSpec {
    /// What messages call it, and what the tables that it names are beside.
    pub name: String,
    /// Its text.
    pub text: String,
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
    /// Warnings.
    pub warnings: Vec<Diagnostic>,
    /// Remarks on the result.
    pub remarks: Vec<String>,
    /// The exit status: 0 to 3 as the command documents, or what belongs to the signal that ended it.
    pub status: u8,
}

/// What a command is asked, and what it said so far.
#[derive(Debug, Default)]
pub(super) struct Held {
    pub(super) spec: Option<HeldSpec>,
    /// Ends the run early.
    pub(super) stop: Arc<AtomicBool>,
    pub(super) answer: Answer,
}
