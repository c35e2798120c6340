//! A progress bar where somebody watches.

use std::io::{self, IsTerminal as _, Write as _};
use std::time::{Duration, Instant};

use super::output::{Output, is_dumb};

/// How far a run is, on one line of standard error that is drawn over and cleared at the end; nothing at all unless
/// that is a terminal that can.
///
/// Our own, because the libraries for it load the platform's mathematics at every start of the program, `eval`'s too.
pub(super) struct Bar {
    watched: bool,
    begun: Instant,
    drawn: Option<Instant>,
}

impl Bar {
    pub(super) fn new(output: &Output) -> Self {
        Self {
            watched: io::stderr().is_terminal() && !is_dumb() && !output.is_quiet(),
            begun: Instant::now(),
            drawn: None,
        }
    }

    /// Since the run began, s.
    pub(super) fn seconds(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    /// Draws the line, if it is time to: `share` is how much is done, 0 to 1, if that is known.
    pub(super) fn show(&mut self, share: Option<f64>, message: impl FnOnce() -> String) {
        /// A run that is over sooner shows nothing.
        const EVERY: Duration = Duration::from_millis(100);
        const CELLS: usize = 20;
        if !self.watched || self.drawn.unwrap_or(self.begun).elapsed() < EVERY {
            return;
        }
        self.drawn = Some(Instant::now());
        let mut line = format!("\r{}", message());
        if let Some(share) = share {
            let share = share.clamp(0.0, 1.0);
            // between 0 and the number of cells
            let full = (share * CELLS as f64) as usize;
            line.push_str(&format!("  {}{} {:.0} %", "█".repeat(full), "░".repeat(CELLS - full), 100.0 * share));
            if share > 0.0 {
                line.push_str(&format!("  {:.0} s left", self.seconds() * (1.0 - share) / share));
            }
        }
        line.push_str("\x1b[K");
        // nobody is there to be told that the bar cannot be drawn
        let _ = io::stderr().lock().write_all(line.as_bytes());
    }

    /// Clears the line.
    pub(super) fn finish(&self) {
        if self.drawn.is_some() {
            let _ = io::stderr().lock().write_all(b"\r\x1b[K");
        }
    }
}
