//! `[scatter]` as written, and its random deviations, for `rackmesh monte-carlo`; draws nothing.

use toml::Spanned;
use toml::de::DeValue;

use super::keys::{self, Kind};
use super::reader::SectionReader;
use super::resolve::Problems;
use super::{Located, Spec};
use crate::chance::racks::Scatter;
use crate::deviation::{
    DeviationKind, PinionDeviation, PinionDeviationKind, PinionFlanks, RackDeviation, RackDeviationKind, ToothRange,
    key_in_words,
};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::law::RADIANS_PER_DEGREE;
use crate::judge::bound::pinion_lead_angle_rad;
use crate::judge::class::ErrorClass;
use crate::mesh::Mesh;
use crate::quantity::plain;
use crate::uncertainty::{Distribution, Uncertainty};

/// A spread as written.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum WrittenSpread {
    /// A standard deviation or a half-width, mm or degrees.
    Spread(Uncertainty),
    /// A tolerance with two ends, mm or degrees.
    Between([f64; 2], Distribution),
    /// A class of `[tolerance]`.
    Class(u8),
}

/// `[scatter]`: one entry per kind of deviation.
pub type ScatterSection = Vec<(&'static str, Located<WrittenSpread>)>;

const HELP: &str = "write a standard deviation (\"4 um\"), { half_width = \"6 um\", distribution = \"rectangular\" }, \
                    { value = { lower = \"-1 um\", upper = \"5 um\" } }, or { class = 7 }";

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
    reader.knows_keys(name, table, &["class", "half_width", "distribution", "value"].into_iter(), HELP)?;
    let bad = |message: String| Diagnostic::error(Code::BadUncertainty, message).help(HELP);
    if let Some(ends) =
        table.get("value").filter(|_| table.len() == 1 + usize::from(table.contains_key("distribution")))
    {
        let distribution =
            table.get("distribution").map_or(Some(Distribution::Rectangular), |of| reader.distribution(of));
        return located(WrittenSpread::Between(tolerance_ends(reader, name, ends, is_angle)?, distribution?));
    }
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

/// Both ends of a tolerance, mm or degrees.
fn tolerance_ends(
    reader: &mut SectionReader<'_>,
    name: &'static str,
    value: &Spanned<DeValue<'_>>,
    is_angle: bool,
) -> Option<[f64; 2]> {
    let refusal = |problem: &str| Diagnostic::error(Code::BadUncertainty, format!("`{name}`: {problem}")).help(HELP);
    if matches!(name, "pinion_pitch" | "pinion_runout") {
        let problem = "it is the same either way: the pitches of a turn add up to nothing, and a runout has no sign";
        return reader.refuse(refusal(problem), value.span());
    }
    let DeValue::Table(ends) = value.get_ref() else {
        return reader.refuse(refusal("a tolerance has two ends"), value.span());
    };
    reader.knows_keys("value", ends, &["lower", "upper"].into_iter(), HELP)?;
    let mut end = |name: &str| reader.base_value(name, ends.get(name)?, is_angle);
    match (end("lower"), end("upper")) {
        _ if ends.len() < 2 => reader.refuse(refusal("a tolerance has a `lower` and an `upper` end"), value.span()),
        (Some(lower), Some(upper)) if lower >= upper => {
            reader.refuse(refusal("the lower end is not below the upper one"), value.span())
        }
        (lower, upper) => Some([lower?, upper?]),
    }
}

impl Spec {
    /// A mesh whose teeth have the middles of the asymmetric tolerances of `[scatter]`, with a note for each.
    ///
    /// # Errors
    /// A diagnostic for middles that are impossible on teeth.
    pub fn with_scatter_middles(&self, mesh: &Mesh) -> Result<(Mesh, Vec<String>), Diagnostic> {
        let pair = mesh.pair();
        let (mut rack, mut pinion, mut notes) = (Vec::new(), Vec::new(), Vec::new());
        let mut on_rack = |kind| rack.push(RackDeviation { teeth: ToothRange::ALL, kind });
        let mut on_pinion = |kind| pinion.push(PinionDeviation { teeth: ToothRange::ALL, kind });
        for (name, written) in &self.scatter {
            let WrittenSpread::Between([lower, upper], _) = written.value else { continue };
            let middle = 0.5 * (lower + upper);
            match *name {
                "rack_pitch" => on_rack(RackDeviationKind::Pitch(middle)),
                "rack_thickness" => on_rack(RackDeviationKind::Thickness(middle)),
                "rack_lead" => on_rack(RackDeviationKind::Lead(middle * RADIANS_PER_DEGREE)),
                "rack_over_roller" => on_rack(RackDeviationKind::OverRoller(middle)),
                "pinion_thickness" => on_pinion(PinionDeviationKind::Thickness(middle)),
                _ => on_pinion(PinionDeviationKind::Lead(pinion_lead_angle_rad(pair, middle))),
            }
            let unit = if *name == "rack_lead" { "°" } else { " mm" };
            let [lower, upper] = [lower, upper].map(|end| plain((1e9 * end).round() / 1e9));
            notes
                .push(format!("{} scatters from {lower}{unit} to {upper}{unit}, about the middle", key_in_words(name)));
        }
        let refused = |problem: String| Diagnostic::error(Code::OutOfDomain, format!("[scatter]: {problem}"));
        let flanks = mesh.rack().clone().with_deviations(pair, &rack).and_then(|rack| {
            let middles = PinionFlanks::new(pair, &pinion)?;
            Ok((rack, mesh.pinion().clone().with_measured(middles.teeth())?))
        });
        let (rack, pinion) = flanks.map_err(|error| refused(error.to_string()))?;
        let mesh = Mesh::new(*pair, rack, pinion, mesh.support()).map_err(|error| refused(error.to_string()))?;
        Ok((mesh, notes))
    }

    /// The random deviations of the teeth, in mm and rad, and the permissible values of classes.
    ///
    /// Within a class all values are equally probable.
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
                (WrittenSpread::Between([lower, upper], distribution), _) => {
                    Some(Uncertainty::half_width(0.5 * (upper - lower), distribution))
                }
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

/// The equally probable values of a class: within plus and minus the permissible deviation; for a runout, its whole peak to
/// peak value, which is twice the eccentricity.
fn within_class(class: &ErrorClass) -> Uncertainty {
    let is_runout = class.kind == DeviationKind::PinionRadial;
    let half_width = if is_runout { class.permissible.length().mm() } else { class.value.base() };
    Uncertainty::half_width(half_width.abs(), Distribution::Rectangular)
}
