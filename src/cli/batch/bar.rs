//! How far a batch is, where somebody watches.

use std::path::PathBuf;

use crate::batch::{Packing, Progress};
use crate::cli::bar;
use crate::cli::output::Output;
use crate::cli::target::shown;
use crate::report::grouped;

/// How far the run is, where somebody watches.
pub(in crate::cli) struct Bar {
    shown: bar::Bar,
    /// The sizes of the files, as far as they have one.
    sizes: Vec<Option<u64>>,
    file: usize,
    done: u64,
    /// What is counted.
    unit: &'static str,
}

impl Bar {
    pub(in crate::cli) fn new(files: &[PathBuf], unit: &'static str, output: &Output) -> Self {
        let sizes = files.iter().map(|path| {
            let (packing, _) = Packing::of_name(&shown(path));
            let metadata = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?;
            (packing == Packing::None).then_some(metadata.len())
        });
        Self { shown: bar::Bar::new(output), sizes: sizes.collect(), file: 0, done: 0, unit }
    }

    pub(in crate::cli) fn show(&mut self, progress: &Progress) {
        let total: Option<u64> = self.sizes.iter().copied().sum();
        let share = total.filter(|total| *total > 0);
        let share = share.map(|total| (self.done + progress.bytes) as f64 / total as f64);
        let (seconds, unit) = (self.shown.seconds(), self.unit);
        self.shown.show(share, || {
            let rate = if seconds > 0.0 { (progress.rows as f64 / seconds) as u64 } else { 0 };
            let mut message = format!("{} {}  {}/s", grouped(progress.rows), unit, grouped(rate));
            if progress.failures > 0 {
                message.push_str(&format!("  {} failed", grouped(progress.failures)));
            }
            if progress.rejected > 0 {
                message.push_str(&format!("  {} rejected", grouped(progress.rejected)));
            }
            message
        });
    }

    pub(in crate::cli) fn next(&mut self) {
        self.done += self.sizes.get(self.file).copied().flatten().unwrap_or(0);
        self.file += 1;
    }

    pub(in crate::cli) fn finish(&self) {
        self.shown.finish();
    }
}
