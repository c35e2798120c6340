//! Tables for `batch`, `paste`, `report` and `read`: options for reading a file, and files as tables. A cell without an owner in any
//! of the files ends the run before the first result.

use std::collections::HashSet;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

use bytes::Bytes;

use super::output::{Failure, Output};
use super::target::{self, is_dash, shown};
use super::written;
use super::{set, stream};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::Model;
use crate::parallel::lock;
use crate::report;
use crate::spec::{self, Spec, TableSection};
use crate::table::{
    CellRange, ColumnOption, Container, DecimalMark, Encoding, Guesses, IsCurve, KnownWorkbook, Layout, LineRule,
    MOST_RULES, PartNames, Parts, Pattern, Proposal, Reading, Repeats, Separator, Source, Table, Want,
};

/// How files are to be read.
#[derive(Debug, Clone, Default, clap::Args)]
// stands last in the arguments of a subcommand: later ones would stand under its heading, too
#[command(next_help_heading = "Reading tables, where it is not to be found from the table")]
pub(super) struct ReadArgs {
    /// What stands before decimals.
    #[arg(long, value_enum, value_name = "MARK")]
    decimal: Option<DecimalMark>,
    /// The separator: a character or `tab`.
    #[arg(long, value_parser = Separator::byte_of, value_name = "CHAR")]
    separator: Option<u8>,
    /// The encoding of a text, such as utf-16le.
    #[arg(long, value_parser = Encoding::named, value_name = "NAME")]
    encoding: Option<Encoding>,
    /// Leave out columns and lines of this name, `*` for any characters.
    #[arg(long, value_name = "PATTERN")]
    ignore: Vec<String>,
    /// Leave out lines such as `Date: #`, `#` for a number or a date.
    #[arg(long, value_name = "PATTERN")]
    ignore_lines: Vec<String>,
    /// What a column is, such as `rack_pitch=CHR_017[um]`.
    #[arg(long, value_name = "KEY=NAME")]
    column: Vec<ColumnOption>,
    /// A file with the `[table]` of a supplier, for any number of specs.
    #[arg(long, value_name = "FILE")]
    layout: Option<PathBuf>,
    /// The column that names the part.
    #[arg(long, value_name = "NAME")]
    id: Option<String>,
    /// Headings of a table without any: `part_id,rack_pitch[um]`.
    #[arg(long = "as", value_delimiter = ',', value_name = "NAME,…")]
    headings: Vec<String>,
    /// Whether parts are rows, columns or characteristics.
    #[arg(long, value_enum, value_name = "WHERE", hide_possible_values = true)]
    parts: Option<Parts>,
    /// The sheet of an Excel workbook.
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
    /// The cells of the sheet that are the table.
    #[arg(long, value_name = "A1:F200")]
    range: Option<CellRange>,
}

/// A person's confirmation that a column has a role.
#[derive(Debug, Clone)]
pub(super) struct Accepted {
    pub(super) key: String,
    pub(super) column: String,
}

/// A table, and the spec completed by its file.
pub(super) struct Opened {
    pub(super) table: Table,
    pub(super) spec: Arc<Spec>,
    /// Remarks on values taken from the file.
    pub(super) notes: Vec<String>,
}

/// A table that was opened, and how it is opened again.
pub(super) struct Reopened<'a> {
    pub(super) opened: Opened,
    pub(super) opener: Opener<'a>,
    pub(super) path: PathBuf,
}

/// Opens the tables of a run.
#[derive(Clone)]
pub(super) struct Opener<'a> {
    pub(super) how: &'a ReadArgs,
    pub(super) spec: Arc<Spec>,
    /// The formulas of the measures in Q-DAS files.
    pub(super) model: Model,
    pub(super) stop: &'a Arc<AtomicBool>,
    /// The content of standard input, if it was read before.
    pub(super) stdin: Option<Bytes>,
    /// Whether rows are teeth or spaces, where it is known.
    pub(super) teeth: Option<bool>,
    /// Whether a table with the headings of a measured curve is one.
    pub(super) curves: bool,
    /// The workbook that was opened last.
    pub(super) known: Arc<Mutex<Option<(PathBuf, KnownWorkbook)>>>,
}

/// The files of a run, all of them opened once.
pub(super) struct Files<'a> {
    opener: Opener<'a>,
    /// The files that can be read.
    pub(super) paths: Vec<PathBuf>,
    /// The first table, and with one file the only one; `None` once it is evaluated.
    pub(super) first: Option<Opened>,
    /// A later table from standard input, which cannot be opened again.
    from_stdin: Option<Opened>,
    /// The parts of the tables behind each, where the last row of a part is judged.
    later: Vec<Arc<HashSet<String>>>,
    /// Faults of files that cannot be read; the others are evaluated nevertheless.
    pub(super) failed: Vec<Diagnostic>,
}

impl ReadArgs {
    /// The spec with the layout that stands in a file of its own.
    pub(super) fn laid_out(&self, spec: Spec) -> Result<Spec, Failure> {
        let Some(path) = &self.layout else { return Ok(spec) };
        Ok(spec.with_layout(&shown(path), &set::text(path)?)?)
    }

    /// The file of the layout, if there is one.
    pub(super) fn layout_file(&self) -> Option<&PathBuf> {
        self.layout.as_ref()
    }

    /// A contract with the user's options.
    fn added_to(&self, layout: &Layout) -> Layout {
        let ignored = self.ignore.iter().map(|pattern| Pattern::of_heading(pattern));
        let lines = self.ignore_lines.iter().map(|line| LineRule { pattern: Pattern::of_line(line), at_most: 0 });
        let mut all = Layout {
            encoding: self.encoding.or(layout.encoding),
            sheet: self.sheet.clone().or_else(|| layout.sheet.clone()),
            range: self.range.unwrap_or(layout.range),
            parts: self.parts.or(layout.parts),
            separator: self.separator.or(layout.separator),
            decimal: self.decimal.or(layout.decimal),
            headings: self.headings.clone(),
            part_id: self.id.clone().map(PartNames::Column).or_else(|| layout.part_id.clone()),
            ignore: layout.ignore.iter().cloned().chain(ignored).collect(),
            ignore_lines: layout.ignore_lines.iter().cloned().chain(lines).collect(),
            ..layout.clone()
        };
        for option in &self.column {
            all.declare(option);
        }
        all
    }
}

impl<'a> Opener<'a> {
    /// Options for tables that are evaluated.
    pub(super) fn new(how: &'a ReadArgs, spec: &Arc<Spec>, model: Model, stop: &'a Arc<AtomicBool>) -> Self {
        let spec = Arc::clone(spec);
        Self { how, spec, model, stop, stdin: None, teeth: None, curves: false, known: Arc::default() }
    }

    /// The layout of a table by the spec and the user.
    fn want(&self, spec: &Spec) -> Want {
        let mut layout = self.how.added_to(&spec.table.layout);
        if self.curves {
            layout.curve = IsCurve::ByHeadings;
        }
        Want { teeth: self.teeth, layout: layout.into(), ..spec.want() }
    }

    /// A file as a table.
    pub(super) fn open(&self, path: &Path) -> Result<Opened, Failure> {
        self.table(self.container(path)?, &stream::name(path))
    }

    /// A file whose format is recognised.
    fn container(&self, path: &Path) -> Result<Container, Failure> {
        if target::ending(path) == "toml" {
            let message = format!("{} is a spec, and not a table", shown(path));
            return Err(Diagnostic::error(Code::BadTable, message).help(spec::NOT_A_SPEC).into());
        }
        let want = self.want(&self.spec);
        if let Some((definitions, values)) = qdas_pair(path) {
            let sources = (self.source(&definitions)?, self.source(&values)?);
            return Ok(Container::qdas_pair((&shown(definitions), sources.0), (&shown(values), sources.1), &want)?);
        }
        let container = Container::open(&stream::name(path), self.source(path)?, &want)?;
        let known = container.known().map(|known| (path.to_owned(), known));
        *lock(&self.known) = known;
        Ok(container)
    }

    /// The rules that would close the table of a file, beside those of a spec.
    pub(super) fn proposed(&self, path: &Path, spec: &Spec) -> Result<Proposal, Failure> {
        let opener = Self { spec: Arc::new(spec.clone()), ..self.clone() };
        let container = opener.container(path)?;
        let (spec, _) = opener.completed(&container)?;
        Ok(container.proposal(&stream::name(path), &opener.want(&spec))?)
    }

    /// The rules that would close the table of a file. The file is read again by each proposal until the proposal adds nothing.
    /// `accepted` are a person's confirmations of columns.
    pub(super) fn proposal(&self, path: &Path, accepted: &[Accepted]) -> Result<Proposal, Failure> {
        const ROUNDS: usize = 4;
        let mut proposal = self.proposed(path, &self.spec)?;
        let accept =
            |proposal: &mut Proposal| accepted.iter().filter(|one| proposal.accept(&one.key, &one.column)).count();
        accept(&mut proposal);
        let mut before = String::new();
        for _ in 0..ROUNDS {
            let block = proposal.block(Guesses::Filled);
            // so many rules mean that it is another table
            if proposal.is_closed() || proposal.lacks_values() || block == before || proposal.count() > MOST_RULES {
                break;
            }
            let Ok(next) = self.with_block(&block).and_then(|spec| self.proposed(path, &spec)) else { break };
            proposal.join_next(next);
            accept(&mut proposal);
            before = block;
        }
        Ok(proposal)
    }

    /// The spec with the lines of a contract.
    pub(super) fn with_block(&self, block: &str) -> Result<Spec, Failure> {
        let source = self.spec.source_of_columns();
        Ok(self.spec.with_contract(&written::merged(&source.name, &source.text, block, "")?)?)
    }

    /// The file of the contract: that of the layout, or else the spec.
    pub(super) fn contract_file<'p>(&'p self, spec: &'p Path) -> &'p Path {
        self.how.layout_file().map_or(spec, PathBuf::as_path)
    }

    /// The refusals of files that are not closed, with all that they lack at once; the last one has the `[table]` that closes all of
    /// them.
    fn refusals(&self, open: Vec<(PathBuf, Vec<Diagnostic>)>) -> Vec<Diagnostic> {
        let (mut proposals, mut refused) = (Vec::new(), Vec::new());
        for (path, problems) in open {
            match self.proposal(&path, &[]) {
                Ok(proposal) => proposals.push(proposal),
                Err(_) => refused.extend(problems),
            }
        }
        let block = Proposal::joined(&proposals).block(Guesses::Shown);
        let last = proposals.len().saturating_sub(1);
        let each = proposals.iter().enumerate();
        let refusal = |(at, proposal): (usize, &Proposal)| {
            proposal.refused(Some(&*block).filter(|_| at == last)).about(&proposal.file)
        };
        refused.extend(each.map(refusal));
        refused
    }

    /// Where the bytes of a file are.
    fn source(&self, path: &Path) -> Result<Source, Failure> {
        Ok(match &self.stdin {
            _ if !is_dash(path) => {
                let (file, known) = (stream::file(path)?, lock(&self.known));
                match &*known {
                    Some((of, known)) if of == path => Source::Known(file, known.clone()),
                    _ => Source::File(file),
                }
            }
            Some(bytes) => Source::Stream(Box::new(Cursor::new(bytes.clone()))),
            None => Source::Stream(stream::open(path, self.stop)?),
        })
    }

    /// What stands in a block of text.
    pub(super) fn block(&self, bytes: Vec<u8>) -> Result<Opened, Failure> {
        const NAME: &str = "<block>";
        self.table(Container::open(NAME, Source::bytes(bytes), &self.want(&self.spec))?, NAME)
    }

    /// The table of a file that was recognised.
    fn table(&self, container: Container, name: &str) -> Result<Opened, Failure> {
        let (spec, notes) = self.completed(&container)?;
        let want = self.want(&spec);
        let table = container.table(name, &want)?;
        Ok(Opened { table, spec, notes })
    }

    /// The spec, completed by a file.
    fn completed(&self, container: &Container) -> Result<(Arc<Spec>, Vec<String>), Failure> {
        Ok(match container.qdas() {
            Some(qdas) => {
                let (completed, notes) = self.spec.completed_by(qdas, self.model)?;
                (Arc::new(completed), notes)
            }
            None => (Arc::clone(&self.spec), Vec::new()),
        })
    }

    /// Looks at every file before any is evaluated.
    pub(super) fn look(&self, paths: &[PathBuf]) -> Result<Files<'a>, Failure> {
        let (mut first, mut from_stdin, mut failed) = (None, None, Vec::new());
        let (mut kept, mut open) = (Vec::new(), Vec::new());
        let mut pairs = HashSet::new();
        // both files of a pair are one table
        let is_new = |path: &&PathBuf| qdas_pair(path).is_none_or(|pair| pairs.insert(pair));
        for path in paths.iter().filter(is_new) {
            match self.open(path).and_then(|opened| alike(opened, first.as_ref())) {
                Ok(opened) => {
                    if kept.is_empty() {
                        first = Some(opened);
                    } else if is_dash(path) {
                        from_stdin = Some(opened);
                    }
                    kept.push(path.clone());
                }
                Err(failure) => {
                    let problems = diagnostics_of(path, failure);
                    // a pipe cannot be read again
                    let is_open = !is_dash(path);
                    if is_open && problems.iter().any(|problem| problem.code == Code::NotUnderstood) {
                        open.push((path.clone(), problems));
                    } else {
                        failed.extend(problems);
                    }
                }
            }
        }
        failed.extend(self.refusals(open));
        if first.is_none() {
            return Err(Diagnostics(failed).into());
        }
        let is_last = self.spec.table.layout.repeats == Repeats::Last && kept.len() > 1;
        let later = if is_last { self.later(&kept)? } else { Vec::new() };
        Ok(Files { opener: self.clone(), paths: kept, first, from_stdin, later, failed })
    }

    /// The names of the parts in the tables behind each, the first table's last.
    fn later(&self, paths: &[PathBuf]) -> Result<Vec<Arc<HashSet<String>>>, Failure> {
        let (mut names, mut later) = (HashSet::new(), Vec::new());
        for path in paths.iter().rev() {
            if is_dash(path) {
                let message = "the last row of a part is judged, and of several tables one is standard input";
                return Err(Diagnostic::usage(message).help("give all of them as files").into());
            }
            later.push(Arc::new(names.clone()));
            let blocks =
                self.open(path)?.table.blocks().map_err(|error| Diagnostic::unreadable(&shown(path), &error))?;
            let each = blocks.iter().flat_map(|block| (0..block.rows()).filter_map(|row| block.name(row)));
            names.extend(each.map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()));
        }
        Ok(later)
    }
}

impl Files<'_> {
    /// The next table: some are open already.
    pub(super) fn next(&mut self, path: &Path) -> Result<Opened, Failure> {
        if let Some(later) = self.later.pop() {
            let spec = Spec::clone(&self.opener.spec);
            let layout = Layout { later, ..Layout::clone(&spec.table.layout) };
            let table = TableSection { layout: layout.into(), ..spec.table.clone() };
            return Opener { spec: Arc::new(Spec { table, ..spec }), ..self.opener.clone() }.open(path);
        }
        let opened = self.first.take().or_else(|| self.from_stdin.take_if(|_| is_dash(path)));
        opened.map_or_else(|| self.opener.open(path), Ok)
    }
}

/// A table after the first one: its file must complete the spec in the same way.
fn alike(opened: Opened, first: Option<&Opened>) -> Result<Opened, Failure> {
    if let Some(first) = first {
        opened.spec.refuse_other(&opened.table.name, (&first.table.name, &first.spec))?;
    }
    Ok(opened)
}

/// The files of definitions and of values, if the name is that of one of them.
pub(super) fn qdas_pair(path: &Path) -> Option<(PathBuf, PathBuf)> {
    if !["dfd", "dfx"].contains(&target::ending(path).as_str()) {
        return None;
    }
    let extension = path.extension()?.to_str()?;
    let other = |wanted: &str| {
        // LOT.DFD and LOT.DFX, too
        let is_upper = extension.chars().all(|c| c.is_ascii_uppercase());
        let wanted = if is_upper { wanted.to_ascii_uppercase() } else { wanted.to_owned() };
        path.with_extension(wanted)
    };
    Some((other("dfd"), other("dfx")))
}

/// Every file that is read for this name.
pub(super) fn files_read(path: &Path) -> Vec<PathBuf> {
    match qdas_pair(path) {
        Some((definitions, values)) => vec![definitions, values],
        None => vec![path.to_owned()],
    }
}

/// Prints how tables were read, with warnings.
pub(super) fn say(readings: &[Reading], notes: &[String], output: &mut Output) {
    let told = say_readings(readings, output);
    let mut remarks = report::remarks(&told, notes);
    report::add_new(&mut remarks, readings.iter().flat_map(Reading::warnings));
    for remark in remarks {
        let text = report::noted(&remark);
        let is_warning = readings.iter().any(|reading| reading.notes.contains(&remark));
        if is_warning { output.message(&text) } else { output.remark(&text) }
    }
}

/// Prints how tables were read, a line for each; returns the tables with a line.
pub(super) fn say_readings(readings: &[Reading], output: &mut Output) -> Vec<Reading> {
    let mut said: Vec<String> = Vec::new();
    let mut told = Vec::new();
    for reading in readings {
        // files that are read alike have one line
        let shape = Reading { file: String::new(), ..reading.clone() }.to_string();
        if !said.contains(&shape) {
            output.remark(&reading.to_string());
            said.push(shape);
            told.push(reading.clone());
        }
    }
    told
}

/// Why a table cannot be read, with its name.
pub(super) fn diagnostics_of(path: &Path, failure: Failure) -> Vec<Diagnostic> {
    let name = stream::name(path);
    diagnostics(failure).into_iter().map(|diagnostic| diagnostic.about(&name)).collect()
}

/// Why there is no result.
pub(super) fn diagnostics(failure: Failure) -> Vec<Diagnostic> {
    match failure {
        Failure::Diagnostics(diagnostics) => diagnostics,
        Failure::Usage(error) => vec![Diagnostic::usage(error.to_string())],
        Failure::Write(error) => vec![Diagnostic::error(Code::FileAccess, error.to_string())],
    }
}
