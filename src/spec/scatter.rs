//! `[scatter]` as written, and the random deviations that it means. Resolved for `rackmesh monte-carlo`; draws nothing.

use toml::de::DeValue;

use super::keys::{self, Kind};
use super::reader::SectionReader;
use super::resolve::Problems;
use super::{Located, Spec};
use crate::chance::racks::Scatter;
use crate::deviation::DeviationKind;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::law::RADIANS_PER_DEGREE;
use crate::judge::class::ErrorClass;
use crate::uncertainty::{Distribution, Uncertainty};

/// A spread as written.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum WrittenSpread {
    /// A standard deviation or a half-width, mm or degrees.
    Spread(Uncertainty),
    /// A class of `[tolerance]`.
    Class(u8),
}

/// `[scatter]`: one entry per kind of deviation.
pub type ScatterSection = Vec<(&'static str, Located<WrittenSpread>)>;

const HELP: &str = "write a standard deviation (\"4 um\"), { half_width = \"6 um\", distribution = \"rectangular\" }, or \
                    { class = 7 }";

/// Reads `[scatter]`.
pub(super) fn read(reader: &mut SectionReader<'_>) -> ScatterSection {
    keys::SCATTER.keys.iter().filter_map(|key| Some((key.name(), spread(reader, key.name(), key.kind)?))).collect()
}

fn spread(reader: &mut SectionReader<'_>, name: &'static str, kind: Kind) -> Option<Located<WrittenSpread>> {
    let Kind::Spread { is_angle, class } = kind else { return None };
    let value = reader.table.get(name)?;
    let span = value.span();
    let located = |value| Some(Located { value, span: span.clone() });
    let number = |reader: &mut SectionReader<'_>, name: &str, value| {
        let number = reader.base_value(name, value, is_angle)?;
        if number > 0.0 {
            return Some(number);
        }
        let diagnostic = Diagnostic::error(Code::OutOfDomain, format!("`{name}` is {number}; it must be above 0"));
        reader.refuse(diagnostic.help(HELP), span.clone())
    };
    let DeValue::Table(table) = value.get_ref() else {
        return located(WrittenSpread::Spread(Uncertainty::standard(number(reader, name, value)?)));
    };
    reader.knows_keys(name, table, &["class", "half_width", "distribution"].into_iter(), HELP)?;
    let bad = |message: String| Diagnostic::error(Code::BadUncertainty, message).help(HELP);
    match (table.get("class"), table.get("half_width"), table.get("distribution")) {
        (Some(grade), None, None) => {
            if class.is_none() {
                let message = format!("`{name}` has no class: no standard limits it");
                return reader.refuse(bad(message), span.clone());
            }
            located(WrittenSpread::Class(reader.class_value(grade)?))
        }
        (None, Some(half_width), Some(distribution)) => {
            let distribution = reader.distribution(distribution)?;
            let half_width = number(reader, "half_width", half_width)?;
            located(WrittenSpread::Spread(Uncertainty::half_width(half_width, distribution)))
        }
        _ => reader.refuse(bad(format!("`{name}` is a table that makes no spread")), span.clone()),
    }
}

impl Spec {
    /// The random deviations of the teeth, in mm and rad, and what classes came to.
    ///
    /// Within a class every value is taken to be as probable as any other.
    ///
    /// # Errors
    /// A diagnostic if nothing scatters, a key is missing, or a class has no value.
    pub fn scatter(&self) -> Result<(Scatter, Vec<ErrorClass>), Diagnostics> {
        if self.scatter.is_empty() {
            let diagnostic = Diagnostic::error(Code::MissingKey, "`[scatter]` is missing or empty: nothing is random")
                .help("add lines to the section [scatter] such as `rack_pitch = \"4 um\"`, a standard deviation, or `rack_thickness = { half_width = \"6 um\", distribution = \"rectangular\" }`");
            return Err(diagnostic.into());
        }
        let mut problems = Problems::default();
        let mut classes = Vec::new();
        let mut scatter = Scatter::default();
        for (name, written) in &self.scatter {
            let key = keys::SCATTER.keys.iter().find(|key| key.name() == *name);
            let Some(Kind::Spread { is_angle, class }) = key.map(|key| key.kind) else { continue };
            let spread = match (written.value, class) {
                (WrittenSpread::Spread(spread), _) => Some(spread),
                (WrittenSpread::Class(grade), Some(kind)) => {
                    let class = self.class(kind, grade, &written.span, &mut problems);
                    let spread = class.as_ref().map(within_class);
                    classes.extend(class);
                    spread
                }
                (WrittenSpread::Class(_), None) => None,
            };
            let scale = if is_angle { RADIANS_PER_DEGREE } else { 1.0 };
            let spread = spread.map(|spread| Uncertainty { standard: spread.standard * scale, ..spread });
            match *name {
                "rack_pitch" => scatter.rack_pitch = spread,
                "rack_thickness" => scatter.rack_thickness = spread,
                "rack_lead" => scatter.rack_lead = spread,
                "rack_over_roller" => scatter.rack_over_roller = spread,
                "pinion_pitch" => scatter.pinion_pitch = spread,
                "pinion_thickness" => scatter.pinion_thickness = spread,
                "pinion_lead" => scatter.pinion_lead = spread,
                _ => scatter.pinion_runout = spread,
            }
        }
        problems.answer(Some((scatter, classes)), &self.source)
    }
}

/// The values that a class leaves, all alike: within plus and minus what it permits; of a runout, all of its peak to peak
/// value, which is twice the eccentricity.
fn within_class(class: &ErrorClass) -> Uncertainty {
    let is_runout = class.kind == DeviationKind::PinionRadial;
    let half_width = if is_runout { class.permissible.length().mm() } else { class.value.base() };
    Uncertainty::half_width(half_width.abs(), Distribution::Rectangular)
}
