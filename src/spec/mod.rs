//! The gear spec: TOML as written ([`Spec`]), and what it means ([`Spec::part_deviations`],
//! [`Spec::limits`]).
//!
//! Every key is declared once, in [`mod@keys`], with the type of its value, and [`Spec::get`] has the value of a key.
//! The command line reads a file and calls [`Spec::parse`]. Parsing checks each value of the file by itself, compares values
//! that are given twice, and reports every problem at once, with its place. Resolution asks for the keys that a result needs;
//! only then is a key required. Nothing below this module knows TOML.

mod basis;
mod batch;
mod budget;
mod circle;
mod class;
mod deviations;
mod errors;
mod found;
pub mod keys;
mod limits;
mod measured;
mod mesh;
mod obtained;
mod pair;
mod plausible;
mod qdas;
mod reader;
mod reference;
mod resolve;
mod scatter;
mod schema;
mod set;
mod simulation;
mod table;
mod template;
mod uncertainty;
mod value;
mod vary;
mod written;
mod yoke;

pub use basis::GEOMETRY_KEYS;
pub use batch::{BatchColumn, TableSection};
pub use budget::{BudgetSection, WrittenTolerance};
pub use circle::PitchCircle;
pub use errors::WrittenError;
pub use mesh::{MeasuredTables, MeshInput, Origin};
pub use obtained::MeasuredValue;
pub use reference::{KeyEntry, keys};
pub use scatter::{ScatterSection, WrittenSpread};
pub use schema::json_schema;
#[cfg(feature = "cli")]
pub(crate) use set::SET;
pub use template::TEMPLATE;
pub use uncertainty::WrittenCorrelation;
pub use value::{KeyType, Value, Values};
pub use vary::SolvedTeeth;

use std::ops::Range;
use std::sync::Arc;

use toml::de::{DeTable, DeValue};

use found::Found;

use crate::deviation::{DeviationKind, DeviationValue, Extent, PinionDeviation, RackDeviation};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Place, Source};
use crate::function::{Bounds, Target};
use crate::judge::bound::KnownTeeth;
use crate::judge::{Limit, LimitTarget};
use crate::multibody::Parameters;
use crate::quantity::{Length, shown};
use crate::uncertainty::{Influence, TeethSensitivity, Uncertainty};
use keys::{SECTIONS, Section};
use reader::SectionReader;

/// A value and where it was written.
#[derive(Debug, Clone, Default)]
pub struct Located<T> {
    /// The value.
    pub value: T,
    /// The bytes of the spec that hold it.
    pub span: Range<usize>,
}

impl<T> Located<T> {
    /// Maps the value and keeps its place.
    pub(crate) fn map<U>(self, of: impl FnOnce(T) -> U) -> Located<U> {
        Located { value: of(self.value), span: self.span }
    }
}

/// The entry for one key in a list, such as a kind of error, if there is one.
pub(crate) fn said_of<K: Copy + PartialEq, T>(entries: &[(K, T)], of: K) -> Option<&T> {
    entries.iter().find(|(other, _)| *other == of).map(|(_, said)| said)
}

/// A spec as it was written: every value valid by itself, nothing required yet.
#[derive(Debug, Clone, Default)]
pub struct Spec {
    /// The text.
    pub source: Arc<Source>,
    /// Keys set in place of those of the text.
    pub settings: Vec<String>,
    /// `title`.
    pub title: Option<String>,
    /// The keys that hold one value each, without those of `[table]`.
    pub values: Values,
    /// `[[rack.deviation]]`
    pub rack_deviations: Vec<Located<RackDeviation>>,
    /// `[[pinion.deviation]]`
    pub pinion_deviations: Vec<Located<PinionDeviation>>,
    /// `[budget]`.
    pub budget: BudgetSection,
    /// `[errors]`, in the paper's order.
    pub errors: Vec<(DeviationKind, Located<WrittenError>)>,
    /// The nominal values that `[errors]` gives, with a measured value or alone: then a batch or a pasted block
    /// holds the measured ones.
    pub nominals: Vec<(DeviationKind, Located<DeviationValue>)>,
    /// The entries of `[errors]` that give only the uncertainty of values to come from a batch or a pasted block.
    pub unmeasured: Vec<(DeviationKind, Range<usize>)>,
    /// The entries of `[errors]` with `every_part = true`: their value holds for every part of a batch or a pasted block.
    pub every_part: Vec<DeviationKind>,
    /// On which teeth errors are, where `[errors]` says so.
    pub extents: Vec<(DeviationKind, Located<Extent>)>,
    /// The diameter of the circle on which the pitch of the pinion in `[errors]` was measured.
    pub measured_at: Option<Located<Length>>,
    /// The circle on which values of a table were measured, once the spec is read.
    pub pitch_circle: Option<PitchCircle>,
    /// The circle of the arcs of `pinion.measured`, once the spec is read.
    pub arc_circle: Option<PitchCircle>,
    /// The length over which `[errors]` evaluates f_Hβ.
    pub evaluation_length: Option<Length>,
    /// `[limits]`.
    pub limits: Vec<(LimitTarget, Located<Limit>)>,
    /// `[limits]` on a yoke.
    pub function_limits: Vec<(Target, Located<Bounds>)>,
    /// `[table]`.
    pub table: TableSection,
    /// `[simulation]`: everything but how the rack may roll, which `[support]` says.
    pub simulation: Parameters,
    /// `[scatter]`.
    pub scatter: ScatterSection,
    /// The uncertainties, wherever they stand.
    pub uncertainties: Vec<(Influence, Located<Uncertainty>)>,
    /// The errors whose uncertainty comes from their own readings.
    pub of_readings: Vec<DeviationKind>,
    /// `[[correlation]]`
    pub correlations: Vec<Located<WrittenCorrelation>>,
    /// The effect of teeth that are known one by one, once their mesh is solved: see [`Spec::with_known_teeth`].
    pub known_teeth: Option<KnownTeeth>,
    /// The derivatives of that effect by uncertain values.
    pub teeth_sensitivities: Vec<TeethSensitivity>,
    /// The measured tables of these teeth.
    pub measured: Arc<MeasuredTables>,
    /// Measured quantities of these teeth without an uncertainty.
    pub teeth_taken_as_exact: Vec<DeviationKind>,
}

impl Spec {
    /// Reads a spec; messages call it `name`.
    ///
    /// # Errors
    /// Every problem found in the text: syntax, unknown keys, wrong types, values outside their domain.
    pub fn parse(name: &str, text: &str) -> Result<Self, Diagnostics> {
        Self::parse_with(name, text, &[])
    }

    /// Reads a spec with keys set: each of `settings` is `key=value`, such as `errors.rack_pitch=12um`, and replaces the value in
    /// the text or adds the key. A value is TOML if it reads as TOML, else text.
    ///
    /// # Errors
    /// As [`parse`](Self::parse); and settings without a value, of a key that is set twice, or within a value that is no table.
    pub fn parse_with(name: &str, text: &str, settings: &[String]) -> Result<Self, Diagnostics> {
        // some editors write a byte order mark, which is no part of the text
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        refuse_size(name, text.as_bytes())?;
        let source = Arc::new(Source { next: set::options(settings), ..Source::new(name, text) });
        let mut diagnostics = Found::default();
        let read = set::settings(settings, text.len());
        let (table, is_called_batch) = top(text, &read, &source, &mut diagnostics)?;
        let mut spec = Self::read(&table, &source, &mut diagnostics);
        spec.table.is_called_batch = is_called_batch;
        spec.settings = settings.to_vec();
        pair::complete(&mut spec.values, &source, &mut diagnostics);
        if diagnostics.is_empty() {
            diagnostics.extend(spec.scale_to_reference_circle().err().into_iter().flat_map(|problems| problems.0));
        }
        if diagnostics.is_empty() {
            let impossible = spec.impossibilities();
            if impossible.is_empty() { Ok(spec) } else { Err(Diagnostics(impossible)) }
        } else {
            let place = |place: &Place| (!Arc::ptr_eq(&place.source, &source), place.span.start);
            Err(Diagnostics(diagnostics.sorted(|diagnostic| diagnostic.place.as_ref().map(place))))
        }
    }

    /// Reads every section as far as it can be read.
    fn read(top: &DeTable<'_>, source: &Arc<Source>, diagnostics: &mut Found) -> Self {
        let mut spec = Self { source: Arc::clone(source), ..Self::default() };
        let mut uncertainties = Vec::new();
        let mut sections =
            SectionReader { source, section: &keys::TOP, table: top, diagnostics, uncertainties: &mut uncertainties };
        sections.refuse_unknown_sections();
        spec.title = sections.get(keys::TITLE).map(|title| title.value);
        spec.correlations = uncertainty::correlations(&mut sections);
        sections.read(&keys::PAIR, |reader| reader.values(&mut spec.values));
        sections.read(&keys::RACK, |reader| {
            reader.values(&mut spec.values);
            spec.rack_deviations = deviations::rack(reader);
        });
        sections.read(&keys::PINION, |reader| {
            reader.values(&mut spec.values);
            spec.pinion_deviations = deviations::pinion(reader);
        });
        for section in [&keys::SUPPORT, &keys::TOLERANCE, &keys::DECISION, &keys::REPORT] {
            sections.read(section, |reader| reader.values(&mut spec.values));
        }
        sections.diagnostics.extend(spec.roll_axis_alone());
        sections.read(&keys::ERRORS, |reader| errors::read(reader, &mut spec));
        table::read(&mut sections, &mut spec);
        sections.diagnostics.extend(spec.other_extents());
        sections.read(&keys::BUDGET, |reader| {
            reader.values(&mut spec.values);
            spec.budget = budget::read(reader);
        });
        sections.read(&keys::LIMITS, |reader| {
            spec.limits = limits::read(reader);
            spec.function_limits = yoke::limits(reader);
        });
        sections.read(&keys::YOKE, |reader| reader.values(&mut spec.values));
        sections.diagnostics.extend(spec.yoke_contradictions());
        sections.read(&keys::SIMULATION, |reader| spec.simulation = simulation::read(reader, &mut spec.values));
        sections.read(&keys::SCATTER, |reader| spec.scatter = scatter::read(reader));
        spec.uncertainties = uncertainties;
        spec
    }
}

impl SectionReader<'_> {
    /// Reports keys at the top of the spec that it does not have, or that are not sections.
    fn refuse_unknown_sections(&mut self) {
        let sections = SECTIONS.iter().map(|section| section.name);
        let own = keys::TOP.keys.iter().map(keys::AnyKey::name);
        let mut entries: Vec<_> = self.table.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        for (key, value) in entries {
            let name = key.get_ref().as_ref();
            let is_table = matches!(value.get_ref(), DeValue::Table(_));
            let is_section = sections.clone().any(|section| section == name);
            if (is_section && is_table) || own.clone().any(|own| own == name) {
                continue;
            }
            let diagnostic = || {
                if is_section {
                    let found = reader::type_in_words(value.get_ref());
                    return Diagnostic::error(Code::WrongType, format!("`{name}` is {found}; it must be a section"))
                        .help(format!("write its keys under a line `[{name}]`"));
                }
                let message = format!("there is no {} `{}`", if is_table { "section" } else { "key" }, shown(name));
                let all = || sections.clone().map(|name| format!("[{name}]")).collect::<Vec<_>>().join(" ");
                let help = || reader::elsewhere(name).unwrap_or_else(|| format!("the sections are {}", all()));
                reader::unknown(message, name, sections.clone().chain(own.clone()), help)
            };
            self.diagnostics.add(|| diagnostic().at(self.source, key.span(), ""));
        }
    }

    /// Reads a section, if it is there; a section that is not a table is reported as unknown.
    fn read(&mut self, section: &'static Section, read: impl FnOnce(&mut SectionReader<'_>)) {
        if let Some(table) = self.entry(section.name) {
            self.inner(section, table, read);
        }
    }
}

/// The table of a spec's text with its settings, and whether `[table]` has its old name.
fn top<'t>(
    text: &'t str,
    settings: &'t [set::Setting<'_>],
    source: &Arc<Source>,
    found: &mut Found,
) -> Result<(DeTable<'t>, bool), Diagnostics> {
    let (table, errors) = DeTable::parse_recoverable(text);
    if let Some(error) = errors.first() {
        return Err(syntax_error(source, error).into());
    }
    let mut table = table.into_inner();
    found.extend(set::set_all(&mut table, settings, source));
    let is_called_batch = table::renamed(&mut table, source, found);
    Ok((table, is_called_batch))
}

/// The largest spec in bytes: far beyond any that a person writes.
pub const LARGEST_SPEC: usize = 4 << 20;

/// Refuses a spec by its size: its bytes, and the memory that its keys and values would take.
///
/// # Errors
/// If it has more than [`LARGEST_SPEC`] bytes, or more keys and values than a person writes.
pub fn refuse_size(name: &str, text: &[u8]) -> Result<(), Diagnostic> {
    /// The most bytes of memory that one mark of TOML needs: a key with its value, a part of a key, an entry of a list, half of a
    /// heading, a table in a line.
    const MARKS: [(u8, usize); 5] = [(b'=', 450), (b'.', 140), (b',', 150), (b'[', 610), (b'{', 1220)];
    const MOST: usize = 110_000_000;
    let memory = || -> usize {
        let mut counts = [0_usize; 256];
        for byte in text {
            counts[usize::from(*byte)] += 1;
        }
        MARKS.iter().map(|(mark, bytes)| counts[usize::from(*mark)] * bytes).sum()
    };
    let problem = match text.len() > LARGEST_SPEC {
        true => "it is larger than 4 MiB",
        false if memory() > MOST => "its keys and values would take more than 110 MB of memory",
        false => return Ok(()),
    };
    Err(Diagnostic::unreadable(name, &problem).help("values of many teeth stand in a table: `measured = \"FILE\"`"))
}

/// What to do where a spec is something else.
pub const NOT_A_SPEC: &str =
    "a spec is a TOML file, such as `rackmesh init` writes; tables stand behind it: `rackmesh batch SPEC TABLE`";

/// Whether the first line of a text that is no TOML looks like a row of a table.
fn is_table(text: &str) -> bool {
    let first = text.lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or_default();
    first.contains([',', ';', '\t']) && !first.contains('=') && !first.starts_with(['#', '['])
}

/// Whether a number with a decimal comma stands at a place of a text: `25,013`.
fn is_decimal_comma(text: &str, at: usize) -> bool {
    let is_part = |c: char| c.is_ascii_digit() || c == ',';
    let Some((before, after)) = text.split_at_checked(at) else { return false };
    let word = before.trim_end();
    let start = word.trim_end_matches(is_part).len();
    let end = after.find(|c| !is_part(c)).unwrap_or(after.len());
    if end == 0 && after.starts_with(|c: char| c.is_alphanumeric() || c == '"') {
        return false;
    }
    let number = if end > 0 { text.get(start..at + end).unwrap_or_default() } else { &word[start..] };
    let is_number = |part: &str| !part.is_empty() && !part.contains(',');
    number.trim_end_matches(',').split_once(',').is_some_and(|(whole, rest)| is_number(whole) && is_number(rest))
}

/// A syntax error, with a word on a table in place of a spec, and on the two slips that spreadsheet and drawing users make.
fn syntax_error(source: &Arc<Source>, error: &toml::de::Error) -> Diagnostic {
    let text = &source.text;
    if is_table(text) {
        let message = format!("{} is a table, and not a spec", source.name);
        return Diagnostic::error(Code::TomlSyntax, message).help(NOT_A_SPEC).about(&source.name);
    }
    let span = error.span().unwrap_or(0..0);
    let diagnostic = Diagnostic::error(Code::TomlSyntax, error.message());
    let start = text.get(..span.start).and_then(|before| before.rfind('\n')).map_or(0, |newline| newline + 1);
    let line = text.get(start..).and_then(|rest| rest.lines().next()).unwrap_or_default();
    let is_number = |value: &str| value.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | '±'));
    let diagnostic = if is_decimal_comma(text, span.start) {
        diagnostic.help("numbers take a decimal point, not a comma")
    } else if line.split_once('=').is_some_and(|(_, value)| is_number(value.trim())) {
        diagnostic.help("a value that is more than a number needs quotes: \"20 um\"")
    } else {
        diagnostic
    };
    diagnostic.at(source, span, "")
}
