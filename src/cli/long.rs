//! What long runs share: a progress bar where somebody watches, and Ctrl-C that keeps what is there.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::{ProgressBar, ProgressStyle};

/// A bar on standard error, `total` units long; nothing at all unless that is a terminal. `template` is in
/// indicatif's words: `{pos}`, `{len}`, `{per_sec}`, `{msg}`, `{eta}`.
pub(super) fn progress(total: u64, template: &str) -> ProgressBar {
    let bar = ProgressBar::new(total);
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// A flag that the first Ctrl-C sets; the second ends the program as it would without us.
pub(super) fn interrupted() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&flag);
    // without a handler Ctrl-C ends the program at once, which is no reason not to run
    let _ = ctrlc::set_handler(move || {
        if seen.swap(true, Ordering::Relaxed) {
            // the status that shells give to a program ended by this signal
            std::process::exit(130);
        }
    });
    flag
}
