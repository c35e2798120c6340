//! `rackmesh read`: the cells of tables with their owners, and the contract that closes them, which it can write into a spec.
//! Evaluates nothing.

use std::io::{self, IsTerminal as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::output::{Failure, Output, Status};
use super::set::{self, SetArgs};
use super::tables::{self, Accepted, Opener, ReadArgs};
use super::target::{self, is_dash};
use super::{signals, stream, terminal, written};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::Model;
use crate::report::{self, Block, Column, Format, Report, Table, reading_form, remarks};
use crate::table::{ColumnAccount, ColumnReading, Guesses, Proposal, Reading};

pub(super) const ABOUT: &str = "Show what tables hold, and write the contract that closes them";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh read parts.csv
  rackmesh read lot.csv rack.toml --write
  rackmesh read lot.csv rack.toml --write --yes --accept rack_pitch=CHR_017
  rackmesh read --check lot.csv rack.toml
  rackmesh read lot.xlsx --sheet 'Lot 7' --format json

Exit status: 0 every cell has an owner, 2 some have none, or a file cannot be read.")]
pub(super) struct Args {
    /// Tables: text, Excel workbooks (.xlsx), Q-DAS files (.dfq, .dfd with .dfx), Parquet; a .toml among them is the
    /// spec.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// The gear spec (TOML); `-` reads standard input.
    #[arg(long, value_name = "SPEC")]
    spec: Option<PathBuf>,
    /// Write the contract that closes the tables into the spec or the layout, once a question is answered.
    #[arg(long, conflicts_with = "check")]
    write: bool,
    /// Ask nothing, and write what is exact; guesses stand there as comments.
    #[arg(long, requires = "write")]
    yes: bool,
    /// A column that has a role: `rack_pitch=CHR_017`; may be repeated.
    #[arg(long, value_name = "ROLE=COLUMN", value_parser = accepted)]
    accept: Vec<Accepted>,
    /// Compare the tables with the contract of the spec, and nothing else.
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
    #[command(flatten)]
    reading: ReadArgs,
}

fn accepted(text: &str) -> Result<Accepted, String> {
    let (key, column) = text.split_once('=').ok_or("write ROLE=COLUMN, such as rack_pitch=CHR_017")?;
    Ok(Accepted { key: key.trim().to_owned(), column: column.trim().to_owned() })
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
        let files: Vec<&PathBuf> = self.files.iter().filter(|path| !is_spec(path)).collect();
        let interruption = signals::signals(output);
        let stdin = files.iter().any(is_dash).then(|| stream::whole(interruption.stop())).transpose()?;
        let opener = Opener::new(&self.reading, &spec, Model::Exact, interruption.stop());
        let opener = Opener { stdin, curves: true, ..opener };
        if self.check {
            return self.check(&opener, &files, output);
        }
        let (mut proposals, mut failed) = (Vec::new(), Vec::new());
        for path in &files {
            match opener.proposal(path, &self.accept) {
                Ok(proposal) => proposals.push(proposal),
                Err(failure) => failed.extend(tables::diagnostics(failure)),
            }
        }
        let mut is_taken =
            |one: &&Accepted| proposals.iter_mut().any(|proposal| proposal.accept(&one.key, &one.column));
        if let Some(Accepted { key, column }) = self.accept.iter().find(|one| !is_taken(one)) {
            let message = format!("--accept {key}={column}: nothing is proposed like that");
            return Err(Diagnostic::usage(message)
                .help(format!("--column '{key}={column}' says it of any column"))
                .into());
        }
        let all = Proposal::joined(&proposals);
        let guesses = if self.yes { Guesses::AsComments } else { Guesses::Shown };
        let block = all.block(guesses);
        let shown = if all.count() > 0 { &*block } else { "" };
        let report = ReadReport { proposals: &proposals, block: shown };
        output.report(&report, self.format)?;
        if !failed.is_empty() {
            return Err(Diagnostics(failed).into());
        }
        if self.write {
            let Some(path) = self.reading.layout_file().or(named) else {
                return Err(Diagnostic::usage("--write writes into a spec or a layout, and none is given").into());
            };
            return self.write(path, &block, (&opener, &files), output);
        }
        let is_closed = proposals.iter().all(Proposal::is_closed);
        if !is_closed && all.count() > 0 {
            let file = if self.reading.layout_file().is_some() { "layout" } else { "spec" };
            output.remark(&format!("note: `--write` writes this [table] into the {file}"));
        }
        Ok(if is_closed { Status::Pass } else { Status::Undecided })
    }

    /// Writes the contract into the spec or the layout, if that is wanted; returns whether the tables are then closed.
    fn write(
        &self,
        path: &Path,
        block: &str,
        (opener, files): (&Opener<'_>, &[&PathBuf]),
        output: &mut Output,
    ) -> Result<Status, Failure> {
        let name = stream::name(path);
        if is_dash(path) {
            return Err(Diagnostic::usage("--write writes into a file, and this is standard input").into());
        }
        let is_closed = |text: &str| -> Result<Status, Failure> {
            let spec = opener.spec.with_contract(text)?;
            let mut closed = true;
            for file in files {
                closed &= opener.proposed(file, &spec)?.is_closed();
            }
            Ok(if closed { Status::Pass } else { Status::Undecided })
        };
        let old = set::text(path)?;
        let new = written::merged(&name, &old, block, &written::stamp())?;
        if new == old {
            output.remark(&format!("{name}: nothing to write"));
            return is_closed(&old);
        }
        if !self.yes {
            if !io::stdin().is_terminal() {
                let message = "--write asks on a terminal, and there is none";
                return Err(Diagnostic::usage(message).help("--yes asks nothing, and writes what is exact").into());
            }
            let answer = terminal::ask(&format!("write this [table] into {name}?"), &["y", "n"], &mut None, output)?;
            if answer.as_deref() != Some("y") {
                return Ok(Status::Undecided);
            }
        }
        // what cannot be read is not written
        let status = is_closed(&new)?;
        target::write(path, files, new.as_bytes())?;
        if status != Status::Pass {
            output.remark(&written::not_all(&name));
        }
        Ok(status)
    }

    /// Compares files with the contract.
    fn check(&self, opener: &Opener<'_>, files: &[&PathBuf], output: &mut Output) -> Result<Status, Failure> {
        if opener.spec.table.place.is_none() && opener.spec.table.source.is_none() {
            let message = "--check compares tables with the [table] of a spec, and there is none";
            return Err(Diagnostic::usage(message).help("`rackmesh read FILE SPEC --write` writes one").into());
        }
        let mut failed = Vec::new();
        for path in files {
            match opener.proposal(path, &self.accept) {
                Ok(proposal) if proposal.is_closed() => {}
                Ok(proposal) => {
                    let message = format!("{}: {}", proposal.file, proposal.difference().join("; "));
                    failed.push(Diagnostic::error(Code::NotUnderstood, message));
                }
                Err(failure) => failed.extend(tables::diagnostics(failure)),
            }
        }
        if failed.is_empty() {
            output.remark("every cell has an owner by the contract");
            return Ok(Status::Pass);
        }
        Err(Diagnostics(failed).into())
    }
}

/// Shows the columns of a table besides the result.
pub(super) fn show(proposal: &Proposal, block: &str, output: &mut Output) -> Result<(), Failure> {
    let proposals = std::slice::from_ref(proposal);
    let shown = ReadReport { proposals, block };
    let text = report::write(&shown, Format::Table, output.screen_of_messages())?;
    output.lines(text.trim_end());
    Ok(())
}

/// Lines that are shown of a table.
const SHOWN: usize = 100;

/// What tables hold.
struct ReadReport<'a> {
    proposals: &'a [Proposal],
    /// The `[table]` that closes them.
    block: &'a str,
}

impl ReadReport<'_> {
    fn readings(&self) -> Vec<Reading> {
        self.proposals.iter().filter_map(|proposal| proposal.reading.clone()).collect()
    }
}

/// How a column is read, if it is read.
fn read_as<'p>(proposal: &'p Proposal, column: &ColumnAccount) -> Option<&'p ColumnReading> {
    let columns = proposal.reading.as_ref()?.columns.iter();
    columns.into_iter().find(|read| read.title == column.title && read.holds.is_some())
}

impl Report for ReadReport<'_> {
    fn json(&self) -> serde_json::Value {
        let not_owned = self.proposals.iter().flat_map(|proposal| {
            let columns = proposal.columns.iter().filter(|column| column.is == "not owned").map(|column| {
                serde_json::json!({
                    "file": proposal.file, "title": column.title,
                    "place": column.place.map_or_else(|| "characteristic".to_owned(), |place| format!("column {place}")),
                    "values": column.first,
                })
            });
            let lines = proposal.lines.iter().map(
                |line| serde_json::json!({ "file": proposal.file, "title": line.text, "place": line.place, "values": [] }),
            );
            let obstacles = proposal.obstacles().map(
                |what| serde_json::json!({ "file": proposal.file, "title": what, "place": "", "values": [] }),
            );
            columns.chain(lines).chain(obstacles)
        });
        let account = self.proposals.iter().map(|proposal| {
            serde_json::json!({
                "file": proposal.file, "columns": proposal.columns, "lines": proposal.lines,
                "parts": proposal.parts, "rejected": proposal.rejected,
            })
        });
        let readings = self.readings();
        serde_json::json!({
            "reading": readings,
            "account": account.collect::<Vec<_>>(),
            "not_understood": not_owned.collect::<Vec<_>>(),
            "mapping": self.block.split_once("[table.columns]\n").map_or("", |(_, columns)| columns).lines().collect::<Vec<_>>(),
            "table": self.block,
            "notes": remarks(&readings, &[]),
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let head = ["file", "column", "is", "unit", "holds", "nominal", "why"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        for proposal in self.proposals {
            rows.extend(proposal.columns.iter().map(|column| {
                let [unit, holds, nominal] = cells(proposal, column);
                [&proposal.file, &column.title, &column.is, &unit, &holds, &nominal, &column.why]
                    .map(Clone::clone)
                    .to_vec()
            }));
        }
        rows
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = Vec::new();
        for proposal in self.proposals {
            match &proposal.reading {
                Some(reading) => blocks.push(reading_form(reading)),
                None => blocks.push(Block::Title(proposal.file.clone())),
            }
            let each = proposal.columns.iter().map(|column| (column, cells(proposal, column)));
            let columns = Table::of(each)
                .text("column", |(column, _)| column.title.clone())
                .text("is", |(column, _)| column.is.clone())
                .text("unit", |(_, [unit, ..])| unit.clone())
                .text("holds", |(_, [_, holds, _])| holds.clone())
                .text("nominal", |(_, [.., nominal])| nominal.clone())
                .column_if(true, Column::text("says who").unless_narrow(), |(column, _)| column.why.clone())
                .text("first", |(column, _)| column.first.join(", "));
            blocks.extend(columns.block_if_any());
            let lines = Table::of(proposal.lines.iter().take(SHOWN))
                .text("line", |line| line.place.clone())
                .text("text", |line| line.text.clone())
                .text("is", |line| line.is.to_owned());
            blocks.extend(lines.block_if_any());
            let more = proposal.lines.len().saturating_sub(SHOWN) + proposal.more;
            blocks.extend((more > 0).then(|| Block::Remark(format!("and {more} more like these"))));
            let rejected = proposal.rejected.iter().map(|problem| format!("rejected: {problem}"));
            blocks.extend(proposal.obstacles().chain(rejected).map(Block::Remark));
        }
        blocks.extend(remarks(&self.readings(), &[]).into_iter().map(Block::Remark));
        if !self.block.is_empty() {
            let is_closed = self.proposals.iter().all(Proposal::is_closed);
            let title = if is_closed { "As a contract" } else { "What closes it, in the spec" };
            blocks.push(Block::Title(title.to_owned()));
            blocks.push(Block::Drawing(self.block.trim_end().to_owned()));
        }
        blocks
    }
}

/// The unit of a column, what it holds, and its nominal value.
fn cells(proposal: &Proposal, column: &ColumnAccount) -> [String; 3] {
    let read = read_as(proposal, column);
    let unit = read.and_then(|read| read.unit.clone()).or_else(|| column.unit.clone());
    let holds = read.and_then(|read| read.holds).map(str::to_owned);
    [unit, holds, read.and_then(|read| read.nominal.clone())].map(Option::unwrap_or_default)
}
