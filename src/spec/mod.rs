//! The gear spec: TOML as written ([`Spec`]), and what it means ([`Spec::part_errors`],
//! [`Spec::limits`]).
//!
//! The command line reads a file and calls [`Spec::parse`]. Parsing checks what stands in the file,
//! each value by itself, and reports every problem at once, with its place. Resolution asks for what a
//! result needs, and only then is a key required. Nothing below this module knows TOML.

mod batch;
mod budget;
mod class;
mod deviations;
mod keys;
mod measured;
mod mesh;
mod obtained;
mod qdas;
mod reader;
mod resolve;
mod scatter;
mod schema;
mod simulation;
mod template;
mod uncertainty;

pub use batch::{BatchColumn, BatchSection, Reading};
pub use budget::{BudgetSection, WrittenTolerance};
pub use class::ToleranceSection;
pub use deviations::{TipRelief, WrittenPinionDeviation};
pub use mesh::{MeasuredTables, MeshInput, Origin};
pub use obtained::MeasuredValue;
pub use scatter::{ScatterSection, WrittenSpread};
pub use schema::json_schema;
pub use simulation::SimulationSection;
pub use template::TEMPLATE;
pub use uncertainty::WrittenCorrelation;

use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::decision::uncertainty as uncertain;
use crate::decision::{Limit, LimitTarget, Rule};
use crate::deviation::{ErrorKind, ErrorValue, RackDeviation};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Source};
use crate::formula::RackLead;
use crate::quantity::{Angle, Length};
use keys::{Kind, SECTIONS, Section};
use reader::{SectionReader, similar};

/// A value and where it was written.
#[derive(Debug, Clone)]
pub struct Located<T> {
    /// The value.
    pub value: T,
    /// The bytes of the spec that hold it.
    pub span: Range<usize>,
}

/// A spec as it was written: every value valid by itself, nothing required yet.
#[derive(Debug, Clone)]
pub struct Spec {
    /// The text.
    pub source: Arc<Source>,
    /// `title`.
    pub title: Option<String>,
    /// `[pair]`.
    pub pair: PairSection,
    /// `[rack]`.
    pub rack: RackSection,
    /// `[pinion]`.
    pub pinion: PinionSection,
    /// `[support]`.
    pub support: SupportSection,
    /// `[tolerance]`.
    pub tolerance: ToleranceSection,
    /// `[budget]`.
    pub budget: BudgetSection,
    /// `[errors]`, in the paper's order.
    pub errors: Vec<(ErrorKind, Located<WrittenError>)>,
    /// The nominal values that `[errors]` gives, with a measured value or alone: then a batch or a pasted block
    /// holds the measured ones.
    pub nominals: Vec<(ErrorKind, Located<ErrorValue>)>,
    /// The entries of `[errors]` that give nothing but the uncertainty of values to come from a batch or a pasted block.
    pub unmeasured: Vec<(ErrorKind, Range<usize>)>,
    /// `[limits]`.
    pub limits: Vec<(LimitTarget, Located<Limit>)>,
    /// `[batch]`.
    pub batch: BatchSection,
    /// `[simulation]`.
    pub simulation: SimulationSection,
    /// `[scatter]`.
    pub scatter: ScatterSection,
    /// `decision.rule`.
    pub rule: Option<Located<Rule>>,
    /// The uncertainties, wherever they stand.
    pub uncertainties: Vec<(uncertain::Source, Located<uncertain::Uncertainty>)>,
    /// `[[correlation]]`
    pub correlations: Vec<Located<WrittenCorrelation>>,
}

/// `[pair]`: what rack and pinion have in common.
#[derive(Debug, Clone, Default)]
pub struct PairSection {
    /// m_n
    pub normal_module: Option<Located<Length>>,
    /// α_n
    pub normal_pressure_angle: Option<Located<Angle>>,
}

/// `[rack]`: nominal geometry of the rack.
#[derive(Debug, Clone, Default)]
pub struct RackSection {
    /// β_r
    pub helix_angle: Option<Located<Angle>>,
    /// k
    pub face_width: Option<Located<Length>>,
    /// h_a
    pub addendum: Option<Located<Length>>,
    /// s_n
    pub tooth_thickness: Option<Located<Length>>,
    /// K
    pub datum: Option<Located<Length>>,
    /// L
    pub toothed_length: Option<Located<Length>>,
    /// Diameter of the pin behind measured over-pin values.
    pub pin: Option<Located<Length>>,
    /// Table of measured spaces.
    pub measured: Option<Located<String>>,
    /// `[[rack.deviation]]`
    pub deviations: Vec<Located<RackDeviation>>,
    /// Lead crowning.
    pub crowning: Option<Located<Length>>,
    /// Tip relief.
    pub tip_relief: Option<Located<TipRelief>>,
}

/// `[pinion]`: nominal geometry of the pinion.
#[derive(Debug, Clone, Default)]
pub struct PinionSection {
    /// z
    pub teeth: Option<Located<u32>>,
    /// β_p
    pub helix_angle: Option<Located<Angle>>,
    /// x
    pub profile_shift: Option<Located<f64>>,
    /// b
    pub face_width: Option<Located<Length>>,
    /// d_a
    pub tip_diameter: Option<Located<Length>>,
    /// d_Ff
    pub root_form_diameter: Option<Located<Length>>,
    /// Deviation of the transverse tooth thickness at the reference circle.
    pub tooth_thickness_deviation: Option<Located<Length>>,
    /// Table of measured teeth.
    pub measured: Option<Located<String>>,
    /// `[[pinion.deviation]]`
    pub deviations: Vec<Located<WrittenPinionDeviation>>,
    /// Lead crowning.
    pub crowning: Option<Located<Length>>,
    /// Profile slope.
    pub profile_slope: Option<Located<Length>>,
}

/// `[support]`: how the rack is held.
#[derive(Debug, Clone, Default)]
pub struct SupportSection {
    /// `fixed` or `free`.
    pub roll: Option<Located<&'static str>>,
    /// How far the roll axis lies below the reference plane.
    pub roll_axis_depth: Option<Located<Length>>,
}

/// An entry of `[errors]`, as far as it can be understood without the gear data.
#[derive(Debug, Clone)]
pub enum WrittenError {
    /// A deviation in length, given or measured minus nominal.
    Length(Length),
    /// A deviation in angle.
    Angle(Angle),
    /// An over-roller measure whose nominal is to be computed.
    OverRoller {
        /// The measure M.
        measured: Length,
        /// The roller's diameter.
        roller: Length,
    },
    /// A grade of the standard in `[tolerance]`.
    Class(u8),
}

impl Spec {
    /// Reads a spec; `name` is what messages call it.
    ///
    /// # Errors
    /// Every problem found in the text: syntax, unknown keys, wrong types, values outside their domain.
    pub fn parse(name: &str, text: &str) -> Result<Self, Diagnostics> {
        // a byte order mark, as some editors write, is no part of the text
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let source = Arc::new(Source { name: name.to_owned(), text: text.to_owned() });
        let mut diagnostics = Vec::new();
        let (table, errors) = DeTable::parse_recoverable(text);
        if let Some(error) = errors.first() {
            return Err(syntax_error(&source, error).into());
        }
        let table = table.into_inner();
        let mut uncertainties = Vec::new();
        let mut sections =
            Sections { source: &source, top: &table, diagnostics: &mut diagnostics, uncertainties: &mut uncertainties };
        sections.refuse_unknown();
        let (title, correlations) =
            sections.read(&keys::TOP, |reader| (reader.text("title"), uncertainty::correlations(reader)));
        let pair = sections.read(&keys::PAIR, |reader| PairSection {
            normal_module: reader.length("normal_module"),
            normal_pressure_angle: reader.angle("normal_pressure_angle"),
        });
        let rack = sections.read(&keys::RACK, |reader| RackSection {
            helix_angle: reader.angle("helix_angle"),
            face_width: reader.length("face_width"),
            addendum: reader.length("addendum"),
            tooth_thickness: reader.length("tooth_thickness"),
            datum: reader.length("datum"),
            toothed_length: reader.length("toothed_length"),
            pin: reader.length("pin"),
            measured: reader.file("measured"),
            deviations: deviations::rack(reader),
            crowning: reader.length("crowning"),
            tip_relief: deviations::tip_relief(reader),
        });
        let pinion = sections.read(&keys::PINION, |reader| PinionSection {
            teeth: reader.count("teeth"),
            helix_angle: reader.angle("helix_angle"),
            profile_shift: reader.number("profile_shift"),
            face_width: reader.length("face_width"),
            tip_diameter: reader.length("tip_diameter"),
            root_form_diameter: reader.length("root_form_diameter"),
            tooth_thickness_deviation: reader.length("tooth_thickness_deviation"),
            measured: reader.file("measured"),
            deviations: deviations::pinion(reader),
            crowning: reader.length("crowning"),
            profile_slope: reader.length("profile_slope"),
        });
        let support = sections.read(&keys::SUPPORT, |reader| SupportSection {
            roll: reader.word("roll"),
            roll_axis_depth: reader.length("roll_axis_depth"),
        });
        let budget = sections.read(&keys::BUDGET, budget::read);
        let tolerance = sections.read(&keys::TOLERANCE, |reader| ToleranceSection {
            standard: reader.standard("standard"),
            diameter: reader.rack_diameter("diameter"),
        });
        let (errors, nominals, unmeasured) = sections.read(&keys::ERRORS, read_errors);
        let limits = sections.read(&keys::LIMITS, |reader| {
            let targets = ErrorKind::ALL.into_iter().map(LimitTarget::Error);
            std::iter::once(LimitTarget::CenterDistance)
                .chain(targets)
                .filter_map(|target| Some((target, read_limit(reader, target.key())?)))
                .collect()
        });
        let batch = sections.read(&keys::BATCH, batch::read);
        let simulation = sections.read(&keys::SIMULATION, simulation::read);
        let scatter = sections.read(&keys::SCATTER, scatter::read);
        let rule = sections.read(&keys::DECISION, |reader| reader.rule("rule"));
        if diagnostics.is_empty() {
            Ok(Self {
                source,
                title,
                pair,
                rack,
                pinion,
                support,
                tolerance,
                budget,
                errors,
                nominals,
                unmeasured,
                limits,
                batch,
                simulation,
                scatter,
                rule,
                uncertainties,
                correlations,
            })
        } else {
            diagnostics.sort_by_key(|diagnostic| diagnostic.place.as_ref().map(|place| place.span.start));
            Err(Diagnostics(diagnostics))
        }
    }
}

/// The tables of a spec while it is being read.
struct Sections<'a> {
    source: &'a Arc<Source>,
    top: &'a DeTable<'a>,
    diagnostics: &'a mut Vec<Diagnostic>,
    uncertainties: &'a mut Vec<(uncertain::Source, Located<uncertain::Uncertainty>)>,
}

impl Sections<'_> {
    fn refuse_unknown(&mut self) {
        for (key, value) in self.top {
            let name = key.get_ref().as_ref();
            let is_table = matches!(value.get_ref(), DeValue::Table(_));
            let top_names = keys::TOP.keys.iter().map(|key| key.name);
            let section_names = SECTIONS.iter().map(|section| section.name);
            let diagnostic = if SECTIONS.iter().any(|section| section.name == name) {
                if is_table {
                    continue;
                }
                let found = reader::type_in_words(value.get_ref());
                Diagnostic::error(Code::WrongType, format!("`{name}` is {found}; it must be a section"))
                    .help(format!("write its keys under a line `[{name}]`"))
            } else if keys::TOP.keys.iter().any(|key| key.name == name) {
                continue;
            } else {
                let what = if is_table { "section" } else { "key" };
                let diagnostic = Diagnostic::error(Code::UnknownKey, format!("there is no {what} `{name}`"));
                if let Some(similar) = similar(name, section_names.clone().chain(top_names)) {
                    diagnostic.help(format!("did you mean `{similar}`?"))
                } else if let Some(home) =
                    SECTIONS.iter().find(|section| section.keys.iter().any(|key| key.name == name))
                {
                    diagnostic.help(format!("`{name}` is a key of [{}]: write it below that line", home.name))
                } else {
                    let names: Vec<_> = section_names.map(|name| format!("[{name}]")).collect();
                    diagnostic.help(format!("the sections are {}", names.join(" ")))
                }
            };
            self.diagnostics.push(diagnostic.at(self.source, key.span(), ""));
        }
    }

    /// Reads a section; one that is not there is not read at all, which a short spec's start-up gains from.
    fn read<T: Default>(&mut self, section: &'static Section, read: impl FnOnce(&mut SectionReader<'_>) -> T) -> T {
        let table = if section.name.is_empty() {
            Some(self.top)
        } else {
            self.top.get(section.name).and_then(|value| value.get_ref().as_table())
        };
        if table.is_none() {
            return T::default();
        }
        let mut reader = SectionReader {
            source: self.source,
            section,
            table,
            diagnostics: self.diagnostics,
            uncertainties: self.uncertainties,
        };
        if !section.name.is_empty() {
            reader.refuse_unknown_keys();
        }
        read(&mut reader)
    }
}

/// A syntax error, with a word on the two slips that spreadsheet and drawing users make.
fn syntax_error(source: &Arc<Source>, error: &toml::de::Error) -> Diagnostic {
    let span = error.span().unwrap_or(0..0);
    let diagnostic = Diagnostic::error(Code::TomlSyntax, error.message());
    let text = &source.text;
    let start = text.get(..span.start).and_then(|before| before.rfind('\n')).map_or(0, |newline| newline + 1);
    let line = text.get(start..).and_then(|rest| rest.lines().next()).unwrap_or_default();
    let diagnostic = match line.split_once('=').map(|(_, value)| value.trim()) {
        Some(value) if value.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | '±')) => {
            let digits = |c: char| c.is_ascii_digit();
            let comma = value
                .find(',')
                .is_some_and(|comma| value[..comma].ends_with(digits) && value[comma + 1..].starts_with(digits));
            if comma {
                diagnostic.help("numbers take a decimal point, not a comma")
            } else {
                diagnostic.help("a value that is more than a number needs quotes: \"20 um\"")
            }
        }
        _ => diagnostic,
    };
    diagnostic.at(source, span, "")
}

/// The entries of `[errors]`: values, nominal values, and uncertainties of values that stand elsewhere.
type Errors =
    (Vec<(ErrorKind, Located<WrittenError>)>, Vec<(ErrorKind, Located<ErrorValue>)>, Vec<(ErrorKind, Range<usize>)>);

/// Reads `[errors]`.
fn read_errors(reader: &mut SectionReader<'_>) -> Errors {
    let nominals = ErrorKind::ALL.into_iter().filter_map(|kind| Some((kind, read_nominal(reader, kind)?)));
    let nominals: Vec<_> = nominals.collect();
    let unmeasured: Vec<_> =
        ErrorKind::ALL.into_iter().filter_map(|kind| Some((kind, read_unmeasured(reader, kind)?))).collect();
    let alone = |kind| {
        reader.table.and_then(|table| only_nominal(table, kind)).is_some()
            || unmeasured.iter().any(|(other, _)| *other == kind)
    };
    let kinds: Vec<_> = ErrorKind::ALL.into_iter().filter(|kind| !alone(*kind)).collect();
    let errors = kinds.into_iter().filter_map(|kind| Some((kind, read_error(reader, kind)?))).collect();
    (errors, nominals, unmeasured)
}

/// Reads one entry of `[errors]`.
fn read_error(reader: &mut SectionReader<'_>, kind: ErrorKind) -> Option<Located<WrittenError>> {
    let value = reader.table?.get(kind.key())?;
    let written = read_error_value(reader, kind, value)?;
    Some(Located { value: written, span: value.span() })
}

/// Reads the value of an error: a deviation, or a table from which it follows.
fn read_error_value(
    reader: &mut SectionReader<'_>,
    kind: ErrorKind,
    value: &Spanned<DeValue<'_>>,
) -> Option<WrittenError> {
    let name = kind.key();
    let is_angle = kind == ErrorKind::RackLead;
    let written = match value.get_ref() {
        DeValue::Table(entry) => read_error_table(reader, kind, entry, value.span())?,
        _ if is_angle => WrittenError::Angle(reader.angle_value(name, value)?),
        _ => WrittenError::Length(reader.length_value(name, value)?),
    };
    if let WrittenError::Angle(angle) = &written {
        reader.in_domain(crate::formula::domain::LEAD_ERROR.check_angle(angle), value.span())?;
    }
    Some(written)
}

/// The entry of an error that has nothing but a nominal value.
fn only_nominal<'t>(table: &'t DeTable<'_>, kind: ErrorKind) -> Option<&'t DeTable<'t>> {
    let entry = table.get(kind.key())?.get_ref().as_table()?;
    let uncertain = keys::UNCERTAINTY_KEYS.iter().filter(|key| entry.contains_key(**key)).count();
    (entry.len() == 1 + uncertain && entry.contains_key("nominal")).then_some(entry)
}

/// The nominal value in an entry of `[errors]`. A value that cannot be read is reported here if it stands alone, and
/// with the measured one otherwise.
fn read_nominal(reader: &mut SectionReader<'_>, kind: ErrorKind) -> Option<Located<ErrorValue>> {
    let table = reader.table?;
    let entry = table.get(kind.key())?.get_ref().as_table()?;
    let value = entry.get("nominal")?;
    let known = reader.diagnostics.len();
    let nominal = match kind {
        ErrorKind::RackLead => reader.angle_value("nominal", value).map(ErrorValue::Angle),
        _ => reader.length_value("nominal", value).map(ErrorValue::Length),
    };
    if only_nominal(table, kind).is_none() {
        reader.diagnostics.truncate(known);
    } else {
        // the uncertainty of the measured values to come
        let source = uncertain::Source::Error(kind);
        reader.note_uncertainty(kind.key(), entry, value.span(), source, source.is_angle(), 1.0);
    }
    Some(Located { value: nominal?, span: value.span() })
}

/// Reads an entry of an error that has nothing but an uncertainty: where it stands.
fn read_unmeasured(reader: &mut SectionReader<'_>, kind: ErrorKind) -> Option<Range<usize>> {
    let written = reader.table?.get(kind.key())?;
    let entry = written.get_ref().as_table()?;
    let only =
        !entry.is_empty() && entry.iter().all(|(key, _)| keys::UNCERTAINTY_KEYS.contains(&key.get_ref().as_ref()));
    if !only {
        return None;
    }
    let source = uncertain::Source::Error(kind);
    reader.note_uncertainty(kind.key(), entry, written.span(), source, source.is_angle(), 1.0);
    Some(written.span())
}

/// The keys that the table form of an error may have, in the combinations that make an error.
pub(crate) fn error_table_forms(kind: ErrorKind) -> &'static [&'static [&'static str]] {
    match kind {
        ErrorKind::RackOverRoller => {
            &[&["value"], &["measured", "nominal"], &["measured", "roller"], &["nominal"], &["class"]]
        }
        ErrorKind::RackLead => {
            &[&["value"], &["measured", "nominal"], &["f_h_beta", "length"], &["nominal"], &["class"]]
        }
        _ => &[&["value"], &["measured", "nominal"], &["nominal"], &["class"]],
    }
}

/// The coarsest grade of any standard.
pub(crate) const LARGEST_CLASS: u8 = 12;

fn read_error_table(
    reader: &mut SectionReader<'_>,
    kind: ErrorKind,
    entry: &DeTable<'_>,
    span: Range<usize>,
) -> Option<WrittenError> {
    let forms = error_table_forms(kind);
    let mut known = true;
    for (key, _) in entry {
        let name = key.get_ref().as_ref();
        let all = forms.iter().flat_map(|form| form.iter().copied()).chain(keys::UNCERTAINTY_KEYS);
        if !all.clone().any(|candidate| candidate == name) {
            known = false;
            let diagnostic = Diagnostic::error(Code::UnknownKey, format!("`{}` has no key `{name}`", kind.key()));
            let diagnostic = match similar(name, all) {
                Some(similar) => diagnostic.help(format!("did you mean `{similar}`?")),
                None => diagnostic.help(format!("write {}", forms_in_words(forms))),
            };
            reader.report(diagnostic, key.span(), "unknown key");
        }
    }
    if !known {
        return None;
    }
    let uncertain = keys::UNCERTAINTY_KEYS.iter().filter(|key| entry.contains_key(**key)).count();
    let makes = |form: &&&[&str]| form.len() + uncertain == entry.len() && form.iter().all(|k| entry.contains_key(*k));
    let Some(form) = forms.iter().find(makes) else {
        let message = format!("`{}` is a table that makes no error", kind.key());
        let diagnostic =
            Diagnostic::error(Code::BadErrorEntry, message).help(format!("write {}", forms_in_words(forms)));
        reader.report(diagnostic, span, "");
        return None;
    };
    let noted = uncertain::Source::Error(kind);
    if *form == ["class"] {
        if uncertain > 0 {
            let message = format!("`{}` is a class: what is permitted has no measuring uncertainty", kind.key());
            reader.report(Diagnostic::error(Code::BadUncertainty, message), span, "");
            return None;
        }
        return entry.get("class").and_then(|value| reader.class_value(value)).map(WrittenError::Class);
    }
    if *form != ["f_h_beta", "length"] {
        reader.note_uncertainty(kind.key(), entry, span.clone(), noted, noted.is_angle(), 1.0);
    }
    let mut length = |name: &str| reader.length_value(name, entry.get(name)?);
    match form {
        ["f_h_beta", "length"] => {
            let (slope, over) = (length("f_h_beta")?, length("length")?);
            match RackLead::error_from_slope(&slope, &over) {
                Ok(angle) => {
                    // d(atan(f/L))/df = L/(L² + f²)
                    let (f, l) = (slope.mm(), over.mm());
                    let degrees_per_mm = (180.0 / std::f64::consts::PI) * l / (l * l + f * f);
                    reader.note_uncertainty(kind.key(), entry, span, noted, false, degrees_per_mm);
                    Some(WrittenError::Angle(angle))
                }
                Err(error) => {
                    reader.report(Diagnostic::error(Code::OutOfDomain, error.to_string()), span, "");
                    None
                }
            }
        }
        ["measured", "roller"] => {
            let measured = length("measured");
            let roller = entry.get("roller")?;
            let roller = reader.uncertain("roller", roller, Some(uncertain::Source::Roller))?;
            let roller = reader.length_value("roller", roller)?;
            let roller_span = entry.get("roller").map_or(span, Spanned::span);
            reader.in_domain(crate::formula::domain::PIN_DIAMETER.check_length(&roller), roller_span)?;
            Some(WrittenError::OverRoller { measured: measured?, roller })
        }
        ["value"] if kind == ErrorKind::RackLead => {
            Some(WrittenError::Angle(reader.angle_value("value", entry.get("value")?)?))
        }
        ["value"] => Some(WrittenError::Length(length("value")?)),
        _ if kind == ErrorKind::RackLead => {
            let mut angle = |name: &str| reader.angle_value(name, entry.get(name)?);
            let (measured, nominal) = (angle("measured"), angle("nominal"));
            Some(WrittenError::Angle(&measured? - &nominal?))
        }
        _ => {
            let (measured, nominal) = (length("measured"), length("nominal"));
            Some(WrittenError::Length(&measured? - &nominal?))
        }
    }
}

fn forms_in_words(forms: &[&[&str]]) -> String {
    let table = |form: &&[&str]| {
        let keys: Vec<_> = form.iter().map(|name| format!("{name} = …")).collect();
        format!("{{ {} }}", keys.join(", "))
    };
    // a nominal value alone is for tables of measured values, and no error by itself
    let tables: Vec<_> = forms.iter().filter(|form| ***form != ["nominal"]).map(table).collect();
    format!("a deviation, or {}", tables.join(" or "))
}

/// Reads one entry of `[limits]`: `"±0.05"`, or a table with `lower`, `upper` or both.
fn read_limit(reader: &mut SectionReader<'_>, name: &'static str) -> Option<Located<Limit>> {
    debug_assert!(reader.section.keys.iter().any(|key| key.name == name && matches!(key.kind, Kind::Limit)));
    let value = reader.table?.get(name)?;
    let help = "write \"±0.05\", or { lower = -0.05, upper = 0.05 }";
    let bad = |message: String| Diagnostic::error(Code::BadLimit, message).help(help);
    let limit = match value.get_ref() {
        DeValue::String(text) => {
            let magnitude = ["±", "+-", "+/-"].iter().find_map(|sign| text.trim().strip_prefix(sign));
            let Some(magnitude) = magnitude else {
                reader.report(bad(format!("`{name}` is \"{text}\", which is not a limit")), value.span(), "");
                return None;
            };
            match magnitude.parse::<Length>() {
                Ok(magnitude) if !magnitude.is_negative() => Limit::symmetric(&magnitude),
                Ok(_) => {
                    reader.report(bad(format!("`{name}` has two signs")), value.span(), "");
                    return None;
                }
                Err(error) => {
                    reader.report(bad(format!("`{name}`: {error}")), value.span(), "");
                    return None;
                }
            }
        }
        DeValue::Table(ends) => {
            for (key, _) in ends {
                let end = key.get_ref().as_ref();
                if !matches!(end, "lower" | "upper") {
                    let diagnostic =
                        Diagnostic::error(Code::UnknownKey, format!("`{name}` has no key `{end}`")).help(help);
                    reader.report(diagnostic, key.span(), "unknown key");
                    return None;
                }
            }
            let mut end = |name: &str| match ends.get(name) {
                Some(value) => reader.length_value(name, value).map(Some),
                None => Some(None),
            };
            let (lower, upper) = (end("lower"), end("upper"));
            let limit = Limit { lower: lower?, upper: upper? };
            match (&limit.lower, &limit.upper) {
                (None, None) => {
                    reader.report(bad(format!("`{name}` limits nothing")), value.span(), "");
                    return None;
                }
                (Some(lower), Some(upper)) if lower > upper => {
                    let message = format!("the lower limit {lower} is above the upper limit {upper}");
                    reader.report(bad(message), value.span(), "");
                    return None;
                }
                _ => limit,
            }
        }
        other => {
            let message = format!("`{name}` is {}; a limit has two ends", reader::type_in_words(other));
            reader.report(bad(message), value.span(), "");
            return None;
        }
    };
    Some(Located { value: limit, span: value.span() })
}
