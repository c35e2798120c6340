//! Text and tables for people: on a screen, and in Markdown. Called by the writer of reports; knows widths and colours,
//! and no result.

use anstyle::{AnsiColor, Style};
use comfy_table::{
    CellAlignment, ColumnConstraint, ContentArrangement, ContentLineStyle, LineStyle, Table as Grid, TableStyle, Width,
    presets,
};

use super::Screen;
use crate::diagnostic::{harmless, harmless_lines, wrap};
use crate::judge::Verdict;

/// A piece of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Block {
    /// The report's title.
    Title(String),
    /// A table.
    Table(Table),
    /// Lines drawn with characters; for screens.
    Drawing(String),
    /// A line without a mark: the model, an overall grade, how values differ.
    Note(String),
    /// A remark on the result's assumptions; the writer marks it as a note.
    Remark(String),
    /// The verdict and its sentence; without one, why there is none.
    Verdict(Option<Verdict>, String),
}

impl Block {
    /// Escapes control characters of a terminal. Only drawings and headings have line breaks, which are the program's own.
    pub(super) fn show(&mut self) {
        let one_line = |text: &mut String| *text = harmless(text).into_owned();
        match self {
            Self::Title(text) | Self::Note(text) | Self::Remark(text) | Self::Verdict(_, text) => one_line(text),
            Self::Drawing(text) => *text = harmless_lines(text).into_owned(),
            Self::Table(table) => {
                for Column { heading, .. } in &mut table.columns {
                    *heading = harmless_lines(heading).into_owned();
                }
                table.rows.iter_mut().flatten().for_each(one_line);
            }
        }
    }
}

/// A table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// The columns.
    pub columns: Vec<Column>,
    /// The cells, a row each.
    pub rows: Vec<Vec<String>>,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// The heading, with the unit; a line break where a narrow column may break it.
    pub heading: String,
    /// How its cells are aligned.
    pub align: Align,
    /// Whether the column is left out on a screen that is too narrow for the table.
    pub may_go: bool,
}

/// The alignment of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Text.
    Left,
    /// Numbers.
    Right,
}

impl Column {
    /// A column of text.
    pub fn text(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), align: Align::Left, may_go: false }
    }

    /// A column of numbers.
    pub fn number(heading: impl Into<String>) -> Self {
        Self { align: Align::Right, ..Self::text(heading) }
    }

    /// The column, which is left out on a screen that is too narrow for the table.
    pub(crate) fn unless_narrow(self) -> Self {
        Self { may_go: true, ..self }
    }
}

impl Table {
    /// A row for each item; the columns follow one by one.
    pub(crate) fn of<T>(items: impl IntoIterator<Item = T>) -> Rows<T> {
        let items: Vec<T> = items.into_iter().collect();
        let rows = items.iter().map(|_| Vec::new()).collect();
        Rows { items, table: Self { columns: Vec::new(), rows } }
    }
}

/// A table under construction: a column is a heading and the cell for an item.
pub(crate) struct Rows<T> {
    items: Vec<T>,
    table: Table,
}

impl<T> Rows<T> {
    /// Adds a column of text.
    pub(crate) fn text<C: Cell>(self, heading: impl Into<String>, cell: impl Fn(&T) -> C) -> Self {
        self.column_if(true, Column::text(heading), cell)
    }

    /// Adds a column of numbers.
    pub(crate) fn number<C: Cell>(self, heading: impl Into<String>, cell: impl Fn(&T) -> C) -> Self {
        self.column_if(true, Column::number(heading), cell)
    }

    /// Adds a column that only some tables have.
    pub(crate) fn column_if<C: Cell>(mut self, is_there: bool, column: Column, cell: impl Fn(&T) -> C) -> Self {
        if is_there {
            self.table.columns.push(column);
            for (row, item) in self.table.rows.iter_mut().zip(&self.items) {
                row.push(cell(item).text());
            }
        }
        self
    }

    /// The table as a piece of a report.
    pub(crate) fn block(self) -> Block {
        Block::Table(self.table)
    }

    /// The same; `None` without a row.
    pub(crate) fn block_if_any(self) -> Option<Block> {
        (!self.items.is_empty()).then(|| self.block())
    }
}

/// The text of a cell for people.
pub(crate) trait Cell {
    /// Its text.
    fn text(self) -> String;
}

impl Cell for String {
    fn text(self) -> String {
        self
    }
}

impl Cell for &str {
    fn text(self) -> String {
        self.to_owned()
    }
}

/// A dash where there is no value.
impl<C: Cell> Cell for Option<C> {
    fn text(self) -> String {
        self.map_or_else(|| "-".to_owned(), C::text)
    }
}

/// The blocks with their verdicts at the end, the worst one last.
pub(super) fn worst_last(blocks: Vec<Block>) -> Vec<Block> {
    let rank = |block: &Block| match block {
        Block::Verdict(Some(Verdict::Fail), _) => 4,
        Block::Verdict(None, _) => 3,
        Block::Verdict(Some(Verdict::Indeterminate), _) => 2,
        Block::Verdict(Some(Verdict::Pass), _) => 1,
        _ => 0,
    };
    let mut blocks = blocks;
    blocks.sort_by_key(rank);
    blocks
}

/// The word before a verdict's sentence.
pub(super) fn verdict_word(verdict: Option<Verdict>) -> String {
    verdict.map_or_else(|| "No verdict".to_owned(), |verdict| verdict.name().to_uppercase())
}

/// A remark for people, with its mark.
#[must_use]
pub fn noted(remark: &str) -> String {
    format!("note: {remark}")
}

/// A header, a line, rows.
const PLAIN: TableStyle = TableStyle::new()
    .header_lines(ContentLineStyle::none())
    .header_separator(LineStyle::none().fill('─').junction('─'))
    .content_lines(ContentLineStyle::none());

fn grid(table: &Table, style: TableStyle, padding: (u16, u16)) -> Grid {
    let mut grid = Grid::new();
    grid.load_style(style);
    grid.set_header(table.columns.iter().map(|column| column.heading.as_str()));
    grid.add_rows(table.rows.iter());
    for (column, grid_column) in table.columns.iter().zip(grid.column_iter_mut()) {
        grid_column.set_padding(padding);
        if column.align == Align::Right {
            grid_column.set_cell_alignment(CellAlignment::Right);
        }
    }
    grid
}

pub(super) fn text(blocks: &[Block], screen: Screen) -> String {
    let paint =
        |text: &str, style: Style| if screen.color { format!("{style}{text}{style:#}") } else { text.to_owned() };
    let mut out = String::new();
    let mut previous_is_note = false;
    for block in blocks {
        let is_note = matches!(block, Block::Note(_) | Block::Remark(_));
        // a blank line between blocks, but none between remarks
        let continues = is_note && previous_is_note;
        if !out.is_empty() && !continues {
            out.push('\n');
        }
        previous_is_note = is_note;
        out += &match block {
            Block::Title(title) => paint(title, Style::new().bold()),
            Block::Drawing(lines) => lines.clone(),
            Block::Note(note) => wrap(note, screen.width),
            Block::Remark(remark) => wrap(&noted(remark), screen.width),
            Block::Verdict(verdict, sentence) => {
                let color = match verdict {
                    Some(Verdict::Pass) => AnsiColor::Green,
                    Some(Verdict::Fail) => AnsiColor::Red,
                    Some(Verdict::Indeterminate) | None => AnsiColor::Yellow,
                };
                let word = paint(&verdict_word(*verdict), color.on_default().bold());
                wrap(&format!("{word}: {sentence}"), screen.width)
            }
            Block::Table(table) => table_text(table, screen.width),
        };
        out.push('\n');
    }
    out
}

/// A table for a screen that is `width` wide, without the last line's end.
pub(crate) fn table_text(table: &Table, width: Option<u16>) -> String {
    let narrowed = width.map(|width| without_what_may_go(table, width.into()));
    let table = narrowed.as_ref().unwrap_or(table);
    let mut grid = grid(table, PLAIN, (1, 0));
    if let Some(width) = width {
        grid.set_width(width).set_content_arrangement(ContentArrangement::Dynamic);
        if let Some(widths) = column_widths(table, width.into()) {
            for (column, width) in grid.column_iter_mut().zip(widths) {
                let width = u16::try_from(width).unwrap_or(u16::MAX);
                column.set_constraint(ColumnConstraint::Absolute(Width::Fixed(width)));
            }
        }
    } else {
        grid.set_content_arrangement(ContentArrangement::Disabled);
    }
    let lines: Vec<_> = grid.lines().map(|line| line.trim_end().to_owned()).collect();
    lines.join("\n")
}

/// The table without columns that may be left out, the last one first, until its lines fit the screen.
fn without_what_may_go(table: &Table, room: usize) -> Table {
    let mut table = table.clone();
    let longest =
        |table: &Table, column| texts(table, column).flat_map(str::lines).map(|line| line.chars().count()).max();
    let width =
        |table: &Table| (0..table.columns.len()).map(|column| 2 + longest(table, column).unwrap_or(0)).sum::<usize>();
    while width(&table) > room + 1
        && let Some(last) = table.columns.iter().rposition(|column| column.may_go)
    {
        table.columns.remove(last);
        for row in table.rows.iter_mut().filter(|row| row.len() > last) {
            row.remove(last);
        }
    }
    table
}

/// The texts of a column, with its heading.
fn texts(table: &Table, column: usize) -> impl Iterator<Item = &str> {
    let cells = table.rows.iter().filter_map(move |row| row.get(column));
    cells.chain(std::iter::once(&table.columns[column].heading)).map(String::as_str)
}

/// The columns' widths, with the blank before each, such that lines break only between words, and between numbers that belong
/// together only if nothing else helps; `None` if no line has to break, or if there is no room for the longest words.
fn column_widths(table: &Table, room: usize) -> Option<Vec<usize>> {
    widths_by(table, room, true).or_else(|| widths_by(table, room, false))
}

/// The widths with numbers kept together, or not.
fn widths_by(table: &Table, room: usize, keeps_numbers: bool) -> Option<Vec<usize>> {
    let texts = |column: usize| texts(table, column);
    let longest = |parts: &mut dyn Iterator<Item = &str>| 1 + parts.map(|part| part.chars().count()).max().unwrap_or(0);
    let columns = 0..table.columns.len();
    let full: Vec<_> = columns.clone().map(|column| longest(&mut texts(column).flat_map(str::lines))).collect();
    let is_whole = |column: usize| keeps_numbers && table.columns[column].align == Align::Right;
    let of_words = |column| longest(&mut texts(column).flat_map(str::split_whitespace));
    let mut widths: Vec<_> =
        columns.map(|column| if is_whole(column) { full[column] } else { of_words(column) }).collect();
    // a blank stands between columns, too
    let room = (room + 1).checked_sub(widths.len())?;
    let mut left = room.checked_sub(widths.iter().sum())?;
    if full.iter().sum::<usize>() <= room {
        return None;
    }
    // the narrowest columns get their room first, so that few columns break
    let mut order: Vec<_> = (0..widths.len()).collect();
    order.sort_by_key(|&column| full[column] - widths[column]);
    for (served, &column) in order.iter().enumerate() {
        let share = (full[column] - widths[column]).min(left / (order.len() - served));
        widths[column] += share;
        left -= share;
    }
    Some(widths)
}

pub(super) fn markdown(blocks: &[Block]) -> String {
    let mut out = String::new();
    for block in blocks {
        if !out.is_empty() {
            out.push('\n');
        }
        out += &match block {
            Block::Title(title) => format!("## {}\n", markdown_text(title)),
            Block::Drawing(lines) => format!("```text\n{lines}\n```\n"),
            Block::Note(note) => format!("{}\n", markdown_text(note)),
            Block::Remark(remark) => format!("{}\n", markdown_text(&noted(remark))),
            Block::Verdict(verdict, sentence) => {
                format!("**{}**: {}\n", verdict_word(*verdict), markdown_text(sentence))
            }
            Block::Table(table) => markdown_table(table),
        };
    }
    out
}

/// Text in Markdown that cannot become a tag, link or picture, also after a `\` or a backtick.
fn markdown_text(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace("](", "]&#40;").replace("][", "]&#91;")
}

/// Text in a cell of Markdown, which a `|` would end.
fn markdown_cell(text: &str) -> String {
    markdown_text(text).replace('|', "&#124;")
}

fn markdown_table(table: &Table) -> String {
    let mut escaped = table.clone();
    for column in &mut escaped.columns {
        column.heading = markdown_cell(&column.heading.replace('\n', " "));
    }
    for cell in escaped.rows.iter_mut().flatten() {
        *cell = markdown_cell(cell);
    }
    let mut grid = grid(&escaped, presets::ASCII_MARKDOWN, (1, 1));
    grid.set_content_arrangement(ContentArrangement::Disabled);
    let marked = |(index, line): (usize, String)| {
        if index == 1 { mark_alignment(&line, &table.columns) } else { line }
    };
    grid.lines().enumerate().map(marked).map(|line| line + "\n").collect()
}

/// Marks right-aligned columns in the rule below a Markdown table's header: `---:`.
fn mark_alignment(rule: &str, columns: &[Column]) -> String {
    let marked = rule.trim_matches('|').split('|').zip(columns).map(|(cell, column)| match column.align {
        Align::Left => cell.to_owned(),
        Align::Right => format!("{}:", &cell[..cell.len() - 1]),
    });
    format!("|{}|", marked.collect::<Vec<_>>().join("|"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn narrow_columns_break_between_words() {
        let table = Table {
            columns: vec![Column::text("what"), Column::number("value\n[mm]"), Column::text("verdict")],
            rows: vec![vec![
                "a long name of a deviation".to_owned(),
                "+0.0382 … +0.0549".to_owned(),
                "indeterminate".to_owned(),
            ]],
        };
        for width in 36..60 {
            let text = table_text(&table, Some(width));
            assert!(text.lines().all(|line| line.chars().count() <= usize::from(width)), "{width}:\n{text}");
            assert!(
                ["deviation", "+0.0382", "+0.0549", "indeterminate"].iter().all(|word| text.contains(word)),
                "{width}:\n{text}"
            );
        }
    }
}
