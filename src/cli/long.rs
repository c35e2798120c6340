//! What long runs share: a progress bar where somebody watches, and Ctrl-C or SIGTERM that keep what is there.

use std::io::{self, IsTerminal as _, Write as _};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::output::{Output, Status, is_dumb};

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

/// The signals that end a run early, each with the exit code that shells give to a program ended by it.
const SIGNALS: [(i32, u8); 2] = [(SIGINT, 130), (SIGTERM, 143)];

/// Whether Ctrl-C or SIGTERM has come, and which of them.
pub(super) struct Interruption {
    stop: Arc<AtomicBool>,
    signal: Arc<AtomicUsize>,
}

/// What is said where a signal ends a run that has no result yet.
pub(super) const NOTHING_YET: &str = "interrupted before there was a result: nothing was judged";

impl Interruption {
    /// What a run looks at from time to time; set by the first signal.
    pub(super) fn stop(&self) -> &Arc<AtomicBool> {
        &self.stop
    }

    /// Runs what only waits for input and looks at it, be it for ever: where a signal comes before it is through, the
    /// program does `end` and is over.
    pub(super) fn while_waiting<T>(&self, look: impl FnOnce() -> T, end: impl FnOnce() + Send) -> T {
        const INTERVAL: Duration = Duration::from_millis(20);
        let (looking, looked) = channel::<()>();
        std::thread::scope(|scope| {
            scope.spawn(move || {
                loop {
                    let is_through = looked.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Disconnected);
                    if let Some(status) = self.status() {
                        end();
                        std::process::exit(status.code().into());
                    }
                    if is_through {
                        return;
                    }
                }
            });
            let found = look();
            drop(looking);
            found
        })
    }

    /// How a command ends that a signal has stopped; `None` if none has come.
    pub(super) fn status(&self) -> Option<Status> {
        let came = self.signal.load(Ordering::Relaxed);
        let code = SIGNALS.iter().find(|(signal, _)| usize::try_from(*signal) == Ok(came)).map(|(_, code)| *code);
        code.map(Status::Interrupted)
    }
}

/// From here on the first Ctrl-C or SIGTERM is for the run to see; the second ends the program at once. A program that holds the
/// answer has signals of its own, and says when to stop.
pub(super) fn interrupted(output: &Output) -> Interruption {
    if let Some(stop) = output.stop() {
        return Interruption { stop: Arc::clone(stop), signal: Arc::default() };
    }
    let (stop, signal) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicUsize::new(0)));
    for (number, code) in SIGNALS {
        // What comes first is asked first: at the first signal the flag is not set. Without a handler a signal ends the
        // program at once, which is no reason not to run.
        let _ = flag::register_conditional_shutdown(number, i32::from(code), Arc::clone(&stop));
        if let Ok(itself) = usize::try_from(number) {
            let _ = flag::register_usize(number, Arc::clone(&signal), itself);
        }
        let _ = flag::register(number, Arc::clone(&stop));
    }
    Interruption { stop, signal }
}
