//! Work on all cores of the machine. Called by the mesh for many strokes, and for batches and repeated simulations. Results
//! come in the order of the work.

use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

thread_local! {
    /// Whether this thread works beside others.
    static IS_BESIDE_OTHERS: Cell<bool> = const { Cell::new(false) };
}

/// The cores of this machine that the process may use; one for work within work that has several threads.
pub(crate) fn cores() -> usize {
    static CORES: OnceLock<usize> = OnceLock::new();
    if IS_BESIDE_OTHERS.get() {
        return 1;
    }
    *CORES.get_or_init(|| std::thread::available_parallelism().map_or(1, usize::from))
}

/// A lock that outlives a panic of another thread, which itself ends the program where a panic aborts.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Calls `make` for each number below `count`, on at most `threads` threads. `start` makes the state that a thread keeps
/// from one number to the next. Returns the results in order, and the states of the threads in no order.
pub(crate) fn map<T: Send, W: Send>(
    threads: usize,
    count: usize,
    start: impl Fn() -> W + Sync,
    make: impl Fn(&mut W, usize) -> T + Sync,
) -> (Vec<T>, Vec<W>) {
    let next = AtomicUsize::new(0);
    let parts = on_threads(threads.min(count), || {
        let (mut kept, mut made) = (start(), Vec::new());
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return (made, kept);
            }
            made.push((index, make(&mut kept, index)));
        }
    });
    let (mut all, mut kept) = (Vec::with_capacity(count), Vec::with_capacity(parts.len()));
    for (made, of_thread) in parts {
        all.extend(made);
        kept.push(of_thread);
    }
    all.sort_unstable_by_key(|(index, _)| *index);
    (all.into_iter().map(|(_, made)| made).collect(), kept)
}

/// Does jobs on at most `threads` threads; a thread that is done takes the next job.
fn deal<J: Send>(threads: usize, jobs: impl Iterator<Item = J> + Send, work: impl Fn(J) + Sync) {
    if threads <= 1 {
        return jobs.for_each(work);
    }
    let jobs = Mutex::new(jobs);
    // a thread takes a job with the lock held and does it without; a panic on another thread is passed on below
    let next = || jobs.lock().ok().and_then(|mut jobs| jobs.next());
    on_threads(threads, || {
        while let Some(job) = next() {
            work(job);
        }
    });
}

/// Results that [`in_order`] holds at once for each thread: enough that a slow thread hardly delays the others, few enough
/// that an early end comes soon.
pub(crate) const HELD: usize = 4;

/// Calls `make` for each number below `count` on at most `threads` threads, and `take` for each result in the order of the
/// numbers. Memory does not grow with `count`.
///
/// # Errors
/// The first error of `take`; no further number is started after it.
pub(crate) fn in_order<T: Send, E>(
    threads: usize,
    count: u64,
    make: impl Fn(u64) -> T + Sync,
    mut take: impl FnMut(T) -> Result<(), E>,
) -> Result<(), E> {
    let threads = threads.clamp(1, usize::try_from(count).unwrap_or(usize::MAX).max(1));
    let held = threads * HELD;
    let mut made: Vec<Option<T>> = Vec::with_capacity(held);
    let mut first = 0;
    while first < count {
        made.clear();
        made.resize_with(held.min(usize::try_from(count - first).unwrap_or(held)), || None);
        deal(threads, (first..count).zip(&mut made), |(number, made)| *made = Some(make(number)));
        for made in made.drain(..).flatten() {
            take(made)?;
        }
        first += held as u64;
    }
    Ok(())
}

/// Runs `worker` on `threads` threads at once, the caller's among them. A panic on any of them becomes the caller's.
fn on_threads<T: Send>(threads: usize, worker: impl Fn() -> T + Sync) -> Vec<T> {
    let worker = || {
        let before = IS_BESIDE_OTHERS.replace(threads > 1 || IS_BESIDE_OTHERS.get());
        let made = worker();
        IS_BESIDE_OTHERS.set(before);
        made
    };
    std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(worker)).collect();
        let mut parts = vec![worker()];
        for other in others {
            parts.push(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        parts
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_order_on_any_number_of_threads_and_each_is_made_once() {
        for threads in [0, 1, 2, 5, 40] {
            for count in [0, 1, 7, 300] {
                let (made, kept) = map(
                    threads,
                    count,
                    || 0,
                    |seen, index| {
                        *seen += 1;
                        index * index
                    },
                );
                assert_eq!(made, (0..count).map(|index| index * index).collect::<Vec<_>>());
                assert_eq!(kept.iter().sum::<usize>(), count);
                assert!(kept.len() <= threads.max(1));
            }
        }
    }

    #[test]
    fn work_within_work_has_one_thread() {
        let all = cores();
        for threads in [1, 2] {
            let seen = map(threads, 8, || (), |(), _| cores()).0;
            assert_eq!(seen, [if threads == 1 { all } else { 1 }; 8]);
            let mut taken = Vec::new();
            let ended: Result<(), ()> = in_order(
                threads,
                8,
                |_| cores(),
                |cores| {
                    taken.push(cores);
                    Ok(())
                },
            );
            assert_eq!((ended, taken), (Ok(()), seen));
        }
        assert_eq!(cores(), all);
    }

    #[test]
    fn every_job_is_dealt_once() {
        for threads in [0, 1, 3] {
            let sum = AtomicUsize::new(0);
            deal(threads, 1..=100_usize, |job| {
                sum.fetch_add(job, Ordering::Relaxed);
            });
            assert_eq!(sum.into_inner(), 5050);
        }
    }

    #[test]
    fn what_is_made_is_taken_in_order_up_to_the_first_error() {
        for threads in [0, 1, 3] {
            for count in [0, 1, 7, 300] {
                let mut taken = Vec::new();
                let take = |number| {
                    if number == 120 {
                        Err("enough")
                    } else {
                        {
                            taken.push(number);
                            Ok(())
                        }
                    }
                };
                let ended = in_order(threads, count, |number| number, take);
                assert_eq!(ended.is_err(), count > 120);
                assert_eq!(taken, (0..count.min(120)).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    #[should_panic(expected = "on purpose")]
    fn a_panic_on_a_thread_is_passed_on() {
        map(3, 10, || (), |(), index| assert!(index != 4, "on purpose"));
    }
}
