//! Files that are written. A file appears under its name once it is complete: until then it stands beside it under a
//! name of its own, and a run that fails or is interrupted leaves the old file as it was, or none. A file that is read
//! is never written, whatever it is called. Pipes and devices are written as they are.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::output::{Failure, Output};
use super::stream;
use crate::diagnostic::{Code, Diagnostic};

/// A file that is being written. It is removed when it is dropped without [`Target::finish`] or
/// [`Target::keep_partial`].
pub(super) struct Target {
    /// What it was called on the command line.
    path: String,
    /// Files that are read.
    inputs: Vec<String>,
    writer: Box<dyn Write + Send>,
    /// Where a file stands until it is complete; `None` for what is no file.
    beside: Option<Beside>,
}

impl Target {
    /// Begins the file `path` (`-` is standard output) in a run that reads `inputs` (`-` is standard input).
    pub(super) fn create(path: &str, inputs: &[impl AsRef<str>]) -> Result<Self, Failure> {
        refuse_inputs(path, inputs)?;
        let (writer, beside) = open(path).map_err(|error| unwritable(path, error))?;
        let inputs = inputs.iter().map(|input| input.as_ref().to_owned()).collect();
        Ok(Self { path: path.to_owned(), inputs, writer, beside })
    }

    /// Gives the place to a writer that keeps it to its end, and flushes it there.
    pub(super) fn take_writer(&mut self) -> Box<dyn Write + Send> {
        std::mem::replace(&mut self.writer, Box::new(io::sink()))
    }

    /// Puts the file in its place, now that it is complete.
    pub(super) fn finish(self) -> Result<(), Failure> {
        let place = self.beside.as_ref().map(|beside| beside.place.clone());
        self.put(place).map(|_| ())
    }

    /// Ends what is written, and gives a file that stands beside its name this one.
    fn put(mut self, place: Option<PathBuf>) -> Result<Option<String>, Failure> {
        let put = || {
            self.writer.flush()?;
            // some systems do not rename a file that is open
            drop(self.take_writer());
            let Some((beside, place)) = self.beside.as_ref().zip(place) else { return Ok(None) };
            fs::rename(&beside.temporary, &place)?;
            Ok(Some(place.display().to_string()))
        };
        put().map_err(|error| unwritable(&self.path, error))
    }

    /// Puts the file in its place if the run is complete; otherwise keeps what there is beside it, and says so.
    pub(super) fn end(self, is_complete: bool, output: &mut Output) -> Result<(), Failure> {
        if is_complete {
            return self.finish();
        }
        let path = self.beside.as_ref().map(|_| self.path.clone());
        let kept = self.keep_partial()?;
        if let Some(path) = path {
            let kept = kept
                .map_or_else(|| "there is nothing yet".to_owned(), |name| format!("what there is stands in {name}"));
            output.message(&format!("{path} is not written, because the run is incomplete: {kept}"));
        }
        Ok(())
    }

    /// Removes a file that is good for nothing as long as it is not complete, and says so.
    pub(super) fn discard(self, output: &mut Output) {
        output.message(&format!("{} is not written, because the run is incomplete: there is nothing yet", self.path));
    }

    /// Keeps what there is of an incomplete file as `NAME.partial`, and gives that name. `None` if there is nothing to
    /// keep: no byte was written, or they are in a pipe already.
    pub(super) fn keep_partial(self) -> Result<Option<String>, Failure> {
        let has_bytes = |beside: &&Beside| fs::metadata(&beside.temporary).is_ok_and(|metadata| metadata.len() > 0);
        let written = self.beside.as_ref().filter(has_bytes);
        let place = written.map(|beside| partial_place(&beside.place, &self.inputs));
        self.put(place)
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
fn own_stream(path: &str) -> Option<Box<dyn Write + Send>> {
    match path {
        "-" | "/dev/stdout" | "/dev/fd/1" | "/proc/self/fd/1" => Some(Box::new(stream::Stdout)),
        "/dev/stderr" | "/dev/fd/2" | "/proc/self/fd/2" => Some(Box::new(io::stderr())),
        _ => None,
    }
}

/// Whether it is the process's standard output or standard error.
pub(super) fn is_own_stream(path: &str) -> bool {
    own_stream(path).is_some()
}

fn open(path: &str) -> io::Result<(Box<dyn Write + Send>, Option<Beside>)> {
    if let Some(own) = own_stream(path) {
        return Ok((own, None));
    }
    let (place, found) = (Path::new(path), metadata(path)?);
    if is_stream(place, found.as_ref()) {
        // what is behind another descriptor of the process may be a file, of which nothing may be lost
        return Ok((Box::new(OpenOptions::new().append(true).open(place)?), None));
    }
    let (beside, file) = Beside::create(behind_links(place)?, found)?;
    Ok((Box::new(file), Some(beside)))
}

/// A file that stands beside the name it is to have; what is still there at the end is removed.
struct Beside {
    /// The name it is to have, links resolved.
    place: PathBuf,
    /// The name it has.
    temporary: PathBuf,
}

impl Beside {
    /// Begins a file that is to stand at `place`, where `old` was found.
    fn create(place: PathBuf, old: Option<Metadata>) -> io::Result<(Self, File)> {
        if old.is_some() {
            // a file that must not be written must not be replaced
            OpenOptions::new().write(true).open(&place)?;
        }
        let (temporary, file) = exclusive(&place)?;
        let beside = Self { place, temporary };
        if let Some(old) = old {
            fs::set_permissions(&beside.temporary, old.permissions())?;
        }
        Ok((beside, file))
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        // one that has its name is no more there, and one that cannot be removed is in nobody's way
        let _ = fs::remove_file(&self.temporary);
    }
}

/// Makes a file beside `place` that nobody else has made.
fn exclusive(place: &Path) -> io::Result<(PathBuf, File)> {
    /// Characters of the name: the whole one has to fit a folder's longest.
    const LONGEST: usize = 40;
    const MOST: u32 = 1000;
    let name = place.file_name().ok_or_else(|| io::Error::from(io::ErrorKind::InvalidFilename))?;
    let name: String = name.to_string_lossy().chars().take(LONGEST).collect();
    let process = std::process::id();
    for number in 0..MOST {
        let temporary = place.with_file_name(format!(".{name}.{process}-{number}.part"));
        match File::create_new(&temporary) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            made => return made.map(|file| (temporary, file)),
        }
    }
    Err(io::Error::from(io::ErrorKind::AlreadyExists))
}

/// The name of what is there of an incomplete file: not that of a file that is read.
fn partial_place(place: &Path, inputs: &[String]) -> PathBuf {
    let name = place.file_name().unwrap_or_default().to_string_lossy();
    let is_read = |place: &PathBuf| inputs.iter().any(|input| same_file(named(input), &place.to_string_lossy()));
    let mut partial = place.with_file_name(format!("{name}.partial"));
    let mut number = 2_u32;
    while is_read(&partial) {
        partial = place.with_file_name(format!("{name}.partial-{number}"));
        number += 1;
    }
    partial
}

/// Writes a file whose bytes are all there.
pub(super) fn write(path: &str, inputs: &[impl AsRef<str>], bytes: &[u8]) -> Result<(), Failure> {
    written(path, inputs, bytes)?.finish()
}

/// A file with all its bytes, still to be put in its place.
pub(super) fn written(path: &str, inputs: &[impl AsRef<str>], bytes: &[u8]) -> Result<Target, Failure> {
    let mut target = Target::create(path, inputs)?;
    target.write_all(bytes).map_err(|error| unwritable(path, error))?;
    Ok(target)
}

/// What is found behind a name; `None` if there is nothing.
fn metadata(path: &str) -> io::Result<Option<Metadata>> {
    match fs::metadata(path) {
        _ if path.ends_with(std::path::is_separator) => Err(io::Error::from(io::ErrorKind::IsADirectory)),
        Ok(metadata) if metadata.is_dir() => Err(io::Error::from(io::ErrorKind::IsADirectory)),
        Ok(metadata) => Ok(Some(metadata)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// Whether a name is one of a pipe, a device or an open descriptor, which cannot be replaced.
fn is_stream(path: &Path, found: Option<&Metadata>) -> bool {
    let is_descriptor = ["/dev/fd", "/proc/self/fd"].iter().any(|folder| path.starts_with(folder));
    is_descriptor || found.is_some_and(|found| !found.is_file())
}

/// The file that a name stands for, behind all links, also where the last of them leads to nothing yet.
fn behind_links(path: &Path) -> io::Result<PathBuf> {
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
pub(super) fn refuse_inputs(path: &str, inputs: &[impl AsRef<str>]) -> Result<(), Failure> {
    let Some(input) = inputs.iter().map(AsRef::as_ref).find(|input| path != "-" && same_file(named(input), path))
    else {
        return Ok(());
    };
    let read = match input {
        "-" => "standard input reads it".to_owned(),
        input if input == path => "it is read".to_owned(),
        input => format!("it is read as {input}"),
    };
    let message = format!("{path} would be written over, and {read}");
    Err(Diagnostic::usage(message).help("give what is written another name").into())
}

/// A name for what is read: standard input may be a file.
fn named(input: &str) -> &str {
    if input == "-" { "/dev/stdin" } else { input }
}

/// Refuses two files to be written that are one; pipes and devices may be.
pub(super) fn refuse_same(paths: &[&str]) -> Result<(), Failure> {
    for (index, path) in paths.iter().enumerate() {
        if let Some(other) = paths[..index].iter().find(|other| same_file(other, path)) {
            let message = format!("{other} and {path} are the same file, and both would be written");
            return Err(Diagnostic::usage(message).help("give one of them another name").into());
        }
    }
    Ok(())
}

/// Whether two names are of one file, which need not be there yet. Pipes and devices are never the same.
fn same_file(a: &str, b: &str) -> bool {
    let (a, b) = (Path::new(a), Path::new(b));
    match (fs::metadata(a), fs::metadata(b)) {
        (Ok(found_a), Ok(found_b)) => {
            found_a.is_file() && found_b.is_file() && (same_entry(&found_a, &found_b) || same_place(a, b))
        }
        (Err(_), Err(_)) => same_place(a, b),
        // what is there is not what is not
        _ => false,
    }
}

/// Whether two names lead to one place.
fn same_place(a: &Path, b: &Path) -> bool {
    place_of(a).is_some_and(|a| place_of(b).is_some_and(|b| a == b))
}

/// Where a name leads to, written in the one way that every place has.
fn place_of(path: &Path) -> Option<PathBuf> {
    let path = behind_links(path).ok()?;
    if let Ok(place) = fs::canonicalize(&path) {
        return Some(place);
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Some(fs::canonicalize(folder).ok()?.join(path.file_name()?))
}

/// Whether two names found one file.
#[cfg(unix)]
fn same_entry(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

/// Whether two names found one file: here only the names tell.
#[cfg(not(unix))]
fn same_entry(_: &Metadata, _: &Metadata) -> bool {
    false
}

/// The ending of a name in lower case, without its point; empty if it has none.
pub(super) fn ending(path: &str) -> String {
    let ending = Path::new(path).extension().and_then(|ending| ending.to_str());
    ending.unwrap_or_default().to_ascii_lowercase()
}

/// Which of the `known` endings the name has, in lower case and without its point; `None` for standard output, a pipe
/// or a device, whose name says nothing. A name with another ending or none is refused. `unpacked` is the name of what is
/// packed: that of `rows.csv.gz` has the ending `csv`.
pub(super) fn known_ending<'k>(path: &str, unpacked: &str, known: &[&'k str]) -> Result<Option<&'k str>, Diagnostic> {
    let ending = ending(unpacked);
    if let Some(known) = known.iter().find(|known| **known == ending) {
        return Ok(Some(known));
    }
    if own_stream(path).is_some() || is_stream(Path::new(path), fs::metadata(path).ok().as_ref()) {
        return Ok(None);
    }
    let message = format!("{path}: the name's ending tells no format that can be written");
    let endings: Vec<_> = known.iter().map(|known| format!(".{known}")).collect();
    let help = match endings.split_last() {
        Some((last, others)) if !others.is_empty() => format!("it ends in {} or {last}", others.join(", ")),
        _ => format!("it ends in {}", endings.concat()),
    };
    Err(Diagnostic::usage(message).help(help))
}

/// Why a file cannot be written. That the reader of a pipe has seen enough is no fault.
fn unwritable(path: &str, error: io::Error) -> Failure {
    if error.kind() == io::ErrorKind::BrokenPipe {
        return Failure::Write(error);
    }
    Diagnostic::error(Code::FileAccess, format!("cannot write {path}: {error}"))
        .help("the file must be writable, and its folder too: the file is written beside its name and renamed")
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::Packing;

    const NONE: [&str; 0] = [];

    /// A folder of its own for one test, removed at the end.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("rackmesh-target-{}-{name}", std::process::id()));
            let _ = fs::remove_dir_all(&folder);
            fs::create_dir_all(&folder).unwrap();
            Self(folder)
        }

        fn path(&self, file: &str) -> String {
            self.0.join(file).to_str().unwrap().to_owned()
        }

        /// A file of this folder that holds its own name.
        fn with(&self, file: &str) -> String {
            fs::write(self.path(file), file).unwrap();
            self.path(file)
        }

        fn names(&self) -> Vec<String> {
            let entries = fs::read_dir(&self.0).unwrap();
            let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
            names.sort();
            names
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    fn text(path: &str) -> String {
        fs::read_to_string(path).unwrap()
    }

    fn message(failure: &Failure) -> String {
        match failure {
            Failure::Diagnostics(diagnostics) => crate::diagnostic::render(&diagnostics[0], false),
            other => format!("{other:?}"),
        }
    }

    fn refusal(path: &str, input: &str) -> String {
        Target::create(path, &["other", input]).err().map_or_else(String::new, |failure| message(&failure))
    }

    #[test]
    fn a_file_that_is_read_is_not_written_by_any_name() {
        let folder = Folder::new("same");
        let input = folder.with("parts.csv");
        fs::create_dir(folder.path("inner")).unwrap();
        for name in ["parts.csv", "./parts.csv", "inner/../parts.csv"] {
            let refused = refusal(&folder.path(name), &input);
            assert!(refused.contains("would be written over"), "{name}: {refused}");
            assert!(refused.contains("another name"), "{name}: {refused}");
        }
        assert_eq!(refusal(&folder.path("results.csv"), &input), "");
        assert_eq!(text(&input), "parts.csv");
        assert_eq!(folder.names(), ["inner", "parts.csv"]);
    }

    #[test]
    #[cfg(unix)]
    fn links_are_names_too() {
        let folder = Folder::new("links");
        let input = folder.with("parts.csv");
        let (hard, soft, second) = (folder.path("hard.csv"), folder.path("soft.csv"), folder.path("second.csv"));
        fs::hard_link(&input, &hard).unwrap();
        std::os::unix::fs::symlink("parts.csv", &soft).unwrap();
        std::os::unix::fs::symlink("soft.csv", &second).unwrap();
        for name in [&hard, &soft, &second] {
            assert!(refusal(name, &input).contains("would be written over"), "{name}");
            assert!(refusal(&input, name).contains("would be written over"), "{name}");
        }
    }

    #[test]
    fn two_files_to_be_written_are_two() {
        let folder = Folder::new("two");
        let (a, b, again) = (folder.path("a.csv"), folder.path("b.csv"), folder.path("./a.csv"));
        assert!(refuse_same(&[&a, &b]).is_ok());
        // before there is a file, and after
        for _ in 0..2 {
            let refused = message(&refuse_same(&[&a, &b, &again]).unwrap_err());
            assert!(refused.contains("a.csv are the same file"), "{refused}");
            folder.with("a.csv");
        }
        #[cfg(unix)]
        assert!(refuse_same(&["/dev/null", "/dev/null"]).is_ok());
    }

    #[test]
    fn the_old_file_stays_until_the_other_is_complete() {
        let folder = Folder::new("old");
        let path = folder.with("results.csv");
        let mut target = Target::create(&path, &NONE).unwrap();
        target.write_all(b"half").unwrap();
        assert_eq!(text(&path), "results.csv");
        drop(target);
        assert_eq!((text(&path).as_str(), folder.names().len()), ("results.csv", 1));
        write(&path, &NONE, b"whole").unwrap();
        assert_eq!((text(&path).as_str(), folder.names().len()), ("whole", 1));
        // and where there is none, none comes to be
        drop(Target::create(&folder.path("none.csv"), &NONE).unwrap());
        assert_eq!(folder.names(), ["results.csv"]);
    }

    #[test]
    fn what_was_computed_is_kept_under_a_name_of_its_own() {
        let folder = Folder::new("partial");
        let path = folder.with("results.csv");
        let partial = |inputs: &[&str], bytes: &[u8]| {
            let mut target = Target::create(&path, inputs).unwrap();
            target.write_all(bytes).unwrap();
            target.keep_partial().unwrap()
        };
        assert_eq!(partial(&[], b""), None);
        let kept = folder.path("results.csv.partial");
        assert_eq!(partial(&[], b"half"), Some(kept.clone()));
        assert_eq!((text(&path).as_str(), text(&kept).as_str()), ("results.csv", "half"));
        assert_eq!(partial(&[], b"more"), Some(kept.clone()));
        assert_eq!(partial(&[&kept], b"other"), Some(folder.path("results.csv.partial-2")));
        assert_eq!(text(&kept), "more");
        assert_eq!(folder.names(), ["results.csv", "results.csv.partial", "results.csv.partial-2"]);
    }

    #[test]
    #[cfg(unix)]
    fn permissions_and_links_stay() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = Folder::new("permissions");
        let (path, link, dangling) = (folder.with("results.csv"), folder.path("link.csv"), folder.path("dangling.csv"));
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink("results.csv", &link).unwrap();
        std::os::unix::fs::symlink("later.csv", &dangling).unwrap();
        write(&link, &NONE, b"through the link").unwrap();
        write(&dangling, &NONE, b"later").unwrap();
        assert_eq!(text(&path), "through the link");
        assert_eq!(text(&folder.path("later.csv")), "later");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        assert!([link, dangling].iter().all(|link| fs::symlink_metadata(link).unwrap().is_symlink()));
    }

    #[test]
    fn what_cannot_be_written_says_why() {
        let folder = Folder::new("unwritable");
        for path in [folder.path(""), folder.path("none/a.csv"), folder.path("none/")] {
            let failure = write(&path, &NONE, b"x").unwrap_err();
            assert!(message(&failure).contains("cannot write"), "{path}");
        }
        assert!(folder.names().is_empty());
    }

    #[test]
    #[cfg(unix)]
    fn devices_are_written_as_they_are() {
        write("/dev/null", &["/dev/null"], b"x").unwrap();
        assert_eq!(Target::create("/dev/null", &NONE).unwrap().keep_partial().unwrap(), None);
    }

    #[test]
    fn endings_are_those_that_are_known() {
        let known = ["csv", "svg"];
        for (path, ending) in [("a.csv", "csv"), ("b.c/A.SVG", "svg")] {
            assert_eq!(known_ending(path, path, &known).unwrap(), Some(ending), "{path}");
        }
        for path in ["a.pdf", "a", "csv", ".csv", "a.csv.gz", ""] {
            let refused = message(&known_ending(path, path, &known).unwrap_err().into());
            assert!(refused.contains("it ends in .csv or .svg"), "{path}: {refused}");
        }
        for path in ["a.csv.gz", "a.csv.ZST", "a.csv"] {
            assert_eq!(known_ending(path, Packing::of_name(path).1, &known).unwrap(), Some("csv"), "{path}");
        }
        for path in ["a.gz", "a.pdf.gz", "a.csv.zip", "ü.gz"] {
            assert!(known_ending(path, Packing::of_name(path).1, &known).is_err(), "{path}");
        }
        assert_eq!(known_ending("-", "-", &known).unwrap(), None);
        #[cfg(unix)]
        assert_eq!(known_ending("/dev/null", "/dev/null", &known).unwrap(), None);
    }
}
