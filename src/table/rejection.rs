//! What cells, comments and lines say against a part or its value: it counts all the same, and a warning names them.

use super::cell::Cell;
use super::names::{Role, WordList, role};
use crate::quantity::shown;

/// Stands before and behind what is struck through, as Markdown has it.
pub(crate) const STRUCK: &str = "~~";

/// What is said against a part or its value, which count all the same.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Rejection {
    /// The column, comment or line that says it.
    title: String,
    said: String,
}

impl Rejection {
    /// As a note on a file.
    pub(crate) fn in_words(&self, file: &str) -> String {
        let Self { title, said } = self;
        let said = if said.is_empty() { "says nothing of a part".to_owned() } else { format!("says `{said}`") };
        format!("{file}: `{title}` {said}: that is not used, and parts are judged by their values")
    }
}

/// What a column or a comment says against a part or its value: `NOK`, `Messwert ungültig`, a mark below `Ausschuss`, what is no
/// approval in a column of `verdicts`, nothing there beside approvals, or the code of a rejection in SAP, `R`.
pub(crate) fn rejection<'a>(
    title: &str,
    cells: impl IntoIterator<Item = &'a Cell>,
    verdicts: bool,
) -> Option<Rejection> {
    let is_fault = WordList::Fault.has(title);
    let is_heading = is_fault || WordList::Disapproval.is_in(title) || WordList::Rejected.is_in(title);
    // a machine `NC 3` says nothing of parts
    let is_place = WordList::Place.has(title) || WordList::Person.has(title);
    let is_no = |text: &str| WordList::Negation.has(text);
    let is_approval = |text: &str| WordList::Approval.has(text) || verdicts && WordList::Yes.has(text);
    let is_open = verdicts && is_of_validity(title);
    let is_said = |text: &str| {
        !is_place && (WordList::Disapproval.is_claimed_in(text) || says_rejected(text))
            || WordList::Validity.has(title) && is_no(text)
            || is_heading && !is_no(text) && !is_approval(text) && !says_none(text)
            || text.starts_with(STRUCK)
            || verdicts && !is_approval(text)
            || matches!(text, "R" | "OUT" | "***" | "!" | "a.T.") && role(title) == Some(Role::Status)
            || denies_validity(text)
    };
    let is_against = |cell: &&Cell| if cell.is_missing() { is_open } else { is_said(&cell.text()) };
    let against = cells.into_iter().find(is_against)?;
    Some(Rejection { title: title.to_owned(), said: shown(&against.text()) })
}

/// Whether a column is called by what says that a part is good: `Freigabe`, `Over roller valid`, `M_OK`.
pub(crate) fn is_of_validity(title: &str) -> bool {
    WordList::Validity.is_in(&title.replace('_', " "))
}

/// Whether a text says that there is nothing: `keine`, `no error`, `E00`.
fn says_none(text: &str) -> bool {
    let first = text.split([' ', '_']).next().unwrap_or_default();
    let is_zero = text.contains('0') && text.chars().all(|c| c == '0' || c.is_alphabetic());
    is_zero || WordList::NoneOfIt.has(first)
}

/// Whether a line says of a release or the like that there is none: `Freigabe: nein`, and does not ask for it: `ja / nein`.
fn denies_validity(text: &str) -> bool {
    if text.contains('/') {
        return false;
    }
    let mut words = text.split([' ', ':', ';']).filter(|word| !word.is_empty());
    let is_no = |word: &str| word.len() > 1 && WordList::Negation.has(word);
    words.next().is_some_and(|first| WordList::Validity.has(first)) && words.any(is_no)
}

/// Whether a text says that something does not count, and not that there is none, or that a paper needs a signature.
pub(crate) fn says_rejected(text: &str) -> bool {
    WordList::Rejected.is_claimed_in(text) && !WordList::Paper.is_in(text)
}

/// Adds what is said, if the same column or kind of line has said nothing so far.
pub(crate) fn add(rejections: &mut Vec<Rejection>, more: impl IntoIterator<Item = Rejection>) {
    for rejection in more {
        if rejections.iter().all(|known| known.title != rejection.title) {
            rejections.push(rejection);
        }
    }
}
