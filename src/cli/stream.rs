//! Tables as bytes: files, standard input that Ctrl-C can end, and standard output without a line buffer.

use std::fs::File;
use std::io::{self, Cursor, Read, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

use bytes::Bytes;

use super::output::{Failure, STDOUT};
use super::target::{is_dash, named, shown};
use crate::diagnostic::Diagnostic;

/// A file, or standard input for `-`.
pub(super) fn open(path: &Path, stop: &Arc<AtomicBool>) -> Result<Box<dyn Read + Send>, Failure> {
    Ok(if is_dash(path) { Box::new(Stdin::new(Arc::clone(stop))) } else { Box::new(file(path)?) })
}

/// A file that is not a folder.
pub(super) fn file(path: &Path) -> Result<File, Failure> {
    let file = File::open(path).map_err(|error| Diagnostic::unreadable(&shown(path), &error))?;
    if file.metadata().is_ok_and(|metadata| metadata.is_dir()) {
        return Err(Diagnostic::unreadable(&shown(path), &"it is a folder").into());
    }
    Ok(file)
}

/// The content of standard input, which is used more than once.
pub(super) fn whole(stop: &Arc<AtomicBool>) -> Result<Bytes, Failure> {
    const LARGEST: u64 = 48 << 20;
    let mut bytes = Vec::new();
    let read = Stdin::new(Arc::clone(stop)).take(LARGEST + 1).read_to_end(&mut bytes);
    read.map_err(|error| Diagnostic::unreadable("<stdin>", &error))?;
    if bytes.len() as u64 > LARGEST {
        let problem = Diagnostic::unreadable("<stdin>", &format!("it is larger than {} MiB", LARGEST >> 20));
        return Err(problem.help("give it as a file").into());
    }
    Ok(bytes.into())
}

/// Its name in messages.
pub(super) fn name(path: &Path) -> String {
    if is_dash(path) { "<stdin>".to_owned() } else { shown(path) }
}

/// Standard input, read by its own thread: a slow pipe does not keep the program from ending.
pub(super) struct Stdin {
    blocks: Receiver<io::Result<Vec<u8>>>,
    block: Cursor<Vec<u8>>,
    stop: Arc<AtomicBool>,
}

const BLOCK: usize = 1 << 16;
const BLOCKS: usize = 4;

impl Stdin {
    pub(super) fn new(stop: Arc<AtomicBool>) -> Self {
        let (filled, blocks) = sync_channel(BLOCKS);
        std::thread::spawn(move || {
            let mut stdin = io::stdin().lock();
            loop {
                let mut block = vec![0; BLOCK];
                let read = match stdin.read(&mut block) {
                    Ok(0) => return,
                    Ok(count) => {
                        block.truncate(count);
                        Ok(block)
                    }
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                    Err(error) => Err(error),
                };
                let failed = read.is_err();
                if filled.send(read).is_err() || failed {
                    return;
                }
            }
        });
        Self { blocks, block: Cursor::default(), stop }
    }

    /// Whether bytes arrive within this time.
    pub(super) fn comes_within(&mut self, time: Duration) -> bool {
        let Ok(Ok(block)) = self.blocks.recv_timeout(time) else { return false };
        self.block = Cursor::new(block);
        true
    }
}

impl Read for Stdin {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        const INTERVAL: Duration = Duration::from_millis(50);
        loop {
            let count = self.block.read(out)?;
            if count > 0 || self.stop.load(Ordering::Relaxed) {
                return Ok(count);
            }
            match self.blocks.recv_timeout(INTERVAL) {
                Ok(block) => self.block = Cursor::new(block?),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(0),
            }
        }
    }
}

/// Standard output, written in large pieces. A closed pipe does not end a run: the verdict and the other files do not depend on
/// it.
pub(super) struct Stdout;

impl Write for Stdout {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        unless_closed(io::stdout().lock().write(bytes), bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        unless_closed(io::stdout().lock().flush(), ())
    }
}

/// The result of writing, or `done` if the pipe is closed.
fn unless_closed<T>(written: io::Result<T>, done: T) -> io::Result<T> {
    match written {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(done),
        written => written.map_err(|error| named(STDOUT, &error)),
    }
}
