//! `rackmesh read`: how tables would be read; evaluates nothing.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::output::{Failure, Output, Status};
use super::set::SetArgs;
use super::tables::{self, Opener, ReadArgs};
use super::{signals, target};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::formula::Model;
use crate::quantity::shown;
use crate::report::{Block, Format, Report, Table, reading_blocks, remarks};
use crate::table::{Reading, Stranger, refusal};

pub(super) const ABOUT: &str = "Show how tables would be read, and the mapping for a spec";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh read parts.csv
  rackmesh read export.txt --spec rack.toml
  rackmesh read lot.xlsx --sheet 'Lot 7' --format json

Exit status: 0 every column is understood or no measurement, 2 something is not understood or cannot be read.")]
pub(super) struct Args {
    /// Tables: text, Excel workbooks (.xlsx), Q-DAS files (.dfq, .dfd with .dfx), Parquet; a .toml among them is the
    /// spec.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// The gear spec (TOML); `-` reads standard input.
    #[arg(long, value_name = "SPEC")]
    spec: Option<PathBuf>,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
    #[command(flatten)]
    reading: ReadArgs,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let is_spec = |path: &&PathBuf| target::ending(path) == "toml";
        let named = self.spec.as_ref().or(self.files.iter().find(is_spec));
        let spec = match named {
            Some(path) => self.set.read_spec(path, output)?,
            None => self.set.without_file(output)?,
        };
        let spec = Arc::new(self.reading.laid_out(spec)?);
        let interruption = signals::signals(output);
        let opener =
            Opener { only_shown: true, ..Opener::new(&self.reading, &spec, Model::Exact, interruption.stop()) };
        let (mut readings, mut strangers, mut failed) = (Vec::new(), Vec::new(), Vec::new());
        let (mut notes, mut mapping) = (Vec::new(), Vec::new());
        for path in self.files.iter().filter(|path| !is_spec(path)) {
            match opener.open(path) {
                Ok(opened) => {
                    let lines = part_id(&opened.table.reading).into_iter().chain(opened.table.mapping());
                    // what a contract reads needs no other word
                    let lines = lines.filter(|_| !opened.table.reading.is_by_contract());
                    lines.for_each(|line| add_line(&mut mapping, line, path));
                    notes.extend(opened.notes);
                    strangers.extend(opened.table.strangers.iter().cloned());
                    if opened.table.reading.is_by_contract() {
                        let name = Arc::clone(&opened.table.name);
                        match opened.table.account() {
                            Ok(reading) => readings.push(reading),
                            Err(error) => failed.push(Diagnostic::unreadable(&name, &error)),
                        }
                    } else {
                        readings.push(opened.table.reading);
                    }
                }
                Err(failure) => failed.extend(tables::diagnostics(failure)),
            }
        }
        let report = ReadReport { readings, strangers, notes, mapping };
        output.report(&report, self.format)?;
        failed.extend(refusal(&report.strangers, &[]));
        if failed.is_empty() { Ok(Status::Pass) } else { Err(Diagnostics(failed).into()) }
    }
}

/// The line of `[batch.columns]` that names the parts' column, where its heading is another than the key.
fn part_id(reading: &Reading) -> Option<String> {
    const KEY: &str = "part_id";
    let column = reading.columns.iter().find(|column| column.role == KEY && column.title != KEY)?;
    Some(format!("{KEY} = \"{}\"", column.title.replace('\\', "\\\\").replace('"', "\\\"")))
}

/// Adds a file's line of `[batch.columns]` if it is new; as a comment where its key has a line, for it can have one.
fn add_line(mapping: &mut Vec<String>, line: String, file: &Path) {
    let key = |line: &str| line.split_once(" = ").map(|(key, _)| key.to_owned());
    if mapping.iter().any(|known| known.ends_with(&line)) {
        return;
    }
    let is_taken = mapping.iter().any(|known| key(known) == key(&line));
    mapping.push(if is_taken { format!("# {}: {line}", shown(&target::shown(file))) } else { line });
}

/// How tables would be read.
struct ReadReport {
    readings: Vec<Reading>,
    strangers: Vec<Stranger>,
    notes: Vec<String>,
    /// Lines of `[batch.columns]`, each key once; comments say what files call it otherwise.
    mapping: Vec<String>,
}

impl Report for ReadReport {
    fn json(&self) -> serde_json::Value {
        serde_json::json!({
            "reading": self.readings,
            "not_understood": self.strangers,
            "mapping": self.mapping,
            "notes": remarks(&self.readings, &self.notes),
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let row = |file: &str, title: &str, is: &str, rest: [Option<&str>; 3]| {
            [file, title, is].into_iter().chain(rest.map(Option::unwrap_or_default)).map(str::to_owned).collect()
        };
        let mut rows = vec![row("file", "column", "is", ["unit", "holds", "nominal"].map(Some))];
        for Reading { file, columns, not_used, .. } in &self.readings {
            rows.extend(columns.iter().map(|column| {
                let rest = [column.unit.as_deref(), column.holds, column.nominal.as_deref()];
                row(file, &column.title, &column.role, rest)
            }));
            rows.extend(not_used.iter().map(|column| row(file, &column.title, "not used", [None; 3])));
        }
        let unknown = |of: &Stranger| row(&of.file, &of.title, "not understood", [of.unit.as_deref(), None, None]);
        rows.extend(self.strangers.iter().map(unknown));
        rows
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = reading_blocks(&self.readings, &self.notes);
        let not_understood = Table::of(&self.strangers)
            .text("not understood", |stranger| stranger.title.clone())
            .text("where", |stranger| format!("{}, {}", stranger.file, stranger.place))
            .text("values", |stranger| stranger.values.join(", "))
            .text("near", |stranger| stranger.near.join(", "));
        blocks.extend(not_understood.block_if_any());
        if !self.mapping.is_empty() {
            blocks.push(Block::Title("To say so in a spec".to_owned()));
            blocks.push(Block::Drawing(format!("[batch.columns]\n{}", self.mapping.join("\n"))));
        }
        blocks
    }
}
