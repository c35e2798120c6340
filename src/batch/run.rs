//! One table through all cores: chunks to workers, results in the table's order.
//!
//! Each worker takes the next chunk, evaluates it, waits until the chunks before it are written, and writes.
//! So memory does not depend on the table's length, and what comes out does not depend on the number of
//! workers.

use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

use super::chunk::{Chunker, Holds};
use super::evaluate::{Chunk, Evaluator};
use super::input::{Encoding, Header, Input};
use super::layout::Layout;
use super::outcome::{Kept, Outcome, Total};
use super::pack::Packing;
use super::plan::Plan;
use super::split::next_record;
use super::statistics::{Moving, Statistics};
use super::write;

/// Where results go.
#[derive(Default)]
pub struct Sinks<'a> {
    /// The rows.
    pub rows: Option<Sink<'a>>,
    /// The rejected rows.
    pub rejects: Option<Sink<'a>>,
}

/// A writer, and how what goes there is packed.
pub struct Sink<'a> {
    /// Where the bytes go.
    pub writer: &'a mut (dyn Write + Send),
    /// How they are packed.
    pub packing: Packing,
}

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

/// Runs tables through a plan, one after the other, and keeps what they come to.
pub struct Batch<'a> {
    plan: &'a Plan,
    sinks: Sinks<'a>,
    outcome: Outcome,
    worst: Vec<Kept>,
    moving: Vec<Moving>,
    workers: usize,
    /// The header that the rejected rows written so far have.
    rejects_header: Option<Vec<u8>>,
    wrote_header: bool,
}

impl<'a> Batch<'a> {
    /// Starts a batch on as many workers as there are cores, or as `workers` says.
    #[must_use]
    pub fn new(plan: &'a Plan, sinks: Sinks<'a>, workers: Option<usize>) -> Self {
        // with more workers memory would not stay below 16 MiB
        const MOST_WORKERS: usize = 24;
        let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let mut outcome = Outcome::default();
        if plan.request.statistics {
            outcome.quantities = plan.quantity_names();
            outcome.statistics = vec![Statistics::default(); outcome.quantities.len()];
        }
        Self {
            plan,
            sinks,
            outcome,
            worst: Vec::new(),
            moving: vec![Moving::default(); plan.followed.len()],
            workers: workers.unwrap_or_else(cores).clamp(1, MOST_WORKERS),
            rejects_header: None,
            wrote_header: false,
        }
    }

    /// Runs one table. `stop` ends the run after the chunks that were begun; `progress` is called some times
    /// a second.
    ///
    /// # Errors
    /// If the table cannot be read to its end, or the results cannot be written; what was computed before is
    /// kept.
    pub fn run(
        &mut self,
        input: Input,
        layout: &Layout,
        stop: &AtomicBool,
        progress: &mut dyn FnMut(&Progress),
    ) -> Result<(), RunError> {
        let Input { header, mut chunks, lines, place } = input;
        self.start(&header).map_err(RunError::Write)?;
        chunks.set_separator(layout.separator);
        let plan = self.plan;
        let before = (self.outcome.counts, self.outcome.bytes);
        let keeps_rejects = self.sinks.rejects.is_some();
        let problems_kept = plan.request.problems_kept;
        let total = Total {
            outcome: &mut self.outcome,
            worst: std::mem::take(&mut self.worst),
            moving: &mut self.moving,
            lines,
            records: 0,
            place,
            problems_kept,
            failures_kept: plan.request.failures_kept,
        };
        let shared = Shared {
            plan,
            layout,
            encoding: header.encoding,
            packing: (
                self.sinks.rows.as_ref().map_or(Packing::None, |sink| sink.packing),
                self.sinks.rejects.as_ref().map_or(Packing::None, |sink| sink.packing),
            ),
            queue: Mutex::new(Queue { chunks, next: 0, records: 0, ended: false, error: None }),
            order: Mutex::new(Order { next: 0, total, sinks: &mut self.sinks, error: None, workers: 0 }),
            turn: Condvar::new(),
            done: Condvar::new(),
            stop,
            ended: AtomicBool::new(false),
            bytes: AtomicU64::new(0),
        };
        let statistics = Mutex::new(Vec::new());
        let work = || {
            let mut evaluator = Evaluator::new(plan, layout, &header.name, keeps_rejects);
            shared.work(&mut evaluator);
            lock(&statistics).push(std::mem::take(&mut evaluator.statistics));
            lock(&shared.order).workers -= 1;
            shared.turn.notify_all();
            shared.done.notify_all();
        };
        lock(&shared.order).workers = self.workers;
        std::thread::scope(|scope| {
            for _ in 0..self.workers {
                scope.spawn(work);
            }
            shared.watch(progress);
        });
        let Shared { queue, order, .. } = shared;
        let queue = queue.into_inner().unwrap_or_else(PoisonError::into_inner);
        let order = order.into_inner().unwrap_or_else(PoisonError::into_inner);
        let (error, worst) = (order.error, order.total.worst);
        self.worst = worst;
        self.outcome.bytes = before.1 + queue.chunks.bytes_read();
        for worker in statistics.into_inner().unwrap_or_else(PoisonError::into_inner) {
            for (statistics, more) in self.outcome.statistics.iter_mut().zip(&worker) {
                statistics.merge(more);
            }
        }
        self.outcome.interrupted |= stop.load(Ordering::Relaxed);
        if let Some(error) = error {
            return Err(RunError::Write(error));
        }
        queue.error.map_or(Ok(()), |error| Err(RunError::Read(error)))
    }

    /// Writes what stands before the first row, or before the first rejected row of another header.
    fn start(&mut self, header: &Header) -> io::Result<()> {
        if let Some(rows) = self.sinks.rows.as_mut().filter(|_| !self.wrote_header) {
            let names = write::header(&self.plan.column_names(), self.plan.format);
            rows.writer.write_all(&rows.packing.pack(names)?)?;
            self.wrote_header = true;
        }
        if let Some(rejects) = &mut self.sinks.rejects
            && self.rejects_header.as_ref() != Some(&header.raw)
        {
            let mut start = Vec::new();
            if self.rejects_header.is_none() {
                start.extend_from_slice(header.encoding.mark());
            }
            start.extend_from_slice(&header.encoding.original(&header.raw));
            rejects.writer.write_all(&rejects.packing.pack(start)?)?;
            self.rejects_header = Some(header.raw.clone());
        }
        Ok(())
    }

    /// Whether the run has come to its end before that of the input: in strict mode at the first rejected
    /// row.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.outcome.interrupted || (self.plan.request.strict && self.outcome.counts.rejected > 0)
    }

    /// Ends the batch: what it came to.
    ///
    /// # Errors
    /// If the results cannot be written.
    pub fn finish(mut self) -> (Outcome, io::Result<()>) {
        for (moving, (index, _)) in self.moving.iter().zip(&self.plan.followed) {
            if let Some(statistics) = self.outcome.statistics.get_mut(*index) {
                statistics.add_moving(moving);
            }
        }
        self.outcome.worst = self.worst.into_iter().map(|kept| kept.part).collect();
        let mut flushed = Ok(());
        for sink in [self.sinks.rows, self.sinks.rejects].into_iter().flatten() {
            flushed = flushed.and(sink.writer.flush());
        }
        (self.outcome, flushed)
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
}

/// What workers take chunks from.
struct Queue {
    chunks: Chunker,
    /// The number of the next chunk.
    next: u64,
    /// Records in the chunks taken; only counted where parts have no name.
    records: u64,
    ended: bool,
    error: Option<io::Error>,
}

/// What workers write to, one after the other.
struct Order<'a, 'b> {
    /// The number of the chunk whose turn it is.
    next: u64,
    total: Total<'a>,
    sinks: &'a mut Sinks<'b>,
    error: Option<io::Error>,
    workers: usize,
}

struct Shared<'a, 'b> {
    plan: &'a Plan,
    layout: &'a Layout,
    encoding: Encoding,
    packing: (Packing, Packing),
    queue: Mutex<Queue>,
    order: Mutex<Order<'a, 'b>>,
    turn: Condvar,
    /// Told when a worker is done; not at every turn, which would be all that a watcher hears of.
    done: Condvar,
    /// Ends the run from outside.
    stop: &'a AtomicBool,
    /// Ends the run from inside: nothing can be written any more, or nothing should.
    ended: AtomicBool,
    bytes: AtomicU64,
}

/// A lock that outlives a panic of another worker: the panic itself ends the run.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared<'_, '_> {
    /// Takes chunks until there are no more.
    fn work(&self, evaluator: &mut Evaluator<'_>) {
        let mut chunk = Chunk::default();
        while let Some((number, holds)) = self.take(&mut chunk) {
            evaluator.chunk(&chunk, holds);
            let rows = self.packing.0.pack_slice(evaluator.out.written());
            let rejects = self.encoding.original(&evaluator.rejects);
            let rejects = self.packing.1.pack_slice(&rejects);
            let mut order = lock(&self.order);
            while order.next != number {
                order = self.turn.wait(order).unwrap_or_else(PoisonError::into_inner);
            }
            order.next += 1;
            if !self.ended.load(Ordering::Relaxed) {
                let order = &mut *order;
                order.total.add(&mut evaluator.tally);
                let written = write_to(order.sinks.rows.as_mut(), rows)
                    .and_then(|()| write_to(order.sinks.rejects.as_mut(), rejects));
                if let Err(error) = written {
                    order.error = Some(error);
                    self.ended.store(true, Ordering::Relaxed);
                }
                if self.plan.request.strict && order.total.outcome.counts.rejected > 0 {
                    self.ended.store(true, Ordering::Relaxed);
                }
            }
            drop(order);
            self.turn.notify_all();
        }
    }

    /// The next chunk, with its number.
    fn take(&self, chunk: &mut Chunk) -> Option<(u64, Holds)> {
        let mut queue = lock(&self.queue);
        if queue.ended || self.stop.load(Ordering::Relaxed) || self.ended.load(Ordering::Relaxed) {
            return None;
        }
        let holds = match queue.chunks.next(&mut chunk.bytes) {
            // a reader that was told to stop says that it has ended: then its last row may not be whole
            Ok(Some(holds)) if !self.stop.load(Ordering::Relaxed) => holds,
            Ok(_) => {
                queue.ended = true;
                return None;
            }
            Err(error) => {
                queue.ended = true;
                queue.error = Some(error);
                return None;
            }
        };
        self.bytes.store(queue.chunks.bytes_read(), Ordering::Relaxed);
        chunk.first_record = queue.records + 1;
        if self.layout.id.is_none() {
            queue.records += self.records(&chunk.bytes, holds);
        }
        let number = queue.next;
        queue.next += 1;
        Some((number, holds))
    }

    /// How many records there are in a chunk.
    fn records(&self, bytes: &[u8], holds: Holds) -> u64 {
        if let Holds::Piece { first, .. } = holds {
            return u64::from(first);
        }
        let (mut fields, mut at, mut lines, mut count) = (Vec::new(), 0, 0, 0);
        while let Some(record) = next_record(bytes, at, self.layout.separator, &mut fields, &mut lines) {
            at = record.next;
            count += 1;
        }
        count
    }

    /// Tells how far the run is until the workers are done.
    fn watch(&self, progress: &mut dyn FnMut(&Progress)) {
        const INTERVAL: Duration = Duration::from_millis(100);
        let mut order = lock(&self.order);
        while order.workers > 0 {
            let (next, waited) = self.done.wait_timeout(order, INTERVAL).unwrap_or_else(PoisonError::into_inner);
            order = next;
            if waited.timed_out() {
                let counts = order.total.outcome.counts;
                let now = Progress {
                    rows: counts.rows,
                    failures: counts.fail,
                    rejected: counts.rejected,
                    bytes: self.bytes.load(Ordering::Relaxed),
                };
                drop(order);
                progress(&now);
                order = lock(&self.order);
            }
        }
    }
}

fn write_to(sink: Option<&mut Sink<'_>>, bytes: io::Result<std::borrow::Cow<'_, [u8]>>) -> io::Result<()> {
    match (sink, bytes?) {
        (Some(sink), bytes) if !bytes.is_empty() => sink.writer.write_all(&bytes),
        _ => Ok(()),
    }
}
