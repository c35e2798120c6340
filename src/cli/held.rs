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

/// What a command is asked, and what it said so far.
#[derive(Debug, Default)]
pub(super) struct Held {
    pub(super) spec: Option<HeldSpec>,
    /// Ends the run early.
    pub(super) stop: Arc<AtomicBool>,
    pub(super) json: Value,
    pub(super) markdown: String,
    pub(super) svg: Option<String>,
    pub(super) warnings: Vec<Diagnostic>,
    pub(super) remarks: Vec<String>,
}
