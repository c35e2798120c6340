//! The progress of a run on a terminal: one line of standard error that is drawn over, and cleared before anything else is
//! written.

use std::io::{self, IsTerminal as _};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::line::{begin_waiting, clear, draw_line, draw_waiting, no_waiting};
use super::output::{Output, is_dumb};
use crate::parallel::lock;

fn is_watched(output: &Output) -> bool {
    io::stderr().is_terminal() && !is_dumb() && !output.is_quiet()
}

/// A run whose progress is not known: from a second on, the line shows the time taken.
pub(super) struct Waiting {
    over: Sender<()>,
}

impl Waiting {
    /// Begins to wait for the work `name`, if the output is a terminal.
    pub(super) fn begin(name: &str, output: &Output) -> Option<Self> {
        const EVERY: Duration = Duration::from_secs(1);
        if !is_watched(output) {
            return None;
        }
        begin_waiting();
        let (over, is_over) = channel::<()>();
        let (name, begun) = (name.to_owned(), Instant::now());
        std::thread::spawn(move || {
            while is_over.recv_timeout(EVERY) == Err(RecvTimeoutError::Timeout) {
                let text = format!("{name}: {:.0} s", begun.elapsed().as_secs_f64());
                draw_waiting(&text);
            }
        });
        Some(Self { over })
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        no_waiting();
        // the thread may have ended before
        let _ = self.over.send(());
    }
}

/// The progress of a run, where it is known.
///
/// Written here, because libraries for it load the platform's mathematics at every start of the program, also of `eval`.
pub(super) struct Bar {
    watched: bool,
    begun: Instant,
    drawn: Option<Instant>,
}

impl Bar {
    pub(super) fn new(output: &Output) -> Self {
        Self { watched: is_watched(output), begun: Instant::now(), drawn: None }
    }

    /// Since the run began, s.
    pub(super) fn seconds(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    /// Draws the line, if it is time to: `share` is how much is done, 0 to 1, if that is known.
    pub(super) fn show(&mut self, share: Option<f64>, message: impl FnOnce() -> String) {
        /// A shorter run shows nothing.
        const EVERY: Duration = Duration::from_millis(100);
        const CELLS: usize = 20;
        if !self.watched || self.drawn.unwrap_or(self.begun).elapsed() < EVERY {
            return;
        }
        if self.drawn.is_none() {
            no_waiting();
        }
        self.drawn = Some(Instant::now());
        let mut text = message();
        if let Some(share) = share {
            let share = share.clamp(0.0, 1.0);
            // between 0 and the number of cells
            let full = (share * CELLS as f64) as usize;
            text.push_str(&format!("  {}{} {:.0} %", "█".repeat(full), "░".repeat(CELLS - full), 100.0 * share));
            if share > 0.0 {
                text.push_str(&format!("  {:.0} s left", self.seconds() * (1.0 - share) / share));
            }
        }
        draw_line(&text);
    }

    /// Clears the line.
    pub(super) fn finish(&self) {
        if self.drawn.is_some() {
            clear();
        }
    }
}

/// The progress of work on several threads.
pub(super) struct SharedBar(Mutex<Bar>);

impl SharedBar {
    pub(super) fn new(output: &Output) -> Self {
        Self(Mutex::new(Bar::new(output)))
    }

    /// Draws the line, if it is time to.
    pub(super) fn show(&self, share: Option<f64>, what: &str) {
        lock(&self.0).show(share, || what.to_owned());
    }
}

/// Clears the line.
impl Drop for SharedBar {
    fn drop(&mut self) {
        self.0.get_mut().unwrap_or_else(PoisonError::into_inner).finish();
    }
}
