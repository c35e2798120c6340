//! The account of a table, and what would close it.

use std::collections::HashSet;
use std::sync::Arc;

use serde::Serialize;

use crate::deviation::DeviationKind;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::quantity::shown;
use crate::table::Table;
use crate::table::block::{Block, Contradiction, Odd};
use crate::table::cell::Record;
use crate::table::contract::{MOST_LISTED, Matched, Named, Open, Owner, key, no_headings};
use crate::table::dictionary::{Form, Heading, Role, lookup};
use crate::table::layout::{Layout, LineRule, MOST_RULES, Repeats};
use crate::table::pattern::{Pattern, escaped_heading};
use crate::table::propose::guess::{self, Guess, guesses, undecided};
use crate::table::propose::lines::Shapes;
use crate::table::propose::rules::{self, Certainty, Found, Rule, Rules, Suggestion};
use crate::table::propose::{Guesses, table_in_sentences};
use crate::table::reading::Reading;
use crate::table::rows::Wanted;
use crate::table::want::Want;

/// What a column is taken as, and why.
#[derive(Debug, Clone, Serialize)]
pub struct ColumnAccount {
    /// As the table calls it.
    pub title: String,
    /// Its place, from 1; `None` of a characteristic.
    pub place: Option<usize>,
    /// `rack_pitch`, `left out`, `not owned`.
    pub is: String,
    /// The unit of its numbers.
    pub unit: Option<String>,
    /// What says so.
    pub why: String,
    /// Its first texts.
    pub first: Vec<String>,
}

/// A line, or a comment of a workbook, that is no part.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize)]
pub struct LineAccount {
    /// Where it stands.
    pub place: String,
    /// What stands there.
    pub text: String,
    /// `not owned`, `rejected as a part`.
    pub is: &'static str,
}

/// What the account says of a rejected row that is perhaps no part.
pub(super) const REJECTED: &str = "rejected as a part";

const NOT_OWNED: &str = "not owned";

/// What would close a table.
#[derive(Debug, Clone, Default)]
pub struct Proposal {
    /// The file.
    pub file: String,
    /// Each column that is not empty.
    pub columns: Vec<ColumnAccount>,
    /// Each line that is no part and has no rule.
    pub lines: Vec<LineAccount>,
    /// How many rows are parts; `None` where they are not counted, because the table is not closed.
    pub parts: Option<u64>,
    /// What is wrong with the first rows that are rejected.
    pub rejected: Vec<String>,
    /// Whether the table is closed once the contract says all of this.
    pub closes: bool,
    /// How the table is read, once it is closed.
    pub reading: Option<Reading>,
    pub(super) open: Vec<Open>,
    /// How many more things have no owner, or are no parts, than those that are listed.
    pub more: usize,
    pub(super) rules: Rules,
}

/// Why a table cannot be read.
#[derive(Debug)]
pub(crate) enum Unclosed {
    /// Cells or lines have no owner.
    Open(Box<Proposal>),
    /// Anything else.
    Wrong(Diagnostics),
}

impl Unclosed {
    /// Because this one thing of a file is open.
    pub(crate) fn of(file: &str, layout: &Arc<Layout>, open: Open) -> Self {
        Self::Open(Box::new(Proposal::of(file, layout, vec![open])))
    }
}

impl From<Diagnostics> for Unclosed {
    fn from(problems: Diagnostics) -> Self {
        Self::Wrong(problems)
    }
}

impl From<Diagnostic> for Unclosed {
    fn from(problem: Diagnostic) -> Self {
        Self::Wrong(problem.into())
    }
}

impl From<Unclosed> for Diagnostics {
    fn from(unclosed: Unclosed) -> Self {
        match unclosed {
            Unclosed::Open(proposal) => proposal.refusal().into(),
            Unclosed::Wrong(problems) => problems,
        }
    }
}

impl Proposal {
    /// The proposal for a file in which these have no owner.
    pub(crate) fn of(file: &str, layout: &Arc<Layout>, mut open: Vec<Open>) -> Self {
        let more = open.len().saturating_sub(MOST_LISTED);
        open.truncate(MOST_LISTED);
        // a rule that cannot stand closes nothing
        let cannot_stand = |rule: &Pattern| {
            let is_it = |open: &Open| matches!(open, Open::IgnoredNames { rule: own, .. } | Open::Pattern { pattern: own, .. } if own == rule.text());
            open.iter().any(is_it)
        };
        let mut able = Layout::clone(layout);
        able.ignore.retain(|rule| !cannot_stand(rule));
        let rules = Rules { layout: able.into(), list: Vec::new() };
        let mut proposal = Self { file: file.to_owned(), rules, open, more, ..Self::default() };
        for open in &proposal.open {
            proposal.rules.list.extend(rules::of_open(open, layout));
            proposal.lines.extend(line_account(open));
        }
        proposal
    }

    /// The proposal for a table that is not closed, from its columns and its first rows.
    pub(crate) fn of_matched(file: &str, layout: &Layout, mut matched: Matched, rows: &[Record], want: &Want) -> Self {
        let guesses = guesses(&matched, rows, want);
        let has_values = guesses.iter().any(|guess| guess.key != "part_id" && guess.key != "status");
        let mut proposal = Self::of(file, &want.layout, std::mem::take(&mut matched.open));
        // with a row per characteristic, the other columns are known once the column of names is
        let has_names = guesses.iter().any(|guess| guess.key == "name");
        let is_guessed = |rule: &Rule| matches!(rule, Rule::Entry("ignore", title) if has_names || guesses.iter().any(|guess| escaped_heading(&guess.title) == *title));
        proposal.rules.list.retain(|suggestion| !is_guessed(&suggestion.rule));
        let first = |place: usize| {
            let cells = rows.iter().map(|row| row.cell(place)).filter(|cell| !cell.is_empty());
            cells.take(3).map(|cell| cell.text().into_owned()).collect()
        };
        let Matched { owners, titles, units, of, .. } = &matched;
        let found = Found { owners, titles, units, of };
        proposal.columns = columns(&found, layout);
        // the columns of characteristics come first, and are no cells of a row
        for column in proposal.columns.iter_mut().skip(matched.of.len()) {
            column.first = column.place.map_or_else(Vec::new, |place| first(place - 1));
            if let Some(guess) = guesses.iter().find(|guess| Some(guess.place + 1) == column.place) {
                column.why = format!("nobody; {}, a guess: {}", guess.key, guess.why);
            }
        }
        proposal.columns.retain(|column| !(column.title.is_empty() && column.first.is_empty()));
        proposal.add_unowned();
        undecided(&matched, (&proposal.open, rows), want, &guesses, &mut proposal.rules.list);
        if layout.details.iter().all(|(key, _)| *key != "date") {
            let date = guess::date(&matched, &proposal.open, rows, &proposal.rules.list);
            proposal.rules.list.extend(date);
        }
        // of a column that is gone no more is known
        let is_gone = proposal.open.iter().any(|open| matches!(open, Open::Missing { .. }));
        if !has_values && !is_gone && proposal.leaves_nothing() {
            let is_of_values = proposal.open.iter().any(|open| matches!(open, Open::Characteristic { .. }));
            if is_of_values || owners.iter().any(|owner| matches!(owner, Some(Owner::Role(_)))) {
                proposal.rules.list.push(rules::no_values(want));
            } else {
                proposal
                    .rules
                    .list
                    .retain(|known| !matches!(known.rule, Rule::Entry("ignore", _) | Rule::Lines { .. }));
                proposal.open.push(no_headings("without these nothing is left", rows, (layout, want)));
            }
        }
        proposal.rules.list.extend(rules::pinned(&found, layout));
        // the units of rows take the place of one unit
        let has_units = |rule: &Rule| matches!(rule, Rule::Column { key, .. } if guesses.iter().any(|guess| guess.key == *key && guess.entry.has("units")));
        proposal.rules.list.retain(|known| !has_units(&known.rule));
        proposal.rules.list.extend(guesses.into_iter().map(Guess::suggestion));
        if !owners.contains(&Some(Owner::Role(Role::PartId))) && layout.part_id.is_none() {
            rules::name_by_line(&mut proposal.rules.list);
        }
        let id = owners.iter().position(|owner| *owner == Some(Owner::Role(Role::PartId)));
        if let Some(id) = id.filter(|_| matched.form == Form::Parts && layout.repeats == Repeats::Refused) {
            let is_part = |row: &&Record| row.numbers() > usize::from(row.cell(id).is_number());
            let mut shapes = Shapes::default();
            rows.iter().filter(is_part).for_each(|row| shapes.add_name(&row.cell(id).text()));
            proposal.tell_repeats(&shapes);
        }
        rules::settle(&mut proposal.rules.list);
        proposal
    }

    /// The proposal for a closed table, from all of its rows.
    ///
    /// # Errors
    /// If it cannot be read to its end.
    pub(crate) fn of_table(table: Table, want: &Want) -> Result<Self, Diagnostics> {
        let name = Arc::clone(&table.name);
        let unreadable = |error: std::io::Error| Diagnostic::unreadable(&name, &error);
        let contract = table.pieces.contract();
        let layout = Arc::clone(&contract.layout);
        let units: Vec<_> =
            table.columns.iter().map(|column| (column.place, column.unit_said(&contract.titles))).collect();
        let owners: Vec<Option<Owner>> = contract.owners.iter().copied().map(Some).collect();
        let rules = Rules { layout: Arc::clone(&want.layout), list: Vec::new() };
        let mut proposal = Self { file: name.to_string(), rules, parts: Some(0), ..Self::default() };
        let found = Found { owners: &owners, titles: &contract.titles, units: &units, of: &contract.of };
        proposal.columns = columns(&found, &layout);
        proposal.columns.retain(|column| !column.title.is_empty());
        proposal.rules.list = rules::pinned(&found, &layout);
        let (mut reading, refuses_repeats) = (table.reading.clone(), table.refuses_repeats);
        let (mut shapes, mut odd, mut doubtful) = (Shapes::default(), Vec::new(), vec![0; layout.ignore_lines.len()]);
        let mut beyond = 0;
        for block in table.rows(Wanted::default()) {
            let block = block.map_err(unreadable)?;
            proposal.count_rows(&block, &mut shapes);
            block.tell(&mut reading);
            for (rule, _, text) in block.doubtful {
                let LineRule { pattern, at_most } = &layout.ignore_lines[rule];
                doubtful[rule] += 1;
                let more = (doubtful[rule] > *at_most).then(|| rules::one_more(pattern.text(), &text));
                proposal.rules.list.extend(more);
            }
            if let Some(Contradiction { line, message, help, .. }) = block.contradiction {
                let what = format!("line {line}: {message}");
                proposal.open.push(Open::Wrong { what, help: help.to_owned() });
            }
            // a contract has no more rules than these
            let room = MOST_RULES - odd.len();
            beyond += block.odd.len().saturating_sub(room);
            odd.extend(block.odd.into_iter().take(room));
        }
        if refuses_repeats {
            proposal.tell_repeats(&shapes);
        }
        let (parts, named) = (proposal.parts.unwrap_or(0), odd.iter().filter(|odd| !odd.is_no_name).count() + beyond);
        if parts == 0 || parts < named as u64 {
            // the names of the few rows that can be read do not tell which of the others are parts: no rule leaves these out
            let which = if parts == 0 { "no row is a part" } else { "most rows are no parts" };
            let why = proposal.rejected.first().map_or_else(String::new, |first| format!(": {first}"));
            proposal.open.push(Open::Wrong { what: format!("{which}{why}"), help: String::new() });
            odd.retain(|odd| odd.is_no_name);
            proposal.rules.list.clear();
        }
        for Odd { line, text, .. } in odd.iter().filter(|odd| rules::of_odd(odd, &shapes).is_some()) {
            proposal.lines.push(LineAccount { place: format!("line {line}"), text: text.clone(), is: REJECTED });
        }
        proposal.more += if proposal.lines.is_empty() { 0 } else { beyond };
        proposal.rules.list.extend(odd.iter().filter_map(|odd| rules::of_odd(odd, &shapes)));
        rules::settle(&mut proposal.rules.list);
        proposal.reading = Some(reading);
        proposal.closes = proposal.is_closed();
        Ok(proposal)
    }

    /// Tells that a part is there more than once, with the choices.
    fn tell_repeats(&mut self, shapes: &Shapes) {
        let Some(twice) = &shapes.twice else { return };
        let what = format!("the part `{}` is there more than once", shown(twice));
        self.open.push(Open::Wrong { what, help: "say whether each is judged, or the last".to_owned() });
        self.rules.list.extend(rules::repeats());
        self.rules.list.extend(shapes.words.iter().map(|(name, count)| rules::named(name, *count)));
    }

    fn count_rows(&mut self, block: &Block, shapes: &mut Shapes) {
        const SHOWN: usize = 5;
        let rejected = block.rejected_rows();
        *self.parts.get_or_insert(0) += (block.rows() - rejected.len()) as u64;
        shapes.add(block, &rejected);
        let room = SHOWN.saturating_sub(self.rejected.len());
        let faults = block.faults().iter().take(room);
        self.rejected.extend(faults.map(|fault| format!("line {}: {}", block.lines[fault.row], fault.message)));
    }

    /// Adds characteristics without an owner, and such columns of their table.
    fn add_unowned(&mut self) {
        let known: HashSet<_> = self.columns.iter().map(|known| (known.place, known.title.clone())).collect();
        for open in &self.open {
            let (place, title, first) = match open {
                Open::Column { place, title, first, .. } => (Some(place + 1), title, first),
                Open::Characteristic { title, first } => (None, title, first),
                _ => continue,
            };
            if place.is_none() || !known.contains(&(place, title.clone())) {
                let (title, is, why) = (title.clone(), NOT_OWNED.to_owned(), "nobody".to_owned());
                self.columns.push(ColumnAccount { title, place, is, unit: None, why, first: first.clone() });
            }
        }
    }

    /// What else stands in the way, a sentence each.
    pub fn obstacles(&self) -> impl Iterator<Item = String> {
        let is_listed = |open: &&Open| {
            matches!(
                open,
                Open::Column { .. }
                    | Open::Characteristic { .. }
                    | Open::Line { .. }
                    | Open::Row(_)
                    | Open::Comment { .. }
            )
        };
        self.open.iter().filter(move |open| !is_listed(open)).map(Open::in_words)
    }

    /// Whether no column is known as that of values, or may be one.
    fn leaves_nothing(&self) -> bool {
        self.open.iter().any(|open| matches!(open, Open::NoValues { .. }))
            && !self.rules.list.iter().any(|known| matches!(known.rule, Rule::Column { .. }))
    }

    /// Whether no column is known or guessed as that of values: without one, nothing more can be found.
    #[must_use]
    pub fn lacks_values(&self) -> bool {
        let is_value = |known: &Suggestion| {
            matches!(&known.rule, Rule::Column { key, .. } if DeviationKind::ALL.iter().any(|kind| kind.key() == key))
                && matches!(known.certainty, Certainty::Exact | Certainty::Guess(_))
        };
        self.open.iter().any(|open| matches!(open, Open::NoValues { .. })) && !self.rules.list.iter().any(is_value)
    }

    /// The same for a text. Where it is no table, but has values behind their names, the remedy is the table of these values.
    pub(crate) fn of_text(self, text: &str) -> Self {
        let Some(table) = Some(text).filter(|_| self.leaves_nothing()).and_then(table_in_sentences) else {
            return self;
        };
        let lines: Vec<_> = table.lines().map(|line| format!("`{line}`")).collect();
        let what = "values stand behind their names, and not below headings".to_owned();
        let open = Open::Wrong { what, help: format!("give them as a table: {}", lines.join(", and below it ")) };
        let rules = Rules { list: Vec::new(), ..self.rules };
        Self { open: vec![open], lines: Vec::new(), more: 0, rules, ..self }
    }

    /// Whether everything has an owner.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.open.is_empty() && self.lines.is_empty()
    }

    /// The `[table]` that closes the table.
    #[must_use]
    pub fn block(&self, guesses: Guesses) -> String {
        self.rules.block(guesses)
    }

    /// How many rules it would add to the contract.
    #[must_use]
    pub fn count(&self) -> usize {
        self.rules.list.len()
    }

    /// Adds what is found once the contract says what this proposes.
    pub fn join_next(&mut self, next: Self) {
        self.closes = next.is_closed();
        if self.columns.is_empty() {
            self.columns = next.columns;
        }
        let known: HashSet<LineAccount> = self.lines.iter().cloned().collect();
        self.lines.extend(next.lines.into_iter().filter(|line| !known.contains(line)));
        (self.parts, self.rejected) = (next.parts, next.rejected);
        // what only the proposal would leave out has no owner yet
        let own: Vec<String> = self.rules.layout.rules().into_iter().map(|known| known.rule).collect();
        self.reading = next.reading.map(|mut reading| {
            reading.left_out.retain(|rule| own.contains(&rule.rule));
            reading
        });
        self.rules.list.extend(next.rules.list);
        rules::settle(&mut self.rules.list);
        // what both have is listed once
        if !next.closes {
            let known: HashSet<String> = self.open.iter().map(Open::in_words).collect();
            self.open.extend(next.open.into_iter().filter(|open| !known.contains(&open.in_words())));
        }
    }

    /// Marks a guess as confirmed by a person. Returns whether there is such a guess.
    pub fn accept(&mut self, key: &str, column: &str) -> bool {
        rules::accept(&mut self.rules.list, key, column)
    }

    /// What would close several files by one contract; lines are generalised where the files differ.
    #[must_use]
    pub fn joined(proposals: &[Self]) -> Self {
        let mut each = proposals.iter().cloned();
        let mut all = each.next().unwrap_or_default();
        for other in each {
            rules::generalise(&mut all.rules.list, other.rules.list, &other.file);
        }
        all
    }
}

/// The account of a line or a comment without an owner.
fn line_account(open: &Open) -> Option<LineAccount> {
    let (place, text) = match open {
        Open::Line { line, text, .. } | Open::Row(Odd { line, text, .. }) => (format!("line {line}"), text),
        Open::Comment { place, text } => (place.clone(), text),
        _ => return None,
    };
    Some(LineAccount { place, text: text.clone(), is: NOT_OWNED })
}

/// What each column is taken as.
fn columns(Found { owners, titles, units, of }: &Found<'_>, layout: &Layout) -> Vec<ColumnAccount> {
    let rules = layout.rules();
    let why = |title: &str, name: &str, form: Form| {
        let is_key = || lookup(Form::Parts, name).is_some_and(|meaning| meaning.is_key);
        let why = match () {
            () if layout.declared(title, name, form).is_some() => "the spec names it",
            () if is_key() => "it is the key",
            () => "its whole heading is known",
        };
        why.to_owned()
    };
    let owned = |owner: Option<Owner>, title: &str, form: Form| match owner {
        None => (NOT_OWNED.to_owned(), "nobody".to_owned()),
        Some(Owner::Nameless) => ("nothing".to_owned(), "it has no heading".to_owned()),
        Some(Owner::Rule(rule)) => ("left out".to_owned(), rules[rule].rule.clone()),
        Some(Owner::Role(role)) => (key(role), why(title, &Heading::of(title).name, form)),
    };
    let of = of.iter().map(|Named { place, title, owner, first }| {
        let (is, why) = owned(Some(*owner), &title[..], Form::Characteristics);
        let (title, place, first) = (title.clone(), place.map(|place| place + 1), first.clone());
        ColumnAccount { title, place, is, unit: None, why, first }
    });
    let column = |(at, (owner, title)): (usize, (&Option<Owner>, &String))| {
        let (is, why) = owned(*owner, title, Form::Teeth);
        let unit = units.iter().find(|(place, _)| *place == at).map(|(_, unit)| unit.to_string());
        ColumnAccount { title: title.clone(), place: Some(at + 1), is, unit, why, first: Vec::new() }
    };
    of.chain(owners.iter().zip(*titles).enumerate().map(column)).collect()
}
