//! Parts as cells: a row per part, a line per error, a row per characteristic. What a cell looks like as text is left to the
//! file.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use rackmesh::deviation::DeviationKind;

use super::parts::{Measured, NominalIn, Number, Parts};
use super::words::{Title, UnitWord};

/// What is written into a cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    Empty,
    Text(String),
    Number(Number),
    /// With its unit behind it.
    United(Number, &'static str),
}

/// The shape of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A header, and a row per part.
    Rows,
    /// A line per error, and a column per part.
    Labels,
    /// A row per part and error, with a column that names the part.
    Characteristics,
    /// A row per error, with columns for nominal values and tolerances, and one for each part.
    PartColumns,
}

/// Where units stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Units {
    Heading(Around),
    /// A row or column of their own.
    Apart,
    Cells,
}

/// What stands around a unit in a heading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Around {
    Square,
    Round,
    Slash,
    Word,
    Underscore,
}

/// How parts are put down as cells.
#[derive(Debug, Clone)]
pub struct Design {
    pub shape: Shape,
    pub units: Units,
    /// Whether a key in mm or degrees stands without its unit.
    pub bare_keys: bool,
    /// Whether a mean stands below the parts.
    pub mean: bool,
    /// Columns and rows are sorted by these.
    pub columns: Vec<u8>,
    pub rows: Vec<u8>,
}

prop_compose! {
    /// Any design.
    pub fn design()(
        shape in select(vec![Shape::Rows, Shape::Rows, Shape::Labels, Shape::Characteristics, Shape::PartColumns]),
        units in select(vec![
            Units::Heading(Around::Square),
            Units::Heading(Around::Round),
            Units::Heading(Around::Slash),
            Units::Heading(Around::Word),
            Units::Heading(Around::Underscore),
            Units::Apart,
            Units::Cells,
        ]),
        bare_keys in any::<bool>(),
        mean in any::<bool>(),
        columns in vec(any::<u8>(), 40),
        rows in vec(any::<u8>(), 80),
    ) -> Design {
        Design { shape, units, bare_keys, mean, columns, rows }
    }
}

/// What a heading is the name of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holds {
    Values,
    Nominal,
    /// What is checked, and could be missing.
    Checked,
}

/// A heading or label.
#[derive(Debug, Clone, Copy)]
pub struct Heading {
    pub row: usize,
    pub column: usize,
    pub kind: DeviationKind,
    pub holds: Holds,
}

/// A table as cells.
#[derive(Debug, Clone)]
pub struct Grid {
    pub shape: Shape,
    pub cells: Vec<Vec<Cell>>,
    pub headings: Vec<Heading>,
    /// The parts in the table's order.
    pub order: Vec<usize>,
    /// The first row of values.
    pub first: usize,
}

/// A column of a table with a row per part.
struct Column {
    title: String,
    unit: &'static str,
    cells: Vec<Cell>,
    kind: Option<DeviationKind>,
    holds: Holds,
}

/// Sorts by keys.
fn shuffled<T>(items: Vec<T>, keys: &[u8]) -> Vec<T> {
    let mut keyed: Vec<_> = items.into_iter().enumerate().collect();
    keyed.sort_by_key(|(index, _)| keys[*index % keys.len()]);
    keyed.into_iter().map(|(_, item)| item).collect()
}

fn text(text: &str) -> Cell {
    if text.is_empty() { Cell::Empty } else { Cell::Text(text.to_owned()) }
}

impl Grid {
    /// Parts that have no names to be told apart by take a row each.
    pub fn new(parts: &Parts, design: &Design) -> Self {
        match design.shape {
            Shape::Labels => labels(parts, design),
            Shape::Characteristics if !parts.names.is_empty() => characteristics(parts, design),
            Shape::PartColumns if parts.names_are_words() => part_columns(parts, design),
            _ => rows(parts, design),
        }
    }

    /// The headings of an error.
    pub fn headings_of(&self, kind: DeviationKind, holds: Holds) -> Vec<Heading> {
        self.headings.iter().copied().filter(|heading| heading.kind == kind && heading.holds == holds).collect()
    }
}

impl Design {
    /// Whether the error stands without a unit.
    fn is_bare(&self, error: &Measured) -> bool {
        let has_own_unit = error.unit.is_angle == (error.kind == DeviationKind::RackLead);
        self.bare_keys && error.title.is_key && has_own_unit && matches!(error.unit.spelling, "mm" | "deg")
    }

    /// Whether the unit is a time where no name of an angle stands beside it.
    fn is_time(&self, error: &Measured) -> bool {
        self.shape == Shape::Rows && error.unit.spelling == "min"
    }

    /// A name with its unit, if that is where units stand.
    fn titled(&self, error: &Measured, name: &str) -> String {
        let UnitWord { spelling, is_clear, .. } = error.unit;
        let around = match self.units {
            _ if self.is_bare(error) => return name.to_owned(),
            Units::Heading(around) if is_clear => around,
            Units::Heading(_) => Around::Square,
            Units::Cells if !error.unit.in_cells => Around::Square,
            Units::Apart if self.is_time(error) => Around::Square,
            Units::Cells | Units::Apart => return name.to_owned(),
        };
        let is_simple = !spelling.contains(['/', ' ']);
        match around {
            Around::Round => format!("{name} ({spelling})"),
            Around::Slash if is_simple => format!("{name}/{spelling}"),
            Around::Word if is_simple => format!("{name} in {spelling}"),
            Around::Underscore if is_simple && error.title.is_key => format!("{name}_{spelling}"),
            _ => format!("{name} [{spelling}]"),
        }
    }

    /// The unit where units stand in a row or column of their own.
    fn apart(&self, error: &Measured) -> &'static str {
        if self.units == Units::Apart && !self.is_bare(error) && !self.is_time(error) {
            error.unit.spelling
        } else {
            ""
        }
    }

    fn number(&self, error: &Measured, digits: i64) -> Cell {
        let number = error.number(digits);
        if self.units == Units::Cells && error.unit.in_cells && !self.is_bare(error) {
            Cell::United(number, error.unit.spelling)
        } else {
            Cell::Number(number)
        }
    }

    fn value(&self, error: &Measured, part: usize) -> Cell {
        self.number(error, error.value(part).digits)
    }
}

/// The columns of an error: its values, and what stands beside them.
fn columns_of(parts: &Parts, error: &Measured, design: &Design, order: &[usize]) -> Vec<Column> {
    let suffixes = parts.language.suffixes();
    let Title { text: name, is_measured, .. } = error.title;
    let column = |name: &str, cells: Vec<Cell>, holds: Holds| Column {
        title: design.titled(error, name),
        unit: design.apart(error),
        cells,
        kind: Some(error.kind),
        holds,
    };
    let fixed = |digits: i64| vec![design.number(error, digits); order.len()];
    // `Rollenmaß Ist` is beside `Rollenmaß Soll`
    let stem = if is_measured { parts.language.titles(error.kind)[0].text } else { name };
    let beside =
        |suffix: &str| if suffix == "écart" { format!("{suffix} {stem}") } else { format!("{stem} {suffix}") };
    let mut columns = vec![column(name, order.iter().map(|part| design.value(error, *part)).collect(), Holds::Values)];
    if let Some(nominal) = error.nominal.filter(|nominal| nominal.stands_in == NominalIn::Table) {
        columns.push(column(&beside(suffixes.nominal), fixed(nominal.digits), Holds::Nominal));
    }
    if error.companions.tolerances {
        columns.push(column(&beside(suffixes.upper), fixed(error.largest()), Holds::Checked));
        columns.push(column(&beside(suffixes.lower), fixed(-error.largest()), Holds::Checked));
    }
    if error.companions.deviation {
        let cells = order.iter().map(|part| design.number(error, error.deviations[*part])).collect();
        columns.push(column(&beside(suffixes.deviation), cells, Holds::Checked));
    }
    columns
}

fn columns(parts: &Parts, design: &Design, order: &[usize]) -> Vec<Column> {
    let mut columns: Vec<_> = parts.errors.iter().flat_map(|error| columns_of(parts, error, design, order)).collect();
    for place in &parts.context {
        let context = parts.language.context()[*place];
        let cells = order.iter().map(|part| text(context.values[part % 3])).collect();
        columns.push(Column { title: context.title.to_owned(), unit: "", cells, kind: None, holds: Holds::Checked });
    }
    shuffled(columns, &design.columns)
}

fn names(parts: &Parts, order: &[usize]) -> Column {
    let cells = order.iter().map(|part| text(&parts.names[*part])).collect();
    Column { title: parts.name_title.to_owned(), unit: "", cells, kind: None, holds: Holds::Checked }
}

fn rows(parts: &Parts, design: &Design) -> Grid {
    let order = shuffled((0..parts.count).collect(), &design.rows);
    let mut columns = columns(parts, design, &order);
    if !parts.names.is_empty() {
        columns.insert(usize::from(design.columns[39]) % (columns.len() + 1), names(parts, &order));
    }
    let mut cells = vec![columns.iter().map(|column| text(&column.title)).collect::<Vec<_>>()];
    if columns.iter().any(|column| !column.unit.is_empty()) {
        cells.push(columns.iter().map(|column| text(column.unit)).collect());
    }
    let first = cells.len();
    for row in 0..parts.count {
        cells.push(columns.iter().map(|column| column.cells[row].clone()).collect());
    }
    if design.mean && !parts.names.is_empty() {
        let mean = |column: &Column| match (column.kind, column.title == parts.name_title) {
            (_, true) => text(parts.language.mean()),
            (Some(_), _) => column.cells[0].clone(),
            (None, _) => Cell::Empty,
        };
        cells.push(columns.iter().map(mean).collect());
    }
    let heading =
        |(column, found): (usize, &Column)| found.kind.map(|kind| Heading { row: 0, column, kind, holds: found.holds });
    let headings = columns.iter().enumerate().filter_map(heading).collect();
    Grid { shape: Shape::Rows, cells, headings, order, first }
}

fn labels(parts: &Parts, design: &Design) -> Grid {
    let order = shuffled((0..parts.count).collect(), &design.rows);
    let mut lines = columns(parts, design, &order);
    if !parts.names.is_empty() {
        lines.insert(0, names(parts, &order));
    }
    let has_units = lines.iter().any(|line| !line.unit.is_empty());
    let (mut cells, mut headings) = (Vec::new(), Vec::new());
    for (row, line) in lines.into_iter().enumerate() {
        headings.extend(line.kind.map(|kind| Heading { row, column: 0, kind, holds: line.holds }));
        let units = has_units.then(|| text(line.unit));
        cells.push(std::iter::once(text(&line.title)).chain(units).chain(line.cells).collect());
    }
    Grid { shape: Shape::Labels, cells, headings, order, first: 0 }
}

/// Which columns a table of characteristics has.
struct Needs {
    nominal: bool,
    tolerances: bool,
    deviation: bool,
}

impl Needs {
    fn of(parts: &Parts) -> Self {
        let any = |wanted: fn(&Measured) -> bool| parts.errors.iter().any(wanted);
        Self {
            nominal: any(|error| error.nominal.is_some_and(|nominal| nominal.stands_in == NominalIn::Table)),
            tolerances: any(|error| error.companions.tolerances),
            deviation: any(|error| error.companions.deviation),
        }
    }
}

impl Design {
    /// What stands beside a value in a row of its own: nominal value and tolerances, where the error has them.
    fn facts(&self, error: &Measured) -> [Cell; 3] {
        let of = |digits: Option<i64>| digits.map_or(Cell::Empty, |digits| self.number(error, digits));
        let nominal = error.nominal.filter(|nominal| nominal.stands_in == NominalIn::Table);
        let tolerance = error.companions.tolerances.then(|| error.largest());
        [of(nominal.map(|nominal| nominal.digits)), of(tolerance), of(tolerance.map(|digits| -digits))]
    }
}

fn characteristics(parts: &Parts, design: &Design) -> Grid {
    let heads = parts.language.heads();
    let needs = Needs::of(parts);
    // all columns there may be, and whether they are there
    let wanted = [
        (parts.language.part_head(), true),
        (heads.name, true),
        (heads.actual, true),
        (heads.nominal, needs.nominal),
        (heads.upper, needs.tolerances),
        (heads.lower, needs.tolerances),
        (heads.deviation, needs.deviation),
        (heads.unit, design.units == Units::Apart),
    ];
    let places = shuffled((0..wanted.len()).filter(|place| wanted[*place].1).collect(), &design.columns);
    let pairs = (0..parts.count).flat_map(|part| (0..parts.errors.len()).map(move |error| (part, error)));
    let pairs = shuffled(pairs.collect(), &design.rows);
    let mut cells = vec![places.iter().map(|place| text(wanted[*place].0)).collect::<Vec<_>>()];
    let (mut headings, mut order) = (Vec::new(), Vec::new());
    for (part, error) in pairs {
        if !order.contains(&part) {
            order.push(part);
        }
        let error = &parts.errors[error];
        let [nominal, upper, lower] = design.facts(error);
        let deviation = error.companions.deviation.then(|| design.number(error, error.deviations[part]));
        let all = [
            text(&parts.names[part]),
            text(&design.titled(error, error.title.text)),
            design.value(error, part),
            nominal,
            upper,
            lower,
            deviation.unwrap_or(Cell::Empty),
            text(design.apart(error)),
        ];
        let column = places.iter().position(|place| *place == 1).unwrap();
        headings.push(Heading { row: cells.len(), column, kind: error.kind, holds: Holds::Values });
        cells.push(places.iter().map(|place| all[*place].clone()).collect());
    }
    Grid { shape: Shape::Characteristics, cells, headings, order, first: 1 }
}

fn part_columns(parts: &Parts, design: &Design) -> Grid {
    let heads = parts.language.heads();
    let needs = Needs::of(parts);
    let order = shuffled((0..parts.count).collect(), &design.rows);
    // without nominal values and tolerances nothing would tell what kind of table it is
    let has_tolerances = needs.tolerances || !needs.nominal;
    let mut header = vec![text(heads.name)];
    let beside = [(heads.unit, design.units == Units::Apart), (heads.nominal, needs.nominal)];
    let tolerances = [(heads.upper, has_tolerances), (heads.lower, has_tolerances)];
    header.extend(beside.iter().chain(&tolerances).filter(|(_, there)| *there).map(|(head, _)| text(head)));
    header.extend(order.iter().map(|part| text(&parts.names[*part])));
    let mut cells = vec![header];
    let mut headings = Vec::new();
    for error in shuffled(parts.errors.iter().collect(), &design.columns) {
        let [nominal, upper, lower] = design.facts(error);
        let mut row = vec![text(&design.titled(error, error.title.text))];
        row.extend((design.units == Units::Apart).then(|| text(design.apart(error))));
        row.extend(needs.nominal.then_some(nominal));
        row.extend(has_tolerances.then_some([upper, lower]).into_iter().flatten());
        row.extend(order.iter().map(|part| design.value(error, *part)));
        headings.push(Heading { row: cells.len(), column: 0, kind: error.kind, holds: Holds::Values });
        cells.push(row);
    }
    Grid { shape: Shape::PartColumns, cells, headings, order, first: 1 }
}
