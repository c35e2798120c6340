//! The files of the process that are begun and not yet complete: an early end takes them from here. A begun file stands beside its
//! final place, as `.NAME.PROCESS-LETTERS.part`, and is locked. A file that can be locked belongs to a killed process: the next
//! file that is begun for the same place removes it.

use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::io::{self, Seek as _, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use tempfile::{Builder, NamedTempFile, PersistError};

use super::names::{is_input, shown};
use crate::parallel::lock;

/// The ending of a begun file's name.
const SUFFIX: &str = ".part";

/// A file that is begun.
struct Begun {
    id: u64,
    /// Its name on the command line.
    path: PathBuf,
    /// Its final place, links resolved.
    place: PathBuf,
    /// Files that are read.
    inputs: Vec<PathBuf>,
    /// Where it stands.
    temporary: NamedTempFile,
    unless_complete: UnlessComplete,
}

/// What happens to a file that is not completed.
#[derive(Debug, Clone, Copy)]
pub(in crate::cli) enum UnlessComplete {
    /// Its content is kept as `NAME.partial`.
    Partial,
    /// A report of the reason replaces an older report, which pipelines would show.
    Report(fn(&str) -> String),
}

static BEGUN: Mutex<Vec<Begun>> = Mutex::new(Vec::new());
/// Messages about dropped files.
static SAID: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// The files that were put in their places, as the command line names them.
static WRITTEN: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Begins the file `path` for the final `place`, where `old` was found; returns its number.
pub(super) fn begin(
    path: &Path,
    place: PathBuf,
    old: Option<Metadata>,
    inputs: Vec<PathBuf>,
    unless_complete: UnlessComplete,
) -> io::Result<(u64, Writer)> {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    if old.is_some() {
        // a read-only file must not be replaced either
        OpenOptions::new().write(true).open(&place)?;
    }
    clear(&place);
    let temporary = beside(&place)?;
    if let Some(old) = old {
        temporary.as_file().set_permissions(old.permissions())?;
    }
    let writer = Writer { path: path.to_owned(), file: temporary.as_file().try_clone()? };
    let id = NEXT.fetch_add(1, Ordering::Relaxed);
    let begun = Begun { id, path: path.to_owned(), place, inputs, temporary, unless_complete };
    lock(&BEGUN).push(begun);
    Ok((id, writer))
}

/// The beginning of the names of all files begun for this place.
fn prefix(place: &Path) -> String {
    /// Characters: the whole name has to fit a folder's longest.
    const LONGEST: usize = 40;
    let name: String = place.file_name().unwrap_or_default().to_string_lossy().chars().take(LONGEST).collect();
    format!(".{name}.")
}

fn folder(place: &Path) -> &Path {
    place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Makes a locked file beside `place`.
fn beside(place: &Path) -> io::Result<NamedTempFile> {
    if place.file_name().is_none() {
        return Err(io::ErrorKind::InvalidFilename.into());
    }
    let prefix = format!("{}{}-", prefix(place), std::process::id());
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    loop {
        let made = builder.tempfile_in(folder(place))?;
        let is_taken = matches!(made.as_file().try_lock(), Err(TryLockError::WouldBlock));
        // until it is locked, another process may take it for the rest of a killed one
        if !is_taken && made.path().exists() {
            return Ok(made);
        }
    }
}

/// Removes the files of killed processes beside `place`: a file that can be locked belongs to no running process.
fn clear(place: &Path) {
    let prefix = prefix(place);
    let is_left = |name: &str| {
        let rest = name.strip_prefix(&prefix).and_then(|rest| rest.strip_suffix(SUFFIX));
        let parts = rest.and_then(|rest| rest.split_once('-'));
        parts.is_some_and(|(process, letters)| {
            process.parse::<u32>().is_ok() && letters.bytes().all(|byte| byte.is_ascii_alphanumeric())
        })
    };
    let Ok(entries) = fs::read_dir(folder(place)) else { return };
    for entry in entries.flatten().filter(|entry| is_left(&entry.file_name().to_string_lossy())) {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        let opened = is_file.then(|| File::open(entry.path()));
        if let Some(Ok(file)) = opened
            && file.try_lock().is_ok()
        {
            // a file that cannot be removed does no harm
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Writes to a begun file in whole pieces, so that a partial file has no half piece.
pub(super) struct Writer {
    path: PathBuf,
    file: File,
}

impl Write for Writer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let _begun = lock(&BEGUN);
        self.file.write_all(bytes).map_err(|error| super::named(&shown(&self.path), &error))?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Takes a file from the begun ones. The lock on them is held until the file is in its place, so that nothing ends the process
/// meanwhile.
fn take(begun: &mut Vec<Begun>, id: u64) -> Option<Begun> {
    let place = begun.iter().position(|begun| begun.id == id)?;
    Some(begun.swap_remove(place))
}

/// Puts a complete file in its place: its bytes are on the disk before its name. `replaces` says whether an old file may be
/// there.
pub(super) fn finish(id: u64, replaces: bool) -> io::Result<()> {
    let file = lock(&BEGUN).iter().find(|begun| begun.id == id).map(|begun| begun.temporary.as_file().try_clone());
    // without the lock, so that a slow disk does not delay an end
    file.transpose()?.map_or(Ok(()), |file| file.sync_all())?;
    let mut all = lock(&BEGUN);
    let Some(begun) = take(&mut all, id) else { return Ok(()) };
    let Begun { temporary, place, .. } = begun;
    let put = if replaces { temporary.persist(&place) } else { temporary.persist_noclobber(&place) };
    if let Err(PersistError { error, file }) = put {
        if replaces {
            all.push(Begun { temporary: file, place, ..begun });
        }
        return Err(error);
    }
    drop(all);
    // some systems cannot open folders, and some disks cannot synchronise them
    #[cfg(unix)]
    let _ = File::open(folder(&place)).and_then(|folder| folder.sync_all());
    Ok(())
}

/// Removes a file that is not complete.
pub(super) fn discard(id: u64) {
    drop(take(&mut lock(&BEGUN), id));
}

/// Ends an incomplete file and keeps the message about it. A report waits for the reason: [`end_reports`].
pub(super) fn drop_file(id: u64) {
    let mut all = lock(&BEGUN);
    let is_partial = |begun: &Begun| matches!(begun.unless_complete, UnlessComplete::Partial);
    if all.iter().any(|begun| begun.id == id && is_partial(begun)) {
        let said = take(&mut all, id).and_then(|begun| begun.abandon(""));
        lock(&SAID).extend(said);
    }
}

/// Ends the reports of a run that has ended and did not complete them; `why` is empty where no message says it.
pub(in crate::cli) fn end_reports(why: &str) {
    let why = if why.is_empty() { "the run failed" } else { why };
    let mut all = lock(&BEGUN);
    let is_report = |begun: &mut Begun| matches!(begun.unless_complete, UnlessComplete::Report(_));
    all.extract_if(.., is_report).for_each(|report| drop(report.abandon(why)));
}

/// A file without a name for what waits to be written to `path`: in the system's folder for such files, or beside `path` where
/// there is none.
pub(in crate::cli) fn temporary(path: &Path) -> io::Result<File> {
    tempfile::tempfile().or_else(|error| {
        tempfile::tempfile_in(folder(path)).map_err(|beside| {
            let (folders, name) = (std::env::temp_dir(), shown(path));
            let message = format!(
                "{name}: it needs a temporary file, and there is none in {} ({error}; TMPDIR names the folder), nor beside it ({beside})",
                shown(&folders)
            );
            io::Error::new(error.kind(), message)
        })
    })
}

/// Messages about incomplete files that were not printed yet.
pub(in crate::cli) fn said() -> Vec<String> {
    std::mem::take(&mut *lock(&SAID))
}

/// Keeps the name of a file that stands in its place.
pub(super) fn note_written(name: String) {
    lock(&WRITTEN).push(name);
}

/// The written files that were not reported yet.
pub(in crate::cli) fn written() -> Vec<String> {
    std::mem::take(&mut *lock(&WRITTEN))
}

/// Ends all incomplete files, for a process that ends next: from then on no file can be begun, written or completed. Returns the
/// messages about them; `None` if a file is being written and that does not finish.
pub(in crate::cli) fn abandon_all(why: &str) -> Option<Vec<String>> {
    const TRIES: usize = 10;
    const INTERVAL: std::time::Duration = std::time::Duration::from_millis(10);
    for _ in 0..TRIES {
        match BEGUN.try_lock() {
            Ok(mut begun) => {
                let said = begun.drain(..).filter_map(|begun| begun.abandon(why)).collect();
                std::mem::forget(begun);
                return Some(said);
            }
            Err(_) => std::thread::sleep(INTERVAL),
        }
    }
    None
}

impl Begun {
    fn abandon(self, why: &str) -> Option<String> {
        match self.unless_complete {
            UnlessComplete::Partial => {
                let has_bytes = self.temporary.as_file().metadata().is_ok_and(|metadata| metadata.len() > 0);
                let partial = has_bytes.then(|| partial_place(&self.place, &self.inputs))?;
                let kept = match self.temporary.persist(&partial) {
                    Ok(_) => format!("{} shows what was computed", shown(&partial)),
                    Err(error) => format!("what was computed is not kept: {}: {}", shown(&partial), error.error),
                };
                Some(format!("{} is not written, because the run is incomplete: {kept}", shown(&self.path)))
            }
            UnlessComplete::Report(report) => {
                let place = self.place.clone();
                if may_hold_report(&place) && self.put(report(why).as_bytes()).is_err() {
                    // no report is better than an older one
                    let _ = fs::remove_file(place);
                }
                None
            }
        }
    }

    /// Puts a file with these bytes in the place.
    fn put(self, bytes: &[u8]) -> io::Result<()> {
        let mut file = self.temporary.as_file();
        file.set_len(0)?;
        file.rewind()?;
        file.write_all(bytes)?;
        self.temporary.persist(&self.place)?;
        Ok(())
    }
}

/// Whether a report may be written to this place: it is empty, or has an older report.
fn may_hold_report(place: &Path) -> bool {
    const START: usize = 512;
    let Ok(file) = File::open(place) else { return !place.exists() };
    let mut start = Vec::new();
    let read = io::Read::read_to_end(&mut io::Read::take(file, START as u64), &mut start);
    read.is_ok() && (start.is_empty() || String::from_utf8_lossy(&start).contains("<testsuite"))
}

/// The name for an incomplete file's content; never the name of a file that is read.
fn partial_place(place: &Path, inputs: &[PathBuf]) -> PathBuf {
    let named = |end: &str| {
        let mut name = place.file_name().unwrap_or_default().to_owned();
        name.push(end);
        place.with_file_name(name)
    };
    let numbered = (2_u32..).map(|number| named(&format!(".partial-{number}")));
    let mut places = std::iter::once(named(".partial")).chain(numbered);
    places.find(|partial| !is_input(partial, inputs)).unwrap_or_else(|| named(".partial"))
}
