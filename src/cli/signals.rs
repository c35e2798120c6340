//! Signals that end a run early: Ctrl-C, SIGTERM, and SIGHUP of a terminal that is closed. A run that checks for a signal ends itself
//! with the results so far; a run that does not check, or is too slow, is ended from here. Either way the files that it has begun
//! are kept as partial ones, and the program ends within a second.

use std::io::{self, IsTerminal as _, Write as _};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, LazyLock, Once};
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{flag, low_level};

use super::output::{Output, Status, is_dumb};
use super::target;

/// The signals that end a run, each with the exit code that shells give to a program ended by it.
#[cfg(unix)]
const SIGNALS: [(i32, u8); 3] = [(SIGINT, 130), (SIGTERM, 143), (signal_hook::consts::SIGHUP, 129)];
#[cfg(not(unix))]
const SIGNALS: [(i32, u8); 2] = [(SIGINT, 130), (SIGTERM, 143)];

/// How often signals are checked.
const INTERVAL: Duration = Duration::from_millis(20);

/// The message where a signal ends a run without a result.
pub(super) const NOTHING_YET: &str = "interrupted before there was a result: nothing was judged";

/// The text of reports that replace older ones.
const WHY: &str = "the run was interrupted: not all parts were checked";

/// The flag that a run checks from time to time; set by the first signal.
static STOP: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
/// The last signal; 0 without one.
static LAST: LazyLock<Arc<AtomicUsize>> = LazyLock::new(Arc::default);
/// A signal that was not handled yet; 0 without one.
static UNSEEN: LazyLock<Arc<AtomicUsize>> = LazyLock::new(Arc::default);
/// Whether the command line runs: before and after, signals belong to the program around it.
static RUNS: AtomicBool = AtomicBool::new(false);
/// Whether the run checks `STOP`.
static LOOKS: AtomicBool = AtomicBool::new(false);

/// Whether a signal has come, and which of them.
pub(super) struct Interruption {
    stop: Arc<AtomicBool>,
    /// Whether the signals are those of this process.
    is_own: bool,
}

/// Takes over the signals as long as the value is there.
pub(super) fn watch() -> Watched {
    static BEGIN: Once = Once::new();
    // signals of an earlier run
    STOP.store(false, Ordering::Relaxed);
    LAST.store(0, Ordering::Relaxed);
    UNSEEN.store(0, Ordering::Relaxed);
    BEGIN.call_once(|| {
        // without a handler a signal ends the program at once, which is acceptable
        for (number, _) in SIGNALS.into_iter().filter(|(number, _)| !is_ignored(*number)) {
            let itself = usize::try_from(number).unwrap_or_default();
            let _ = flag::register_usize(number, Arc::clone(&LAST), itself);
            let _ = flag::register(number, Arc::clone(&STOP));
            let _ = flag::register_usize(number, Arc::clone(&UNSEEN), itself);
        }
        // a file that grows too large is an error of writing where the signal for it is handled
        #[cfg(unix)]
        let _ = flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
        std::thread::spawn(end_in_time);
    });
    RUNS.store(true, Ordering::Relaxed);
    Watched
}

/// The command line runs.
pub(super) struct Watched;

impl Drop for Watched {
    fn drop(&mut self) {
        LOOKS.store(false, Ordering::Relaxed);
        RUNS.store(false, Ordering::Relaxed);
    }
}

/// Whether the program was started with this signal ignored, as by `nohup`. Only SIGHUP is checked, because shells ignore SIGINT in
/// background jobs that it should end.
fn is_ignored(signal: i32) -> bool {
    #[cfg(target_os = "linux")]
    if signal == signal_hook::consts::SIGHUP {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        return mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1);
    }
    let _ = signal;
    false
}

/// Waits for a signal, and ends the program if the run does not end itself in time, or at the next signal.
fn end_in_time() {
    /// The time for a run that checks for signals.
    const GRACE: Duration = Duration::from_millis(800);
    let is_new = || UNSEEN.swap(0, Ordering::Relaxed) != 0 && RUNS.load(Ordering::Relaxed);
    while !is_new() {
        std::thread::sleep(INTERVAL);
    }
    let came = Instant::now();
    while LOOKS.load(Ordering::Relaxed) && came.elapsed() < GRACE && !is_new() {
        std::thread::sleep(INTERVAL);
    }
    let mut said = target::abandon_all(WHY).unwrap_or_default();
    if said.is_empty() {
        said.push(NOTHING_YET.to_owned());
    }
    say(said);
    leave();
}

/// Ends the program at once: the buffer of standard output might wait for its reader forever.
fn leave() -> ! {
    low_level::exit(last().map_or(1, |status| status.code().into()))
}

/// Writes a message that nobody may read.
fn say(said: Vec<String>) {
    const SAYING: Duration = Duration::from_millis(100);
    let (saying, is_said) = channel();
    std::thread::spawn(move || {
        let mut stderr = io::stderr().lock();
        if stderr.is_terminal() && !is_dumb() {
            // a progress bar may stand there
            let _ = stderr.write_all(b"\r\x1b[K");
        }
        for line in said {
            let _ = writeln!(stderr, "{line}");
        }
        saying.send(())
    });
    let _ = is_said.recv_timeout(SAYING);
}

/// The outcome of a command that a signal has stopped; `None` without one.
fn last() -> Option<Status> {
    let came = LAST.load(Ordering::Relaxed);
    let code = SIGNALS.iter().find(|(signal, _)| usize::try_from(*signal) == Ok(came)).map(|(_, code)| *code);
    code.map(Status::Interrupted)
}

/// The signals of a run that does not check for them: it is ended wherever it is.
pub(super) fn signals(output: &Output) -> Interruption {
    let stop = output.stop();
    Interruption { is_own: stop.is_none(), stop: stop.cloned().unwrap_or_default() }
}

/// The signals of a run that checks for them from here on, and ends itself. A program that holds the answer has its own signals, and
/// says when to stop.
pub(super) fn interrupted(output: &Output) -> Interruption {
    let outer = signals(output);
    if !outer.is_own {
        return outer;
    }
    LOOKS.store(true, Ordering::Relaxed);
    Interruption { stop: Arc::clone(&STOP), ..outer }
}

impl Interruption {
    /// The flag that a run checks from time to time; set by the first signal.
    pub(super) fn stop(&self) -> &Arc<AtomicBool> {
        &self.stop
    }

    /// Whether a signal has come.
    pub(super) fn came(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The outcome of a command that a signal has stopped; `None` without one.
    pub(super) fn status(&self) -> Option<Status> {
        if self.is_own { last() } else { None }
    }

    /// Runs a function that only waits for input and reads it: if a signal comes before it is finished, the program does `first` and
    /// ends.
    pub(super) fn while_waiting<T>(&self, look: impl FnOnce() -> T, first: impl FnOnce() + Send) -> T {
        let (looking, looked) = channel::<()>();
        std::thread::scope(|scope| {
            scope.spawn(move || {
                loop {
                    let is_through = looked.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Disconnected);
                    if self.status().is_some() {
                        first();
                        target::abandon_all(WHY);
                        leave();
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
}
