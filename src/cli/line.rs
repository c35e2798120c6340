//! The one line of standard error that is drawn over: every other output clears it first.

use std::io::{self, Write as _};
use std::sync::Mutex;

use crate::parallel::lock;

/// Whether the line stands on the terminal, and whether a run still waits to draw it.
struct Line {
    is_drawn: bool,
    is_waiting: bool,
}

static LINE: Mutex<Line> = Mutex::new(Line { is_drawn: false, is_waiting: false });

/// Draws or clears the line. An error of drawing is ignored, because there is no place to report it.
fn draw(line: &mut Line, text: Option<&str>) {
    let written = match text {
        Some(text) => format!("\r{text}\x1b[K"),
        None if line.is_drawn => "\r\x1b[K".to_owned(),
        None => return,
    };
    line.is_drawn = text.is_some();
    let _ = io::stderr().lock().write_all(written.as_bytes());
}

fn with_line(change: impl FnOnce(&mut Line)) {
    change(&mut lock(&LINE));
}

/// Clears the line for what is written next.
pub(super) fn clear() {
    with_line(|line| draw(line, None));
}

/// Ends the waiting: the run has its own bar, or a person types.
pub(super) fn no_waiting() {
    with_line(|line| {
        line.is_waiting = false;
        draw(line, None);
    });
}

/// Lets a run draw the line while it waits.
pub(super) fn begin_waiting() {
    with_line(|line| line.is_waiting = true);
}

/// Draws the line for a run that still waits.
pub(super) fn draw_waiting(text: &str) {
    with_line(|line| {
        if line.is_waiting {
            draw(line, Some(text));
        }
    });
}

/// Draws the line.
pub(super) fn draw_line(text: &str) {
    with_line(|line| draw(line, Some(text)));
}
