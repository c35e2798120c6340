//! Columns in the memory of a program, some rows at a time: the batch for data frames and query engines. Each piece is read by
//! the rules for any table and evaluated like the blocks of any table.

use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

use super::columns::{ColumnKind, ResultColumns};
use super::evaluate::Evaluator;
use super::layout::Layout;
use super::number::Decimals;
use super::outcome::Counts;
use super::plan::Plan;
use super::request::{Request, RowFormat, Rows};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::parallel::lock;
use crate::spec::Spec;
use crate::table::{Block, Layout as TableLayout, Pattern, ROWS_TOGETHER, Reading, Stored, Table, Want, stored_table};

/// Bytes of text in a column of results, at most.
const MOST_TEXT: usize = i32::MAX as usize;
/// Bytes of memory that are kept for further results, at most.
const MOST_SPARE: usize = 128 << 20;

/// Evaluates columns that a program has in memory.
///
/// # Example
/// ```
/// use std::sync::Arc;
/// use rackmesh::batch::{ColumnEvaluator, ColumnPiece, Request, ResultValues};
/// use rackmesh::spec::Spec;
/// use rackmesh::table::Stored;
///
/// let spec = "[errors]\nrack_over_roller = { nominal = 25.0 }\n[limits]\ncenter_distance = \"±0.02\"";
/// let spec = Arc::new(Spec::parse("rack.toml", spec)?);
/// let evaluator = ColumnEvaluator::new(&spec, &[], Request::default());
/// let titles = ["rack_over_roller".to_owned()];
/// let columns = [Some(Stored::doubles(&[25.0131, f64::NAN, 25.0201][..]))];
/// let evaluated = evaluator.evaluate(&ColumnPiece { name: "lot", before: 0, titles: &titles, columns: &columns })?;
/// assert_eq!(evaluated.results.rows, 3);
/// assert_eq!((evaluated.counts.pass, evaluated.counts.fail, evaluated.counts.rejected), (1, 1, 1));
/// let at = evaluated.columns.iter().position(|(name, _)| name == "range_upper_mm").expect("it is written");
/// let ResultValues::Numbers(upper) = &evaluated.results.columns[at].values else { panic!("it is a number") };
/// assert_eq!((upper[0], upper[2]), (0.0131, 0.0201));
/// # Ok::<(), rackmesh::diagnostic::Diagnostics>(())
/// ```
#[derive(Debug)]
pub struct ColumnEvaluator {
    spec: Arc<Spec>,
    want: Want,
    request: Request,
    /// The plan of the last piece, for the next piece with the same columns.
    last: Mutex<Option<Arc<Plan>>>,
    /// Results that nobody needs any more, for the memory of the next ones.
    spare: Mutex<Vec<ResultColumns>>,
}

/// Some rows of a table.
#[derive(Debug, Clone, Copy)]
pub struct ColumnPiece<'a> {
    /// What messages call the table.
    pub name: &'a str,
    /// Rows of the table before these. They count where a part is called by the number of its row.
    pub before: u64,
    /// The names of its columns.
    pub titles: &'a [String],
    /// Its columns; `None` for a column whose type holds no measurement, such as a list.
    pub columns: &'a [Option<Stored<'a>>],
}

/// The results of some rows.
#[derive(Debug)]
pub struct EvaluatedColumns {
    /// The names of the columns, and what they hold.
    pub columns: Vec<(String, ColumnKind)>,
    /// As many rows as were given, in their order.
    pub results: ResultColumns,
    /// How many pass, fail, are rejected.
    pub counts: Counts,
    /// How the columns were read.
    pub reading: Reading,
}

impl ColumnEvaluator {
    /// An evaluator for a spec, without the columns whose names fit these patterns (`*` for any characters). The request's format
    /// and choice of rows do not count: there is a row for each row, with full decimals.
    #[must_use]
    pub fn new(spec: &Arc<Spec>, ignored: &[String], request: Request) -> Self {
        let mut want = spec.want();
        let mut layout = TableLayout::clone(&want.layout);
        layout.ignore.extend(ignored.iter().map(|pattern| Pattern::of_heading(pattern)));
        want.layout = Arc::new(layout);
        want.teeth = Some(false);
        let (format, rows, decimals) = (RowFormat::Columns, Rows::Every, Decimals::Full);
        let request = Request {
            format,
            rows,
            decimals,
            statistics: false,
            lists_parts: false,
            problems_kept: 0,
            failures_kept: 0,
            ..request
        };
        Self { spec: Arc::clone(spec), want, request, last: Mutex::default(), spare: Mutex::default() }
    }

    /// The columns that [`evaluate`](Self::evaluate) gives for such a piece; a few rows or none are enough.
    ///
    /// # Errors
    /// As there.
    pub fn columns(&self, piece: &ColumnPiece<'_>) -> Result<Vec<(String, ColumnKind)>, Diagnostics> {
        Ok(self.planned(&self.understood(piece)?)?.0.columns_written())
    }

    /// Evaluates some rows, independently of others. For a row that is no part, or has no result, the column `reason` says why.
    ///
    /// # Errors
    /// [`Diagnostics`] if the columns are refused, as those of any table are: what they hold is not understood, or may be a
    /// measurement that nobody named, or lacks its unit or nominal value.
    pub fn evaluate(&self, piece: &ColumnPiece<'_>) -> Result<EvaluatedColumns, Diagnostics> {
        self.evaluate_while(piece, || true)
    }

    /// As [`evaluate`](Self::evaluate), until `goes_on` is false: it is asked before every few thousand rows, and those behind
    /// are left out.
    ///
    /// # Errors
    /// As there.
    pub fn evaluate_while(
        &self,
        piece: &ColumnPiece<'_>,
        mut goes_on: impl FnMut() -> bool,
    ) -> Result<EvaluatedColumns, Diagnostics> {
        let table = self.understood(piece)?;
        let (plan, layout) = self.planned(&table)?;
        let Table { name, pieces, mut reading, .. } = table;
        let (reader, _) = pieces.open(layout.wanted(false));
        let never = AtomicBool::new(false);
        let mut evaluator = Evaluator::new(&plan, &layout, &name, false, &never);
        let rows = piece.columns.iter().flatten().map(Stored::rows).max().unwrap_or(0);
        let spare = lock(&self.spare).pop().unwrap_or_default();
        evaluator.written.columns = spare.emptied(plan.column_kinds(), rows);
        let (mut block, mut counts) = (Block::default(), Counts::default());
        for start in (0..rows).step_by(ROWS_TOGETHER).take_while(|_| goes_on()) {
            let rows = start..rows.min(start + ROWS_TOGETHER);
            let columns: Vec<_> =
                piece.columns.iter().map(|column| Some(column.as_ref()?.slice(rows.clone()))).collect();
            let before = piece.before + start as u64;
            reader.stored(&columns, before, &mut block);
            evaluator.block(&block, before, false);
            if let Some(contradiction) = &block.contradiction {
                let message = format!("{}, row {}: {}", piece.name, contradiction.line, contradiction.message);
                return Err(Diagnostic::error(Code::BadTable, message).help(contradiction.help).into());
            }
            if evaluator.written.columns.columns.iter().any(|column| column.text_bytes() > MOST_TEXT) {
                let message = format!("{} has more than 2 GiB of text in a column of results", piece.name);
                return Err(Diagnostic::error(Code::BadTable, message).help("evaluate fewer rows at a time").into());
            }
            block.tell(&mut reading);
            counts.add(&evaluator.tally.counts);
        }
        Ok(EvaluatedColumns { columns: plan.columns_written(), results: evaluator.written.columns, counts, reading })
    }

    /// Takes results that nobody needs any more: the next ones get their memory. Up to 128 MiB are kept.
    pub fn take_back(&self, results: ResultColumns) {
        let mut spare = lock(&self.spare);
        if spare.iter().chain([&results]).map(ResultColumns::room_bytes).sum::<usize>() <= MOST_SPARE {
            spare.push(results);
        }
    }

    fn understood(&self, piece: &ColumnPiece<'_>) -> Result<Table, Diagnostics> {
        // where no row has a number, the name and type of a column decide
        let stand_ins: Vec<_> = piece.columns.iter().map(|column| column.as_ref().map(Stored::stand_in)).collect();
        // of texts each may have to be looked at
        let (texts, others): (Vec<_>, Vec<_>) = piece.columns.iter().flatten().partition(|column| column.is_text());
        let has_numbers = others.into_iter().chain(texts).any(Stored::has_numbers);
        let head = if has_numbers { piece.columns } else { &stand_ins };
        let found = stored_table(piece.name, "columns", piece.titles, head, &self.want)?;
        if found.reading.parts_in != "rows" {
            let message = format!("{} has no row per part, as columns in memory have", piece.name);
            return Err(Diagnostic::error(Code::BadTable, message).help("make a column of each error").into());
        }
        Ok(found)
    }

    /// The plan for a table: the last one, if it fits.
    fn planned(&self, table: &Table) -> Result<(Arc<Plan>, Layout), Diagnostics> {
        let mut last = lock(&self.last);
        let fits = |plan: &Arc<Plan>| Some((Arc::clone(plan), Layout::new(plan, table).ok()?));
        if let Some(known) = last.as_ref().filter(|plan| plan.is_for(table)).and_then(fits) {
            return Ok(known);
        }
        let plan = Arc::new(Plan::new(&self.spec, table, self.request.clone())?);
        let layout = Layout::new(&plan, table)?;
        *last = Some(Arc::clone(&plan));
        Ok((plan, layout))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::ResultValues;

    const SPEC: &str = "[errors]\nrack_over_roller = { nominal = 25.0 }\nrack_pitch = \"0 um\"\n[pair]\nnormal_pressure_angle = 20\n\
                        [limits]\ncenter_distance = \"±0.05\"";

    fn evaluator(spec: &str) -> ColumnEvaluator {
        ColumnEvaluator::new(&Arc::new(Spec::parse("rack.toml", spec).unwrap()), &[], Request::default())
    }

    fn evaluate(evaluator: &ColumnEvaluator, columns: &[(&str, Stored<'_>)]) -> Result<EvaluatedColumns, Diagnostics> {
        let titles: Vec<String> = columns.iter().map(|(title, _)| (*title).to_owned()).collect();
        let columns: Vec<_> = columns.iter().map(|(_, column)| Some(column.clone())).collect();
        evaluator.evaluate(&ColumnPiece { name: "lot", before: 0, titles: &titles, columns: &columns })
    }

    fn texts(of: &str, all: &EvaluatedColumns) -> Vec<Option<String>> {
        let at = all.columns.iter().position(|(name, _)| name == of).unwrap();
        let text = |text: &[u8]| String::from_utf8(text.to_vec()).unwrap();
        (0..all.results.rows).map(|row| all.results.columns[at].text(row).map(text)).collect()
    }

    fn names(names: &[&str]) -> Stored<'static> {
        let ends = std::iter::once(0).chain(names.iter().scan(0, |end, name| {
            *end += name.len();
            Some(*end)
        }));
        Stored::texts(names.concat().into_bytes(), ends.collect())
    }

    /// A row for each row, in their order, whatever it is: a part, a mean, nothing, a value that is none.
    #[test]
    fn every_row_has_an_answer_or_a_reason() {
        let all = evaluate(
            &evaluator(SPEC),
            &[
                ("part_id", names(&["mean", "P1", "", "P2", "P3", "P4", "Mittelwert"])),
                (
                    "rack_over_roller",
                    Stored::doubles(&[25.01, 25.01, 0.0, 25.06, f64::NAN, 25.02, 25.01][..])
                        .with_values_where(&[true, true, false, true, true, true, true][..]),
                ),
                (
                    "rack_pitch",
                    Stored::integers(&[1, 1, 0, 1, 1, 0, 0][..], 3)
                        .with_values_where(&[true, true, false, true, true, false, true][..]),
                ),
            ],
        )
        .unwrap();
        assert_eq!(all.results.rows, 7);
        let verdicts = texts("verdict", &all);
        let expected = [None, Some("pass"), None, Some("fail"), None, None, None];
        assert_eq!(verdicts, expected.map(|verdict| verdict.map(str::to_owned)));
        let reasons = texts("reason", &all);
        for (row, reason) in [
            (0, "`mean` is no part's name"),
            (2, "the part has no name"),
            (4, "`no finite number` is not a number"),
            (5, "there is no value for rack pitch"),
            (6, "`Mittelwert` is no part's name"),
        ] {
            assert!(reasons[row].as_deref().is_some_and(|text| text.starts_with(reason)), "{row}: {:?}", reasons[row]);
        }
        let above = "ΔCD (worst case) is 0.0114 mm above the limit 0.05 mm".to_owned();
        assert_eq!((&reasons[1], &reasons[3]), (&None, &Some(above)));
        assert_eq!((all.counts.pass, all.counts.fail, all.counts.rejected), (1, 1, 5));
    }

    /// Blocks do not show: rows are counted through all of them, from those before the piece on; the end comes between two blocks.
    #[test]
    fn parts_without_names_are_counted_through_all_blocks() {
        let evaluator = evaluator(SPEC);
        let mut doubles = vec![25.01; 2 * ROWS_TOGETHER + 3];
        doubles[ROWS_TOGETHER + 1] = f64::NAN;
        let columns = ["rack_over_roller", "rack_pitch"].map(|title| {
            let values = if title == "rack_pitch" { vec![0.01; doubles.len()] } else { doubles.clone() };
            (title.to_owned(), Some(Stored::doubles(values)))
        });
        let (titles, columns): (Vec<_>, Vec<_>) = columns.into_iter().unzip();
        let piece = ColumnPiece { name: "lot", before: 10, titles: &titles, columns: &columns };
        let all = evaluator.evaluate(&piece).unwrap();
        let ids: Vec<_> = (11..).take(doubles.len()).map(|number: usize| Some(number.to_string())).collect();
        assert_eq!(texts("part_id", &all), ids);
        let reasons = texts("reason", &all);
        assert_eq!(reasons.iter().position(Option::is_some), Some(ROWS_TOGETHER + 1));
        assert_eq!((all.counts.rows, all.counts.rejected), (doubles.len() as u64, 1));
        let mut blocks = 0..2;
        let begun = evaluator.evaluate_while(&piece, || blocks.next().is_some()).unwrap();
        assert_eq!(begun.results.rows, 2 * ROWS_TOGETHER);
    }

    /// Results in the memory of others are those in new memory.
    #[test]
    fn results_that_are_taken_back_leave_their_memory_only() {
        let evaluator = evaluator(SPEC);
        let of = |values: &[f64]| {
            [
                ("rack_over_roller", Stored::doubles(values.to_vec())),
                ("rack_pitch", Stored::doubles(vec![0.0; values.len()])),
            ]
        };
        let memory = |all: &EvaluatedColumns| {
            let numbers = all.results.columns.iter().filter_map(|column| match &column.values {
                ResultValues::Numbers(numbers) => Some(numbers.as_ptr()),
                _ => None,
            });
            numbers.collect::<Vec<_>>()
        };
        let first = evaluate(&evaluator, &of(&[25.06, 25.01, f64::NAN])).unwrap();
        let in_use = memory(&first);
        evaluator.take_back(first.results);
        let second = of(&[25.02, 25.07]);
        let again = evaluate(&evaluator, &second).unwrap();
        assert_eq!(memory(&again), in_use);
        assert_eq!(again.results, evaluate(&self::evaluator(SPEC), &second).unwrap().results);
        assert_ne!(memory(&evaluate(&evaluator, &second).unwrap()), in_use);
    }

    /// A yoke has its figures in columns: of a size on all teeth by the mesh, of a step by the bound.
    #[test]
    fn parts_have_what_a_yoke_does() {
        let spec = "[errors]\nrack_over_roller = { value = 0, extent = \"all\" }\n[pair]\nnormal_module = 2\nnormal_pressure_angle = 19.9\n\
                    [rack]\nface_width = 19.7\naddendum = 1.7\ntravel = { from = 0, to = 20 }\n[pinion]\nteeth = 8\nhelix_angle = 21\n\
                    profile_shift = 0.3\nface_width = 23.5\ntip_diameter = 19.738\n[yoke]\nset_at = \"tightest\"\n\
                    [limits]\nyoke_play = { lower = 0.01, upper = 0.1 }";
        let number = |of: &str, all: &EvaluatedColumns| {
            let at = all.columns.iter().position(|(name, _)| name == of)?;
            let column = &all.results.columns[at];
            let ResultValues::Numbers(numbers) = &column.values else { panic!("{of} is no number") };
            column.has_value(0).then(|| numbers[0])
        };
        let size = ("rack_over_roller", Stored::doubles(&[0.02][..]));
        let known = evaluate(&evaluator(spec), &[("part_id", names(&["P1"])), size.clone()]).unwrap();
        assert_eq!(texts("yoke_play_verdict", &known), [Some("pass".to_owned())]);
        let setting = ["setting_from_mm", "setting_to_mm"].map(|name| number(name, &known));
        assert_eq!((setting, number("variation_at_most_mm", &known)), ([Some(0.01), Some(0.1)], None));
        let step = spec.replace("[pair]", "rack_pitch = 0\n[pair]");
        let columns = [("part_id", names(&["P1"])), size, ("rack_pitch", Stored::doubles(&[0.01][..]))];
        let bounded = evaluate(&evaluator(&step), &columns).unwrap();
        let [width, to] = ["variation_at_most_mm", "safe_setting_to_mm"].map(|name| number(name, &bounded).unwrap());
        assert!(width > 0.01 && (to - (0.1 - width)).abs() < 1e-11, "{width} {to}");
        assert_eq!(
            (number("setting_from_mm", &bounded), texts("yoke_play_verdict", &bounded)),
            (None, [Some("pass".to_owned())].into())
        );
    }

    /// Without rows there are none; what a table may not be is refused with the same words.
    #[test]
    fn pieces_without_rows_and_columns_without_an_owner() {
        let evaluator = evaluator(SPEC);
        let none = || Stored::doubles(Vec::new());
        let empty =
            evaluate(&evaluator, &[("part_id", names(&[])), ("rack_over_roller", none()), ("rack_pitch", none())]);
        assert_eq!(empty.unwrap().results.rows, 0);
        let with_stranger = [
            ("rack_over_roller", Stored::doubles(&[25.01][..])),
            ("rack_pitch", Stored::doubles(&[0.01][..])),
            ("rack_pich [um]", Stored::doubles(&[200.0][..])),
        ];
        let refused = evaluate(&evaluator, &with_stranger).unwrap_err();
        assert!(refused.0[0].message_with_list().contains("rack_pich"), "{refused}");
        let lacking = evaluate(&evaluator, &[("rack_over_roller", Stored::doubles(&[25.01][..]))]).unwrap();
        assert_eq!(texts("verdict", &lacking), [None]);
        let reason = "not judged: the spec asks for rack_pitch, and the table has none";
        assert_eq!(texts("reason", &lacking), [Some(reason.to_owned())]);
    }
}
