//! Diagnostics as people read them: the line, a caret, what to do. Called by the command line; the words are in the
//! diagnostic.

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

use super::{Diagnostic, Severity};

/// The diagnostic with the line it points at; `color` adds terminal colours.
#[must_use]
pub fn render(diagnostic: &Diagnostic, color: bool) -> String {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(diagnostic.message.as_str()).id(diagnostic.code.name());
    let mut group = Group::with_title(title);
    if let Some(place) = &diagnostic.place {
        let length = place.source.text.len();
        let span = place.span.start.min(length)..place.span.end.min(length);
        let mut annotation = AnnotationKind::Primary.span(span);
        if !place.label.is_empty() {
            annotation = annotation.label(place.label.as_str());
        }
        let snippet = Snippet::source(place.source.text.as_str()).path(place.source.name.as_str());
        group = group.element(snippet.annotation(annotation));
    }
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    renderer.render(&[group])
}
