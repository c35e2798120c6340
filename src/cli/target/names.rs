//! Names of files: where they lead, which of them are one file, and what their endings say.

use std::fs::{self, Metadata};
use std::io;
use std::path::{Path, PathBuf};

use super::own_stream;
use crate::cli::output::Failure;
use crate::diagnostic::Diagnostic;

/// A name as messages and reports show it; bytes that are no text are shown as �.
pub(in crate::cli) fn shown(path: impl AsRef<Path>) -> String {
    path.as_ref().to_string_lossy().into_owned()
}

/// Whether this is the name of standard input or standard output.
pub(in crate::cli) fn is_dash(path: impl AsRef<Path>) -> bool {
    path.as_ref() == Path::new("-")
}

/// The file behind a name; `None` if there is none.
pub(super) fn metadata(path: &Path) -> io::Result<Option<Metadata>> {
    match fs::metadata(path) {
        _ if path.as_os_str().as_encoded_bytes().last().is_some_and(|end| std::path::is_separator((*end).into())) => {
            Err(io::ErrorKind::IsADirectory.into())
        }
        Ok(metadata) if metadata.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(metadata) => Ok(Some(metadata)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// Whether a name is one of a pipe, a device or an open descriptor, which cannot be replaced.
pub(super) fn is_stream(path: &Path, found: Option<&Metadata>) -> bool {
    let is_descriptor = ["/dev/fd", "/proc/self/fd"].iter().any(|folder| path.starts_with(folder));
    is_descriptor || found.is_some_and(|found| !found.is_file())
}

/// The file that a name stands for, behind all links, also where the last of them leads to nothing yet.
pub(super) fn behind_links(path: &Path) -> io::Result<PathBuf> {
    const MOST: usize = 40;
    let mut place = path.to_owned();
    for _ in 0..MOST {
        match fs::read_link(&place) {
            Ok(target) => place = place.with_file_name("").join(target),
            Err(_) => return Ok(place),
        }
    }
    Err(io::Error::other("too many links lead from one to the next"))
}

/// Refuses a file that is written and read as well.
pub(in crate::cli) fn refuse_inputs(path: impl AsRef<Path>, inputs: &[impl AsRef<Path>]) -> Result<(), Failure> {
    let path = path.as_ref();
    let is_read = |input: &&Path| !is_dash(path) && same_file(named(input), path);
    let Some(input) = inputs.iter().map(AsRef::as_ref).find(is_read) else { return Ok(()) };
    let read = match input {
        input if is_dash(input) => "standard input reads it".to_owned(),
        input if input == path => "it is read".to_owned(),
        input => format!("it is read as {}", shown(input)),
    };
    let message = format!("{} would be written over, and {read}", shown(path));
    Err(Diagnostic::usage(message).help("give what is written another name").into())
}

/// Whether a name is that of a file that is read.
pub(super) fn is_input(path: &Path, inputs: &[PathBuf]) -> bool {
    inputs.iter().any(|input| same_file(named(input), path))
}

/// A name for an input: standard input may be a file.
fn named(input: &Path) -> &Path {
    if is_dash(input) { Path::new("/dev/stdin") } else { input }
}

/// Refuses two outputs that are one file; pipes and devices may be the same.
pub(in crate::cli) fn refuse_same(paths: &[&Path]) -> Result<(), Failure> {
    for (index, path) in paths.iter().enumerate() {
        if let Some(other) = paths[..index].iter().find(|other| same_file(other, path)) {
            let message = format!("{} and {} are the same file, and both would be written", shown(other), shown(path));
            return Err(Diagnostic::usage(message).help("give one of them another name").into());
        }
    }
    Ok(())
}

/// Whether two names are of one file, which need not be there yet. Pipes and devices are never the same.
fn same_file(a: &Path, b: &Path) -> bool {
    let is_file = |path| fs::metadata(path).map(|found| found.is_file());
    match (is_file(a), is_file(b)) {
        (Ok(a_is_file), Ok(b_is_file)) => a_is_file && b_is_file && (is_same_entry(a, b) || is_same_place(a, b)),
        (Err(_), Err(_)) => is_same_place(a, b),
        // an existing file and a missing one are not the same
        _ => false,
    }
}

/// Whether two names lead to one file that is there and can be read.
fn is_same_entry(a: &Path, b: &Path) -> bool {
    same_file::is_same_file(a, b).unwrap_or(false)
}

/// Whether two names lead to one place.
fn is_same_place(a: &Path, b: &Path) -> bool {
    place_of(a).is_some_and(|a| place_of(b).is_some_and(|b| a == b))
}

/// The canonical form of the place that a name leads to.
fn place_of(path: &Path) -> Option<PathBuf> {
    let path = behind_links(path).ok()?;
    if let Ok(place) = fs::canonicalize(&path) {
        return Some(place);
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Some(fs::canonicalize(folder).ok()?.join(path.file_name()?))
}

/// The ending of a name in lower case, without its point; empty if it has none.
pub(in crate::cli) fn ending(path: impl AsRef<Path>) -> String {
    let ending = path.as_ref().extension().and_then(|ending| ending.to_str());
    ending.unwrap_or_default().to_ascii_lowercase()
}

/// Which of the `known` endings the name has, in lower case and without its point; `None` for standard output, a pipe
/// or a device, whose name says nothing. A name with another ending or none is refused. `unpacked` is the name of what is
/// packed: that of `rows.csv.gz` has the ending `csv`.
pub(in crate::cli) fn known_ending<'k>(
    path: impl AsRef<Path>,
    unpacked: impl AsRef<Path>,
    known: &[&'k str],
) -> Result<Option<&'k str>, Diagnostic> {
    let path = path.as_ref();
    let ending = ending(unpacked);
    if let Some(known) = known.iter().find(|known| **known == ending) {
        return Ok(Some(known));
    }
    if own_stream(path).is_some() || is_stream(path, fs::metadata(path).ok().as_ref()) {
        return Ok(None);
    }
    let message = format!("{}: the name's ending tells no format that can be written", shown(path));
    let endings: Vec<_> = known.iter().map(|known| format!(".{known}")).collect();
    let help = match endings.split_last() {
        Some((last, others)) if !others.is_empty() => format!("it ends in {} or {last}", others.join(", ")),
        _ => format!("it ends in {}", endings.concat()),
    };
    Err(Diagnostic::usage(message).help(help))
}
