//! The contract of a table: what its columns and lines are, as a person wrote or confirmed it. Made from the spec's `[table]`, from a
//! layout file and from options; the reader follows it.

use std::collections::HashSet;
use std::str::FromStr;
use std::sync::Arc;

use super::dictionary::{Form, Heading, Role};
use super::encoding::Encoding;
use super::field::{Beside, Field};
use super::grid::unit_of;
use super::number::DecimalMark;
use super::pattern::Pattern;
use super::workbook::CellRange;
use crate::diagnostic::nearest_or;
use crate::quantity::Unit;

/// Rules of a kind that a contract has at most.
pub(crate) const MOST_RULES: usize = 1000;

/// Where the values of a part stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Parts {
    /// In a row.
    Rows,
    /// In a column.
    Columns,
    /// In several rows, one for each characteristic.
    Characteristics,
}

impl Parts {
    /// The word in a contract.
    pub(crate) const fn word(self) -> &'static str {
        match self {
            Self::Rows => "rows",
            Self::Columns => "columns",
            Self::Characteristics => "characteristics",
        }
    }
}

/// What becomes of a part that is there more than once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Repeats {
    /// The table is refused.
    #[default]
    Refused,
    /// Each row is judged.
    All,
    /// The last row is judged, and the others are left out.
    Last,
}

/// The reader's own rules, which nobody writes. Their numbers follow those of the contract's rules.
#[derive(Debug, Clone, Copy)]
pub(crate) enum OwnRule {
    /// `others = "ignore"`, for every further column.
    Others,
    RepeatedHeadings,
    /// What stands beside values, is read and judges nothing.
    BesideValues,
    OtherSheets,
    /// Rows before the last one of their part.
    RepeatedParts,
    /// What the format of a file writes besides values.
    OfFormat,
    /// What a measuring program decided of a part.
    Status,
}

/// A rule for lines that are no parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LineRule {
    /// Which lines these are.
    pub pattern: Pattern,
    /// How many lines that could be parts the rule may leave out.
    pub at_most: u64,
}

/// Where the names of parts stand.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PartNames {
    /// In the column of this heading.
    Column(String),
    /// In lines above the rows of each part; the name is what the pattern's `*` stands for.
    Line(Pattern),
}

/// The column of an error and those beside it, as the contract names them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeclaredColumn {
    /// The error, or the size of a space or tooth.
    pub field: Field,
    /// The heading of its values; `None` if the dictionary finds it.
    pub name: Option<String>,
    /// The unit of its numbers, if the contract says so.
    pub unit: Option<Unit>,
    /// The headings of the columns beside it, with what these hold.
    pub(crate) beside: Vec<(Beside, String)>,
    /// Whether its values are deviations, whatever the heading says.
    pub is_deviation: bool,
    /// Everything else that the contract says of it: keys with their values as TOML.
    pub others: Vec<(String, String)>,
}

/// The column of a measuring program's decision.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StatusColumn {
    /// Its heading.
    pub name: String,
    /// Texts of parts that are judged by their values.
    pub accept: Vec<String>,
    /// Texts of parts that fail.
    pub reject: Vec<String>,
}

/// Whether a table is a measured curve.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum IsCurve {
    /// It is none.
    #[default]
    No,
    /// It is one if its headings are those of a curve.
    ByHeadings,
    /// It is one.
    Yes,
}

/// The contract of a table.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Layout {
    /// Whether a spec or a layout file has a contract.
    pub is_written: bool,
    /// Where the values of a part stand, if the contract says so.
    pub parts: Option<Parts>,
    /// Whether each row or column is known to be a space or tooth, and no part.
    pub teeth: bool,
    /// Whether each row is a point of a measured curve.
    pub curve: IsCurve,
    /// The encoding of a text, if the contract says so.
    pub encoding: Option<Encoding>,
    /// The sheet of a workbook, if the contract says so.
    pub sheet: Option<String>,
    /// The cells of a sheet that are the table.
    pub range: CellRange,
    /// What separates cells of a text, if the contract says so.
    pub separator: Option<u8>,
    /// In which column of characters each cell of a text of fixed width starts; empty if the contract does not say so.
    pub starts: Vec<usize>,
    /// The decimal mark, if the contract says so.
    pub decimal: Option<DecimalMark>,
    /// The headings of a file that has none.
    pub headings: Vec<String>,
    /// The line of units, if the contract says which.
    pub units: Option<u64>,
    /// Where the names of parts stand; `None` if the dictionary finds their column.
    pub part_id: Option<PartNames>,
    /// The heading of the numbers of spaces or teeth; `None` if the dictionary finds it.
    pub index: Option<(Field, String)>,
    /// The columns of errors.
    pub columns: Vec<DeclaredColumn>,
    /// The column of a measuring program's decision.
    pub status: Option<StatusColumn>,
    /// The headings of a table with a row per characteristic, by what their columns hold.
    pub(crate) of_characteristics: Vec<(Beside, String)>,
    /// Headings of columns that the format of the file owns, and that say nothing of values.
    pub(crate) of_format: Vec<String>,
    /// Columns that are not used.
    pub ignore: Vec<Pattern>,
    /// Lines that belong to no part.
    pub ignore_lines: Vec<LineRule>,
    /// Comments, text boxes and metadata of a file that are not used.
    pub comments: Vec<Pattern>,
    /// Whether every further column is left out.
    pub ignores_others: bool,
    /// What becomes of a part that is there more than once.
    pub repeats: Repeats,
    /// The parts that a later file has again, where the last row of a part is judged.
    pub later: Arc<HashSet<String>>,
    /// Columns that only a page shows: their keys in `[report]`, and their headings.
    pub details: Vec<(&'static str, String)>,
}

/// The keys of `[report]` that a column may stand for.
pub(crate) const DETAILS: [&str; 4] = ["date", "inspector", "order", "drawing"];

/// A column as `--column` names it: `rack_pitch=CHR_017[um]`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnOption {
    /// What the column holds.
    pub field: Field,
    /// The heading, without its unit.
    pub name: String,
    /// The unit, if it is written.
    pub unit: Option<Unit>,
}

impl FromStr for ColumnOption {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (key, heading) = text.split_once('=').ok_or("write KEY=HEADING, such as rack_pitch=CHR_017[um]")?;
        let key = key.trim();
        let field: Field = key.parse().map_err(|_| {
            let keys = Field::ALL.map(Field::key);
            format!("`{key}` is no column's key: {}", nearest_or(key, keys, || format!("they are {}", keys.join(", "))))
        })?;
        let heading = Heading::of(heading);
        if heading.name.is_empty() {
            return Err("the heading is missing".to_owned());
        }
        let unit =
            heading.unit.map(|symbol| unit_of(&symbol, field.is_angle()).ok_or(format!("`{symbol}` is no unit here")));
        Ok(Self { field, name: heading.name, unit: unit.transpose()? })
    }
}

impl DeclaredColumn {
    /// The column of an error. `beside` has the columns beside it, each by its key in a spec and its heading.
    #[must_use]
    pub fn new(
        field: impl Into<Field>,
        name: Option<String>,
        unit: Option<Unit>,
        beside: Vec<(&'static str, String)>,
    ) -> Self {
        let role = |key| if key == "units" { Beside::Unit } else { Beside::of_key(key).unwrap_or(Beside::Unit) };
        let beside = beside.into_iter().map(|(key, name)| (role(key), name)).collect();
        Self { field: field.into(), name, unit, beside, is_deviation: false, others: Vec::new() }
    }
}

impl Layout {
    /// The form of table that is supposed where no heading is known.
    pub(crate) const fn form(&self) -> Form {
        match (self.curve, self.teeth) {
            (IsCurve::Yes, _) => Form::Trace,
            (_, true) => Form::Teeth,
            (_, false) => Form::Parts,
        }
    }

    /// The same contract, with the column of the parts' names that the format has.
    pub(crate) fn with_part_column(&self, name: &str) -> Self {
        Self { part_id: Some(PartNames::Column(name.to_owned())), ..self.clone() }
    }

    /// The role that the contract gives to a heading. The contract may name it with its unit or without.
    pub(crate) fn declared(&self, title: &str, name: &str, form: Form) -> Option<Role> {
        let is_called = |declared: &str| is_same(declared, title) || is_same(declared, name);
        let is_of = |role: Role| role.is_of(form) && (form == Form::Teeth || !matches!(role, Role::Index(_)));
        self.promised().find(|(role, name)| is_of(*role) && is_called(name)).map(|(role, _)| role)
    }

    /// Whether the contract names the heading of a role. Then the dictionary finds no other one.
    pub(crate) fn names(&self, role: Role) -> bool {
        let is_index = |role: Role| matches!(role, Role::Index(_));
        let is_it = |own: Role| own == role || is_index(own) && is_index(role);
        !matches!(role, Role::Beside(..)) && self.promised().any(|(own, _)| is_it(own))
    }

    /// The headings that the contract names and a table must have.
    pub(crate) fn promised(&self) -> impl Iterator<Item = (Role, &str)> {
        let columns = self.columns.iter().flat_map(|column| {
            let own = column.name.as_deref().map(|name| (Role::Value(column.field), name));
            own.into_iter()
                .chain(column.beside.iter().map(|(beside, name)| (Role::Beside(column.field, *beside), name.as_str())))
        });
        let of = self.of_characteristics.iter().map(|(of, name)| (Role::Of(*of), name.as_str()));
        let index = self.index.as_ref().map(|(index, name)| (Role::Index(*index), name.as_str()));
        let part = if let Some(PartNames::Column(name)) = &self.part_id { Some(name.as_str()) } else { None };
        let status = self.status.as_ref().map(|status| (Role::Status, status.name.as_str()));
        let part = part.map(|name| (Role::PartId, name)).into_iter();
        part.chain(status).chain(index).chain(columns).chain(of)
    }

    /// Sets the heading of a key of `[table.columns]`, for a table of characteristics, spaces or teeth.
    pub(crate) fn call(&mut self, key: &str, heading: String) {
        if let Some(beside) = Beside::of_key(key) {
            self.of_characteristics.push((beside, heading));
        } else if let Ok(index) = key.parse() {
            self.index = Some((index, heading));
        }
    }

    /// The pattern of the lines that name the parts below them.
    pub(crate) fn part_line(&self) -> Option<&Pattern> {
        if let Some(PartNames::Line(pattern)) = &self.part_id { Some(pattern) } else { None }
    }

    /// Adds what an option says of a column. It replaces what the contract says of it.
    pub fn declare(&mut self, option: &ColumnOption) {
        let field = option.field;
        if field == Field::PartId {
            self.part_id = Some(PartNames::Column(option.name.clone()));
            return;
        }
        if field.is_index() {
            return self.call(field.key(), option.name.clone());
        }
        match self.columns.iter_mut().find(|column| column.field == field) {
            Some(column) => {
                column.name = Some(option.name.clone());
                column.unit = option.unit.or(column.unit);
            }
            None => self.columns.push(DeclaredColumn::new(field, Some(option.name.clone()), option.unit, Vec::new())),
        }
    }

    /// The last place, from 1, that a rule such as `column 3` leaves out; 0 if there is no such rule.
    pub(crate) fn last_place(&self) -> usize {
        const MOST: usize = 16_384;
        let places = self.ignore.iter().filter_map(|rule| rule.text().strip_prefix("column ")?.parse().ok());
        places.filter(|place| *place <= MOST).max().unwrap_or(0)
    }

    /// The rule that leaves out a column: with `exactly` a rule that fits one text, otherwise a pattern.
    pub(crate) fn ignores(&self, title: &str, name: &str, place: usize, exactly: bool) -> Option<usize> {
        let by_place = title.is_empty().then(|| format!("column {}", place + 1));
        let texts = [title, name, by_place.as_deref().unwrap_or(title)];
        self.ignore.iter().position(|rule| rule.is_exact() == exactly && texts.iter().any(|text| rule.fits(text)))
    }
}

/// Whether two headings are the same apart from blanks.
fn is_same(one: &str, other: &str) -> bool {
    let first = |text: &str| text.trim_start().bytes().next();
    first(one) == first(other) && one.split_whitespace().eq(other.split_whitespace())
}
