//! Files that are written. A file appears under its name once it is complete and on the disk. Until then it stands beside its place
//! under another name; a run that fails or is interrupted leaves the old file, if there is one, and the content so far in
//! `NAME.partial`. A file that is read is never written, under any name. Pipes and devices are written directly.

mod begun;
mod names;

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

pub(super) use begun::{UnlessComplete, abandon_all, end_reports, said, temporary, written};
pub(super) use names::{ending, is_dash, known_ending, refuse_inputs, refuse_same, shown};

use super::output::{Failure, Output};
use super::stream;
use crate::diagnostic::{Code, Diagnostic};

/// A file that is being written. If it is dropped without [`Target::finish`], it is incomplete.
pub(super) struct Target {
    /// Its name on the command line.
    path: PathBuf,
    writer: Box<dyn Write + Send>,
    /// Its number among the begun files; `None` for a pipe or a device.
    begun: Option<u64>,
}

impl Target {
    /// Begins the file `path` (`-` is standard output) in a run that reads `inputs` (`-` is standard input).
    pub(super) fn create(path: impl AsRef<Path>, inputs: &[impl AsRef<Path>]) -> Result<Self, Failure> {
        Self::with(path, inputs, UnlessComplete::Partial)
    }

    /// Begins a file with the given treatment if it is not completed.
    pub(super) fn with(
        path: impl AsRef<Path>,
        inputs: &[impl AsRef<Path>],
        unless_complete: UnlessComplete,
    ) -> Result<Self, Failure> {
        let path = path.as_ref().to_owned();
        refuse_inputs(&path, inputs)?;
        let inputs = inputs.iter().map(|input| input.as_ref().to_owned()).collect();
        let (writer, begun) = open(&path, inputs, unless_complete).map_err(|error| unwritable(&path, error))?;
        Ok(Self { path, writer, begun })
    }

    /// Gives the place to a writer that keeps it to its end, and flushes it there.
    pub(super) fn take_writer(&mut self) -> Box<dyn Write + Send> {
        std::mem::replace(&mut self.writer, Box::new(io::sink()))
    }

    /// Puts the complete file in its place.
    pub(super) fn finish(self) -> Result<(), Failure> {
        self.put(true)
    }

    /// Puts the complete file in its place, if nothing is there.
    pub(super) fn finish_new(self) -> Result<(), Failure> {
        self.put(false)
    }

    fn put(mut self, replaces: bool) -> Result<(), Failure> {
        self.writer.flush()?;
        // some systems do not rename a file that is open
        drop(self.take_writer());
        let Some(begun) = self.begun else { return Ok(()) };
        begun::finish(begun, replaces).map_err(|error| unwritable(&self.path, error))?;
        begun::note_written(shown(&self.path));
        Ok(())
    }

    /// Puts the file in its place if the run is complete; otherwise keeps its content beside it, and says so.
    pub(super) fn end(mut self, is_complete: bool, output: &mut Output) -> Result<(), Failure> {
        if is_complete {
            return self.finish();
        }
        self.writer.flush()?;
        let nothing = self.begun.map(|_| shown(&self.path));
        drop(self);
        let said = said();
        for line in &said {
            output.message(line);
        }
        if let Some(path) = nothing.filter(|_| said.is_empty()) {
            output.message(&format!("{path} is not written, because the run is incomplete: nothing of it is kept"));
        }
        Ok(())
    }

    /// Removes a file that is useless while incomplete, and says so.
    pub(super) fn discard(self, output: &mut Output) {
        self.begun.into_iter().for_each(begun::discard);
        let path = shown(&self.path);
        output.message(&format!("{path} is not written, because the run is incomplete: nothing of it is kept"));
    }

    /// Puts this text in the file and the file in its place.
    pub(super) fn write_whole(mut self, text: &[u8]) -> Result<(), Failure> {
        self.write_all(text)?;
        self.finish()
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        self.begun.into_iter().for_each(begun::drop_file);
    }
}

impl Write for Target {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

/// The process's own stream of that name: opened once more it would be written from its start.
fn own_stream(path: &Path) -> Option<Box<dyn Write + Send>> {
    match path.to_str()? {
        "-" | "/dev/stdout" | "/dev/fd/1" | "/proc/self/fd/1" => Some(Box::new(stream::Stdout)),
        "/dev/stderr" | "/dev/fd/2" | "/proc/self/fd/2" => Some(Box::new(io::stderr())),
        _ => None,
    }
}

/// Whether it is the process's standard output or standard error.
pub(super) fn is_own_stream(path: &Path) -> bool {
    own_stream(path).is_some()
}

/// A pipe or a device.
struct Stream(PathBuf, std::fs::File);

impl Write for Stream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // here a closed pipe is an error, unlike on standard output
        self.1.write(bytes).map_err(|error| io::Error::other(named(&shown(&self.0), &error)))
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn open(
    path: &Path,
    inputs: Vec<PathBuf>,
    unless_complete: UnlessComplete,
) -> io::Result<(Box<dyn Write + Send>, Option<u64>)> {
    if let Some(own) = own_stream(path) {
        return Ok((own, None));
    }
    let found = names::metadata(path)?;
    if names::is_stream(path, found.as_ref()) {
        // another descriptor of the process may be a file, which must not be truncated
        return Ok((Box::new(Stream(path.to_owned(), OpenOptions::new().append(true).open(path)?)), None));
    }
    let (begun, writer) = begun::begin(path, names::behind_links(path)?, found, inputs, unless_complete)?;
    Ok((Box::new(writer), Some(begun)))
}

/// Writes a file from all its bytes.
pub(super) fn write(path: impl AsRef<Path>, inputs: &[impl AsRef<Path>], bytes: &[u8]) -> Result<(), Failure> {
    Target::create(path, inputs)?.write_whole(bytes)
}

/// Makes a folder that files are to be written to.
pub(super) fn create_folder(path: &Path) -> Result<(), Failure> {
    Ok(std::fs::create_dir_all(path).map_err(|error| {
        Diagnostic::error(Code::FileAccess, format!("cannot make the folder {}: {error}", shown(path)))
    })?)
}

/// An error of writing that names what cannot be written.
pub(super) fn named(what: &str, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{what}: {error}"))
}

/// Why a file cannot be written. A closed pipe is no error.
fn unwritable(path: &Path, error: io::Error) -> Failure {
    if error.kind() == io::ErrorKind::BrokenPipe {
        return Failure::Write(error);
    }
    let diagnostic = Diagnostic::error(Code::FileAccess, format!("cannot write {}: {error}", shown(path)));
    diagnostic
        .help("the file must be writable, and its folder too: the file is written beside its name and renamed")
        .into()
}

#[cfg(test)]
mod tests;
