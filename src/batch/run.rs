//! One table through all cores: pieces to workers, results in the table's order.
//!
//! Each worker takes the next piece, reads and evaluates it, waits until the pieces before it are written, and writes.
//! So memory does not depend on the table's length, and what comes out does not depend on the number of
//! workers.

use std::io;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

use super::evaluate::Evaluator;
use super::layout::Layout;
use super::ledger::{Ledger, RowSink, Sink, Sinks};
use super::outcome::{Counts, Outcome, Total};
use super::pack::Packing;
use super::plan::Plan;
use super::write;
use crate::parallel::lock;
use crate::table::{Contradiction, Doubtful, Encoding, OddRows, Piece, Queue, Rows, Table};

/// How far a run is.
#[derive(Debug, Clone, Copy, Default)]
pub struct Progress {
    /// Rows done.
    pub rows: u64,
    /// Parts that failed.
    pub failures: u64,
    /// Rows rejected.
    pub rejected: u64,
    /// Bytes read, after unpacking.
    pub bytes: u64,
}

/// Runs tables through a plan, one after the other, and keeps their outcome.
pub struct Batch<'a> {
    plan: &'a Plan,
    ledger: Ledger<'a>,
    workers: usize,
}

impl<'a> Batch<'a> {
    /// Starts a batch on as many workers as there are cores, or as `workers` says.
    #[must_use]
    pub fn new(plan: &'a Plan, sinks: Sinks<'a>, workers: Option<usize>) -> Self {
        // with more workers memory would not stay below 16 MiB
        const MOST_WORKERS: usize = 24;
        let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        Self {
            plan,
            ledger: Ledger::new(sinks, if plan.request.statistics { plan.quantities_kept() } else { Vec::new() }),
            workers: workers.unwrap_or_else(cores).clamp(1, MOST_WORKERS),
        }
    }

    /// Runs one table. `stop` ends the run after the rows that were begun; `progress` is called some times
    /// a second.
    ///
    /// # Errors
    /// If the table cannot be read to its end, or the results cannot be written; what was computed before is
    /// kept.
    pub fn run(
        &mut self,
        table: Table,
        layout: &Layout,
        stop: &AtomicBool,
        progress: &mut dyn FnMut(&Progress),
    ) -> Result<(), RunError> {
        let Table { name, mut reading, encoding, place, pieces, header_raw, has_id, refuses_repeats, .. } = table;
        let plan = self.plan;
        let names = || write::header(&plan.column_names(), plan.request.format);
        self.ledger.start(names, encoding, &header_raw).map_err(RunError::Write)?;
        let Ledger { sinks, outcome, .. } = &mut self.ledger;
        let bytes_before = outcome.bytes;
        let keeps_rejects = sinks.rejects.is_some();
        let (rows, queue) = pieces.open(layout.wanted(keeps_rejects));
        let total = Total {
            outcome,
            followed: &plan.followed,
            records: 0,
            place,
            asides: Vec::new(),
            doubtful: Doubtful::default(),
            odd: OddRows::default(),
            left_out: std::mem::take(&mut reading.left_out),
            doubted: Default::default(),
            request: &plan.request,
        };
        let shared = SharedRun {
            plan,
            rows: &rows,
            encoding,
            rows_packing: match &sinks.rows {
                Some(RowSink::Text(sink)) => sink.packing,
                Some(RowSink::Columns(_)) | None => Packing::None,
            },
            rejects_packing: sinks.rejects.as_ref().map_or(Packing::None, |sink| sink.packing),
            queue: Mutex::new(PieceQueue { queue, next: 0, ended: false, error: None }),
            order: Mutex::new(WriteOrder { next: 0, total, sinks, failure: None }),
            turn: Condvar::new(),
            stop,
            ended: AtomicBool::new(false),
            keeps_names: AtomicBool::new(has_id),
            bytes: AtomicU64::new(0),
        };
        let statistics = Mutex::new(Vec::new());
        let work = || {
            let mut evaluator = Evaluator::new(plan, layout, &name, keeps_rejects, stop);
            shared.work(&mut evaluator);
            lock(&statistics).push(std::mem::take(&mut evaluator.statistics));
        };
        let (working, done) = channel::<()>();
        std::thread::scope(|scope| {
            for working in vec![working; self.workers] {
                scope.spawn(move || {
                    work();
                    drop(working);
                });
            }
            shared.watch(&done, progress);
        });
        let SharedRun { queue, order, ended, .. } = shared;
        let waiting = queue.into_inner().unwrap_or_else(PoisonError::into_inner);
        let order = order.into_inner().unwrap_or_else(PoisonError::into_inner);
        let Total { asides, doubted, doubtful, odd, left_out, .. } = order.total;
        reading.left_out = left_out;
        // later rows may allow it
        let is_whole = !ended.into_inner() && !stop.load(Ordering::Relaxed);
        let last = doubtful.contradiction(&rows).filter(|_| is_whole);
        let failure = order.failure.or(waiting.error.map(RunError::Read)).or(last.map(RunError::Contradiction));
        let twice = self.ledger.outcome.duplicates.refusal().filter(|_| refuses_repeats && is_whole);
        let failure = failure.or(twice.map(RunError::Contradiction));
        let outcome = &mut self.ledger.outcome;
        outcome.bytes = bytes_before + waiting.queue.bytes_read();
        for worker in statistics.into_inner().unwrap_or_else(PoisonError::into_inner) {
            for (quantity, more) in outcome.quantities.iter_mut().zip(&worker) {
                quantity.statistics.merge(more);
            }
        }
        outcome.interrupted |= stop.load(Ordering::Relaxed);
        reading.asides.extend(asides);
        reading.notes.extend(layout.doubts(plan, &name, &doubted));
        reading.notes.extend(odd.remedy().map(|remedy| format!("{name}: {remedy}")));
        outcome.readings.push(reading);
        outcome.is_cut |= matches!(failure, Some(RunError::Read(_) | RunError::Contradiction(_)));
        if let Some(RunError::Contradiction(contradiction)) = &failure {
            outcome.contradiction.get_or_insert_with(|| contradiction.message.clone());
        }
        failure.map_or(Ok(()), Err)
    }

    /// Whether the run ended before the end of the input: in strict mode at the first rejected row.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.ledger.is_over(self.plan.request.strict)
    }

    /// Ends the batch and returns its outcome.
    ///
    /// # Errors
    /// If the results cannot be written.
    pub fn finish(self) -> (Outcome, io::Result<()>) {
        self.ledger.finish(self.plan.request.strict)
    }
}

/// Why a table was not run to its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// It cannot be read.
    #[error("the table cannot be read")]
    Read(#[source] io::Error),
    /// The results cannot be written.
    #[error("the results cannot be written")]
    Write(#[source] io::Error),
    /// A cell contradicts how the table is read.
    #[error("line {}, column `{}`: {}", .0.line, .0.column, .0.message)]
    Contradiction(Contradiction),
}

/// The input that workers take pieces from.
struct PieceQueue {
    queue: Queue,
    /// The number of the next piece.
    next: u64,
    ended: bool,
    error: Option<io::Error>,
}

/// The output that workers write to, one after the other.
struct WriteOrder<'a, 'b> {
    /// The number of the piece whose turn it is.
    next: u64,
    total: Total<'a>,
    sinks: &'a mut Sinks<'b>,
    /// Why the rest of the table does not count.
    failure: Option<RunError>,
}

struct SharedRun<'a, 'b> {
    plan: &'a Plan,
    rows: &'a Rows,
    encoding: Encoding,
    rows_packing: Packing,
    rejects_packing: Packing,
    queue: Mutex<PieceQueue>,
    order: Mutex<WriteOrder<'a, 'b>>,
    turn: Condvar,
    /// Ends the run from outside.
    stop: &'a AtomicBool,
    /// Ends the run from inside: nothing more can, or should, be written.
    ended: AtomicBool,
    /// Whether the names of parts are still checked.
    keeps_names: AtomicBool,
    /// Up to the end of the pieces that are done.
    bytes: AtomicU64,
}

impl SharedRun<'_, '_> {
    /// Takes pieces until there are no more.
    fn work(&self, evaluator: &mut Evaluator<'_>) {
        let mut piece = Piece::default();
        while let Some((number, bytes)) = self.take(&mut piece) {
            piece.read(self.rows);
            evaluator.block(&piece.block, piece.records_before, self.keeps_names.load(Ordering::Relaxed));
            evaluator.doubt(&piece.block);
            let rows = self.rows_packing.pack(&evaluator.written.out);
            let rejects = self.encoding.original(&evaluator.rejects);
            let rejects = self.rejects_packing.pack(&rejects);
            let mut order = lock(&self.order);
            while order.next != number {
                order = self.turn.wait(order).unwrap_or_else(PoisonError::into_inner);
            }
            order.next += 1;
            self.bytes.store(bytes, Ordering::Relaxed);
            let is_counted = !self.ended.load(Ordering::Relaxed);
            if is_counted {
                let order = &mut *order;
                let list = order.sinks.parts.as_deref_mut();
                let listed = order.total.add(self.rows, &mut piece.block, &mut evaluator.tally, list);
                let written = match order.sinks.rows.as_mut() {
                    Some(RowSink::Text(sink)) => write_to(Some(sink), rows),
                    Some(RowSink::Columns(sink)) => sink.take(std::mem::take(&mut evaluator.written.columns)),
                    None => Ok(()),
                };
                let written = listed.and(written).and_then(|()| write_to(order.sinks.rejects.as_mut(), rejects));
                let is_cut = evaluator.is_cut(piece.block.rows()) && self.stop.load(Ordering::Relaxed);
                self.settle(order, piece.block.contradiction.take().filter(|_| !is_cut), written);
                self.ended.fetch_or(is_cut, Ordering::Relaxed);
            }
            drop(order);
            self.turn.notify_all();
            if is_counted {
                evaluator.count_block();
            }
        }
    }

    /// What a piece means for those after it.
    fn settle(&self, order: &mut WriteOrder<'_, '_>, found: Option<Contradiction>, written: io::Result<()>) {
        let failure = written.err().map(RunError::Write).or(found.map(RunError::Contradiction));
        let outcome = &order.total.outcome;
        let is_over = failure.is_some() || (self.plan.request.strict && outcome.counts.rejected > 0);
        self.ended.fetch_or(is_over, Ordering::Relaxed);
        self.keeps_names.fetch_and(outcome.duplicates.is_open(), Ordering::Relaxed);
        order.failure = failure;
    }

    /// The next piece: its number, and how many bytes were read up to its end.
    fn take(&self, piece: &mut Piece) -> Option<(u64, u64)> {
        let mut waiting = lock(&self.queue);
        if waiting.ended || self.stop.load(Ordering::Relaxed) || self.ended.load(Ordering::Relaxed) {
            return None;
        }
        let next = waiting.queue.next(self.rows, piece);
        // a reader that is stopped reports its end: its last row may then be incomplete
        waiting.ended = !matches!(next, Ok(true)) || self.stop.load(Ordering::Relaxed);
        if waiting.ended {
            waiting.error = next.err();
            return None;
        }
        let number = waiting.next;
        waiting.next += 1;
        Some((number, waiting.queue.bytes_read()))
    }

    /// Tells how far the run is until the workers, who have the other end of `done`, are through.
    fn watch(&self, done: &Receiver<()>, progress: &mut dyn FnMut(&Progress)) {
        const INTERVAL: Duration = Duration::from_millis(100);
        while done.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
            let Counts { rows, fail: failures, rejected, .. } = lock(&self.order).total.outcome.counts;
            progress(&Progress { rows, failures, rejected, bytes: self.bytes.load(Ordering::Relaxed) });
        }
    }
}

fn write_to(sink: Option<&mut Sink<'_>>, bytes: io::Result<std::borrow::Cow<'_, [u8]>>) -> io::Result<()> {
    match (sink, bytes?) {
        (Some(sink), bytes) if !bytes.is_empty() => sink.writer.write_all(&bytes),
        _ => Ok(()),
    }
}
