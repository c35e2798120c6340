//! `rackmesh sweep`: one command for every design, a row each.

mod until;

use std::path::PathBuf;
use std::time::Instant;

use serde_json::{Value, json};

use super::bar::Bar;
use super::completions::Suggested;
use super::held::{Answer, ColumnTable, Facts};
use super::output::{Failure, Output, Status};
use super::picture::{Picture, PlotArgs, draw};
use super::question::{Of, Question};
use super::results::{self, Column};
use super::rows::RowsFile;
use super::rows_format::{RowsArgs, RowsFormat};
use super::set::{SetArgs, keys};
use super::signals::{self, Interruption};
use super::spec_files::files_read;
use super::target;
use crate::batch::{CellRows, ColumnKind, ColumnSink, ResultCell, ResultColumns, RowFormat, RowSink};
use crate::chance::DEFAULT_SEED;
use crate::design::{Axis, Designs, Trial};
use crate::diagnostic::{Code, Diagnostic};
use crate::parallel;
use crate::report::grouped;
use crate::report::sweep::SweptResult;
use crate::spec::Spec;
use until::Until;

pub(super) const ABOUT: &str = "Try values of keys: what a command says of every design";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh sweep rack.toml --over pair.normal_pressure_angle=18..25:0.5
  rackmesh sweep rack.toml --over pinion.teeth=6,7,8 --over pinion.profile_shift=0..0.5:0.1 --of mesh -- --to 8
  rackmesh sweep rack.toml --over errors.rack_pitch=0..40:1um --until range_upper_mm=0.05
  rackmesh sweep rack.toml --over rack.face_width=18..22 --over pair.normal_module=1.8..2.2 --samples 1000 -o designs.parquet

A row has the keys of the design and what the command answers; --columns takes names, or places in the command's JSON. A
design that is impossible is a row with its reason. Options of the command stand behind `--`.

Exit status: 0 a design has an answer, 1 --until is not reached, 2 no design has an answer, 129, 130 or 143 interrupted.")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: PathBuf,
    /// A key and its values: a range with its step, or a list; may be repeated.
    #[arg(long, required = true, value_name = "KEY=VALUES", value_parser = Suggested(keys), hide_possible_values = true)]
    over: Vec<String>,
    /// The command that is asked.
    #[arg(long, value_enum, default_value_t, value_name = "COMMAND")]
    of: Of,
    /// Try so many designs of a Latin hypercube in place of all combinations.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    samples: Option<u32>,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = DEFAULT_SEED, value_name = "SEED")]
    seed: u64,
    /// Find the values of the one key at which a result is reached: `range_upper_mm=0.05`.
    #[arg(long, value_name = "NAME=VALUE", value_parser = until::parse, conflicts_with = "samples")]
    until: Option<Until>,
    #[command(flatten)]
    rows: RowsArgs,
    /// The columns to write, by name.
    ///
    /// They are results, also by their place in the command's JSON; the first is drawn.
    #[arg(long, value_delimiter = ',', value_name = "NAME,…")]
    columns: Option<Vec<String>>,
    #[command(flatten)]
    plot: PlotArgs,
    #[command(flatten)]
    set: SetArgs,
    /// Threads; one per core unless given.
    #[arg(long, short = 'j', alias = "jobs", value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Options of the command.
    #[arg(last = true, value_name = "OPTIONS")]
    options: Vec<String>,
}

/// A design that was tried.
struct Tried {
    cells: Vec<ResultCell<'static>>,
    drawn: Option<f64>,
    /// Why it has no answer.
    impossible: Option<String>,
    warnings: usize,
}

/// The outcome of all designs.
#[derive(Default)]
struct Tally {
    values: Vec<Option<f64>>,
    impossible: u64,
    /// Why the first one without an answer has none.
    why: Option<String>,
    warnings: u64,
    /// Whether all designs were tried.
    is_complete: bool,
}

impl Tally {
    fn take(&mut self, tried: &Tried) {
        self.values.push(tried.drawn);
        self.impossible += u64::from(tried.impossible.is_some());
        self.warnings += u64::from(tried.warnings > 0);
        if self.why.is_none() {
            self.why.clone_from(&tried.impossible);
        }
    }

    fn take_all(&mut self, tried: &[Tried]) {
        for tried in tried {
            self.take(tried);
        }
    }

    fn designs(&self) -> u64 {
        self.values.len() as u64
    }

    fn in_words(&self) -> String {
        let answered = self.designs() - self.impossible;
        let designs = if self.designs() == 1 { "design" } else { "designs" };
        let mut text = format!("{} {designs}, {} with an answer", grouped(self.designs()), grouped(answered));
        if let Some(why) = &self.why {
            text.push_str(&format!(", {} without; the first: {why}", grouped(self.impossible)));
        }
        if self.warnings > 0 {
            text.push_str(&format!("; {} with warnings", grouped(self.warnings)));
        }
        text
    }
}

/// The files that are written, and how.
struct Begun {
    file: Option<RowsFile>,
    picture: Option<Picture>,
    format: RowsFormat,
    rows_format: RowFormat,
    title: String,
}

/// Designs, and the question about each.
struct Sweep {
    question: Question,
    designs: Designs,
    columns: Vec<Column>,
    drawn: Option<Column>,
    /// With `--until`: the designs that were tried on the way, and the result of each.
    on_the_way: Option<(Designs, Vec<Option<f64>>)>,
    /// The parts of an answer that are needed.
    facts: Facts,
    threads: usize,
    /// Designs that a thread takes at once.
    chunk: usize,
}

impl Sweep {
    fn columns_written(&self) -> Vec<(String, ColumnKind)> {
        let key = |axis: &Axis| {
            let name = if axis.unit.is_empty() { axis.key.clone() } else { format!("{}_{}", axis.key, axis.unit) };
            (name, if axis.is_numeric() { ColumnKind::Number } else { ColumnKind::Text })
        };
        let results = self.columns.iter().map(|column| (column.name.clone(), column.kind));
        self.designs.axes().iter().map(key).chain(results).collect()
    }

    /// Asks about a design; `None` once the run is to stop.
    fn tried(&self, values: &[Trial]) -> Option<Tried> {
        let answer = self.question.answer(&self.designs.settings(values), self.facts)?;
        let key = |value: &Trial| match value.number {
            Some(number) => ResultCell::Number(number),
            None => text(&value.text),
        };
        let (answer, impossible) = match answer {
            Ok(answer) => (answer, None),
            Err(why) => (Answer::default(), Some(why)),
        };
        let reason = || impossible.as_ref().or_else(|| answer.warnings.first().map(|warning| &warning.message));
        let result = |column: &Column| match column.cell(&answer.json) {
            ResultCell::Nothing if column.name == "reason" => reason().map_or(ResultCell::Nothing, |why| text(why)),
            cell => cell,
        };
        let cells = values.iter().map(key).chain(self.columns.iter().map(result)).collect();
        let drawn = self.drawn.as_ref().and_then(|column| column.number(&answer.json));
        Some(Tried { cells, drawn, impossible, warnings: answer.warnings.len() })
    }

    /// Tries every design on all cores, and hands the rows over in order; returns whether all were tried.
    fn each(
        &self,
        interruption: &Interruption,
        output: &Output,
        mut take: impl FnMut(Vec<Tried>) -> Result<(), Failure>,
    ) -> Result<bool, Failure> {
        let (count, mut done, mut bar) = (self.designs.count(), 0, Bar::new(output));
        let chunk = |number: u64| -> Vec<Tried> {
            // below the number of designs
            let first = number as usize * self.chunk;
            let designs = first..count.min(first + self.chunk);
            designs.map_while(|design| self.tried(&self.designs.values(design))).collect()
        };
        let chunks = count.div_ceil(self.chunk) as u64;
        let ended = parallel::in_order(self.threads, chunks, chunk, |rows: Vec<Tried>| {
            done += rows.len();
            take(rows).map_err(Some)?;
            bar.show(Some(done as f64 / count as f64), || format!("{} designs", grouped(done as u64)));
            if done < count && interruption.came() { Err(None) } else { Ok(()) }
        });
        bar.finish();
        match ended {
            Err(Some(failure)) => Err(failure),
            _ => Ok(done == count),
        }
    }
}

fn text(text: &str) -> ResultCell<'static> {
    ResultCell::Text(text.to_owned().into_bytes().into())
}

/// Rows that a program holds.
#[derive(Default)]
struct Collected(ResultColumns);

impl ColumnSink for Collected {
    fn take(&mut self, rows: ResultColumns) -> std::io::Result<()> {
        self.0.append(rows);
        Ok(())
    }
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = self.set.read_spec(&self.spec, output)?;
        let interruption = signals::interrupted(output);
        let question = Question::new(self.of, &self.options, (&self.spec, &spec), interruption.stop())?;
        let designs = self.designs()?;
        for (over, setting) in self.over.iter().zip(designs.settings(&designs.values(0))) {
            question.refuse_unknown_key(over, &[setting])?;
        }
        if self.plot.path().is_some() && designs.count() < 2 {
            return Err(undrawn().into());
        }
        let begun = self.begin(&spec, output)?;
        let ended = || interruption.status().unwrap_or(Status::Undecided);
        let Some(mut sweep) = self.sweep(question, designs, begun.format)? else { return Ok(ended()) };
        let Some(found) = self.reached(&mut sweep, &interruption, output)? else { return Ok(ended()) };
        let tally = self.rows(&sweep, begun, &interruption, output)?;
        if !tally.is_complete {
            return Ok(ended());
        }
        let is_answered = tally.impossible < tally.designs() || self.until.is_some();
        Ok(if is_answered { found } else { Status::Undecided })
    }

    /// Begins the files that are written.
    fn begin(&self, spec: &Spec, output: &Output) -> Result<Begun, Failure> {
        let inputs = files_read(spec, &self.spec);
        let (format, rows_format, _) = self.rows.formats(false, output.screen())?;
        let path = self.rows.output.as_deref();
        target::refuse_same(&[path, self.plot.path()].into_iter().flatten().collect::<Vec<_>>())?;
        let title = spec.title.clone().unwrap_or_else(|| format!("{} over designs", self.of.name()));
        let named = (title.as_str(), &spec.limits());
        let shown = (format, output.screen(), false);
        // a program takes the rows as they are
        let is_held = output.stop().is_some();
        let file = (!is_held).then(|| RowsFile::begin(path, &inputs, named, shown)).transpose()?;
        let rows_format = if is_held { RowFormat::Columns } else { rows_format };
        Ok(Begun { picture: self.plot.picture(&inputs)?, file, format, rows_format, title })
    }

    /// Writes the row of every design, and the picture.
    fn rows(
        &self,
        sweep: &Sweep,
        mut begun: Begun,
        interruption: &Interruption,
        output: &mut Output,
    ) -> Result<Tally, Failure> {
        let (mut collected, mut tally) = (Collected::default(), Tally::default());
        let mut rows = CellRows::new(&sweep.columns_written(), begun.rows_format);
        tally.is_complete = {
            let mut sink = match &mut begun.file {
                Some(file) => file.sink(begun.rows_format, || sweep.columns_written())?,
                None => RowSink::Columns(&mut collected),
            };
            sweep.each(interruption, output, |tried| {
                tally.take_all(&tried);
                Ok(rows.write(tried.into_iter().map(|tried| tried.cells), &mut sink)?)
            })?
        };
        let note = tally.in_words();
        let file = begun.file.take();
        let is_written = file.map_or(Ok(true), |file| {
            file.finish(tally.is_complete, std::slice::from_ref(&note), interruption, output)
        })?;
        tally.is_complete &= is_written;
        output.facts(json!({ "designs": tally.designs(), "impossible": tally.impossible }), || ColumnTable {
            columns: sweep.columns_written(),
            results: collected.0,
        });
        self.draw(sweep, begun, &tally, output)?;
        output.remark(&note);
        Ok(tally)
    }

    /// Draws the chosen result of the designs.
    fn draw(&self, sweep: &Sweep, begun: Begun, tally: &Tally, output: &mut Output) -> Result<(), Failure> {
        let column = sweep.drawn.as_ref();
        let (designs, values) = match &sweep.on_the_way {
            Some((designs, values)) => (designs, values),
            None => (&sweep.designs, &tally.values),
        };
        let is_enough = values.iter().flatten().nth(1).is_some();
        let swept = column.filter(|_| is_enough).map(|column| SweptResult { designs, name: &column.name, values });
        match (begun.picture, swept.as_ref().and_then(|swept| swept.chart(&begun.title))) {
            (Some(picture), None) if !tally.is_complete => picture.discard(output),
            (Some(_), None) => return Err(undrawn().into()),
            (picture, Some(chart)) => draw(picture, || chart.clone(), tally.is_complete, output)?,
            (None, None) => {}
        }
        let is_shown = begun.format == RowsFormat::Table && self.rows.output.is_none();
        let sketch = swept.filter(|_| is_shown).and_then(|swept| swept.sketch(output.screen()));
        sketch.map_or(Ok(()), |sketch| output.text(&sketch))
    }

    /// Every design.
    fn designs(&self) -> Result<Designs, Failure> {
        /// Parts of a range without a step in which a result is sought.
        const STEPS: u32 = 16;
        let axes = self.over.iter().map(|over| Axis::parse(over, is_whole)).collect::<Result<Vec<_>, _>>();
        let mut axes = axes.map_err(Diagnostic::with_code(Code::Usage))?;
        let repeated =
            axes.iter().enumerate().find(|(index, axis)| axes[..*index].iter().any(|other| other.key == axis.key));
        if let Some((_, axis)) = repeated {
            return Err(Diagnostic::usage(format!("--over names `{}` twice", axis.key)).into());
        }
        if self.until.is_some() {
            let [axis] = &axes[..] else {
                let message = "--until finds the value of one key, and --over names several";
                return Err(Diagnostic::usage(message).help("set the others with --set").into());
            };
            if axis.ends().is_none() {
                let message = format!("--until needs a range of `{}`", axis.key);
                return Err(Diagnostic::usage(message).help("write it as FROM..TO").into());
            }
            axes = axes.into_iter().map(|axis| axis.in_steps(STEPS)).collect();
        }
        Ok(match self.samples {
            Some(samples) => Designs::latin_hypercube(axes, samples, self.seed),
            None => Designs::grid(axes).map_err(Diagnostic::with_code(Code::Usage))?,
        })
    }

    /// The sweep, with the columns of the first design that has an answer; `None` once the run is to stop.
    fn sweep(&self, question: Question, designs: Designs, format: RowsFormat) -> Result<Option<Sweep>, Failure> {
        /// Designs that are tried for a first answer.
        const MOST_TRIED: usize = 4096;
        /// What a thread takes at once takes so long, about, s.
        const AT_ONCE: f64 = 0.005;
        const MOST_AT_ONCE: f64 = 256.0;
        let (mut first, mut seconds) = (Value::Null, AT_ONCE);
        for design in 0..designs.count().min(MOST_TRIED) {
            let begun = Instant::now();
            let design = designs.settings(&designs.values(design));
            let Some(answer) = question.answer(&design, Facts::All) else { return Ok(None) };
            seconds = begun.elapsed().as_secs_f64();
            if let Ok(answer) = answer {
                first = answer.json;
                break;
            }
        }
        let asked = self.columns.as_deref();
        // names can be checked only against an answer
        let columns = match asked {
            Some(asked) if first.is_null() => asked.iter().map(|name| results::unchecked(self.of, name)).collect(),
            _ => results::written(self.of, asked, format.is_for_people(), &first)?,
        };
        let drawn = match &self.until {
            Some(until) if !first.is_null() => Some(results::named(self.of, &until.name, &first)?),
            _ => results::drawn(self.of, asked, &columns).cloned(),
        };
        let threads = self.threads.map_or_else(parallel::cores, usize::from);
        let chunk = (AT_ONCE / seconds.max(1e-9)).clamp(1.0, MOST_AT_ONCE) as usize;
        let are_all = |is: fn(&Column) -> bool| columns.iter().chain(&drawn).all(is);
        let facts = if are_all(Column::needs_no_verdict) {
            Facts::Unjudged
        } else if are_all(|column| !column.is_elsewhere) {
            Facts::Brief
        } else {
            Facts::All
        };
        Ok(Some(Sweep { question, designs, columns, drawn, on_the_way: None, facts, threads, chunk }))
    }

    /// Finds where a result is reached, and keeps only these designs; `None` once the run is to stop.
    fn reached(
        &self,
        sweep: &mut Sweep,
        interruption: &Interruption,
        output: &mut Output,
    ) -> Result<Option<Status>, Failure> {
        let Some(until) = &self.until else { return Ok(Some(Status::Pass)) };
        let mut tally = Tally::default();
        let is_complete = sweep.each(interruption, output, |tried| {
            tally.take_all(&tried);
            Ok(())
        })?;
        let axis = sweep.designs.axes()[0].clone();
        let number = |design| sweep.designs.values(design)[0].number.unwrap_or_default();
        let off = tally.values.iter().enumerate();
        let off: Vec<_> = off.map(|(design, value)| (number(design), value.map(|value| value - until.value))).collect();
        let off_at = |at: f64| Some(sweep.tried(&[axis.at(at)])?.drawn? - until.value);
        let found = until::crossings(&off, (!is_whole(&axis.key)).then_some(&off_at));
        if !is_complete || interruption.came() {
            output.message(signals::NOTHING_YET);
            return Ok(None);
        }
        for crossing in &found {
            output.remark(&until.in_words(&axis, crossing));
        }
        if found.is_empty() {
            output.diagnostic(&until.never_reached(&self.over[0], &tally));
        }
        let status = if found.is_empty() { Status::Fail } else { Status::Pass };
        let at = found.iter().map(|crossing| axis.at(crossing.at).number.unwrap_or_default()).collect();
        let tried = std::mem::replace(&mut sweep.designs, Designs::of_numbers(axis, at));
        sweep.on_the_way = Some((tried, tally.values));
        Ok(Some(status))
    }
}

/// Whether a key holds a whole number.
fn is_whole(key: &str) -> bool {
    crate::spec::keys().iter().any(|known| known.path == key && known.is_whole)
}

fn undrawn() -> Diagnostic {
    let message = "there is nothing to draw: a picture shows a result with numbers, of two designs or more, over one or two keys with numbers";
    Diagnostic::usage(message).help("name the result with --columns, or leave --plot out")
}
