//! Diagnostics as people read them: the line, a caret, what to do. Called by the command line; the words are in the
//! diagnostic.

use std::borrow::Cow;
use std::ops::Range;

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};

use super::harmless::escaped;
use super::{Diagnostic, Place, Severity, harmless, wrap};

/// Of a longer line only the place is shown.
const LONGEST: usize = 10_000;

/// The diagnostic with the line it points at; `color` adds terminal colours. Nothing else in it steers a terminal. Message and help are
/// wrapped between words to fit `width`, if there is one.
#[must_use]
pub fn render(diagnostic: &Diagnostic, color: bool, width: Option<u16>) -> String {
    /// What stands before help.
    const HELP: u16 = "   = help: ".len() as u16;
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let message = harmless(&diagnostic.message).into_owned();
    // `error[code]: `
    let before = u16::try_from(diagnostic.code.name().len()).unwrap_or(0) + 11;
    let width_of_message = width.map(|width| width.saturating_sub(before));
    let listed = diagnostic.list.iter().filter(|line| !line.is_copied);
    let message = listed.fold(wrap(&message, width_of_message), |text, line| {
        text + "\n" + &wrap(&format!("  {}", harmless(&line.text)), width_of_message)
    });
    let count = message.lines().count();
    let title = level.primary_title(message).id(diagnostic.code.name());
    let mut group = Group::with_title(title);
    let lines = diagnostic.place.as_ref().map(Lines::of);
    if let (Some(Lines { name, text, .. }), Some(place)) = (&lines, &diagnostic.place)
        && text.len() > LONGEST
    {
        let (line, column) = place.line_and_column();
        group = group.element(Origin::path(name.as_ref()).line(line).char_column(column));
    } else if let Some(Lines { name, text, first, span, label }) = &lines {
        let mut annotation = AnnotationKind::Primary.span(span.clone());
        if !label.is_empty() {
            annotation = annotation.label(label.as_ref());
        }
        let snippet = Snippet::source(text.as_ref()).line_start(*first).path(name.as_ref());
        group = group.element(snippet.annotation(annotation));
    }
    let help = diagnostic.help.as_deref().map(harmless);
    let help = help.map(|help| wrap(&help, width.map(|width| width.saturating_sub(HELP))));
    if let Some(help) = &help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    let text = renderer.render(&[group]);
    if lines.is_some() {
        return text;
    }
    // without a place, the bar above the help stands alone
    let is_bar = |line: &&str| line.chars().filter(|c| !"\u{1b}[0123456789;m ".contains(*c)).eq(['|']);
    let mut all: Vec<Cow<'_, str>> = text.lines().map(Cow::from).collect();
    if let Some(bar) = all.iter().rposition(|line| is_bar(&&**line)) {
        all.remove(bar);
    }
    // lines to be copied are neither broken nor moved to the right
    let copied = diagnostic.list.iter().filter(|line| line.is_copied).map(|line| harmless(&line.text));
    let at = count.min(all.len());
    all.splice(at..at, copied);
    all.join("\n")
}

/// The lines of a place, as they are shown.
struct Lines<'p> {
    name: Cow<'p, str>,
    text: Cow<'p, str>,
    /// The number of the first line, from 1.
    first: usize,
    /// Bytes of the text.
    span: Range<usize>,
    label: Cow<'p, str>,
}

impl<'p> Lines<'p> {
    fn of(place: &'p Place) -> Self {
        // the renderer shows a tab and the carriage return before a line's end by itself
        let visible = |text| escaped(text, "\n\t\r");
        let text = place.source.text.as_str();
        let [start, end] = [place.span.start, place.span.end].map(|at| text.floor_char_boundary(at));
        let begin = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        let stop = text[end..].find('\n').map_or(text.len(), |newline| end + newline);
        let at = |end| visible(&text[begin..end]).len();
        Self {
            name: harmless(&place.source.name),
            text: visible(&text[begin..stop]),
            first: place.source.lines_before + text[..begin].matches('\n').count() + 1,
            span: at(start)..at(end.max(start)),
            label: harmless(&place.label),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::{Code, ListLine};

    #[test]
    fn lines_that_are_copied_are_not_broken() {
        let line =
            "rack_pitch = { name = \"pitch of the rack\", unit = \"um\" }   # a guess: its numbers are of that size";
        let message = "a line has no owner, and is shown here at some length, so that it has to be broken";
        let copied = ListLine { text: line.to_owned(), is_copied: true };
        let error = Diagnostic { list: [copied].into(), ..Diagnostic::error(Code::NotUnderstood, message) };
        let shown = render(&error, false, Some(40));
        assert!(shown.contains(line) && !shown.contains(message), "{shown}");
    }
}
