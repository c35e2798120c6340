//! `rackmesh class`: permissible deviations of a grade, grades obtained, and the coarsest grade within a ΔCD.

use std::path::{Path, PathBuf};

use clap::builder::{PossibleValue, TypedValueParser as _};

use super::calc::sensible;
use super::completions::Suggested;
use super::output::{Failure, Output, Status};
use super::set::SetArgs;
use crate::deviation::{DeviationKind, Part, plausible};
use crate::diagnostic::{Code, Diagnostic};
use crate::formula::{Model, domain};
use crate::gear::Pair;
use crate::judge::Stack;
use crate::judge::class::{self, DiameterSource, Meshing, NoEffect, RackDiameter, SizedPart};
use crate::judge::class_mesh::ArrangedDeviation;
use crate::judge::grade::{self, GradeSearch, ObtainedGrade, PermittedValues};
use crate::quantity::{Angle, Length};
use crate::report::{ClassReport, ClassRow, Format, GradeSearchReport, ObtainedReport};
use crate::spec::{MeasuredValue, Spec, keys};
use crate::standard::{Permissible, Size, Standard, StandardError, Wheel};

pub(super) const ABOUT: &str = "Permissible deviations of an accuracy grade, and their ΔCD";

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Standards: iso1328-1:1995 (with iso1328-2:1997), iso1328-2:1997, iso1328-1:2013, din3962:1978, jisb1702:1976.
They grade toothed wheels; for a rack, --diameter says which diameter stands for it.

Examples:
  rackmesh class --standard iso1328-1:1995 --grade 7 --normal-module 1.9 --diameter 14.675 --face-width 30 --tooth-count 7
  rackmesh class --spec rack.toml --standard iso1328-1:2013 --grade 6
  rackmesh class --spec rack.toml --part rack --diameter developed --standard iso1328-1:1995 --grade 8
  rackmesh class --obtained rack.toml
  rackmesh class --spec rack.toml --delta-cd 0.05

Exit status: 0; 1 if no grade stays within --delta-cd; 2 if there is no result."
)]
pub(super) struct Args {
    /// The standard and edition; of the spec's [tolerance] unless given.
    #[arg(long, value_parser = Suggested(standards).try_map(|name| name.parse::<Standard>()), hide_possible_values = true)]
    standard: Option<Standard>,
    /// The grade.
    #[arg(long, conflicts_with_all = ["obtained", "delta_cd"])]
    grade: Option<u8>,
    /// The grade that the measured values of this spec reach.
    #[arg(long, value_name = "SPEC", conflicts_with_all = ["spec", "delta_cd"])]
    obtained: Option<PathBuf>,
    /// The ΔCD to stay within, to either side.
    #[arg(long, alias = "for-delta-cd", value_name = "ΔCD", allow_hyphen_values = true)]
    delta_cd: Option<Length>,
    /// The gear spec (TOML); `-` reads standard input.
    #[arg(long, value_name = "SPEC")]
    spec: Option<PathBuf>,
    /// Which part.
    #[arg(long, value_parser = ["pinion", "rack"], default_value = "pinion")]
    part: String,
    /// Normal module m_n.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    normal_module: Option<Length>,
    /// Reference diameter d; for a rack a length, `pinion`, or `developed`.
    #[arg(long, value_name = "LENGTH", value_parser = rack_diameter, allow_hyphen_values = true)]
    diameter: Option<RackDiameter>,
    /// Face width.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    face_width: Option<Length>,
    /// Number of teeth z.
    #[arg(long, value_name = "Z", alias = "teeth", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    tooth_count: Option<u32>,
    /// Helix angle β, right hand positive.
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    helix_angle: Option<Angle>,
    /// Normal pressure angle α_n.
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    pressure_angle: Option<Angle>,
    /// Formulas exact for rigid teeth, or as the paper prints them.
    #[arg(long, value_enum, default_value_t)]
    model: Model,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
}

fn standards() -> Vec<PossibleValue> {
    Standard::ALL.map(|standard| PossibleValue::new(standard.id())).into()
}

fn rack_diameter(text: &str) -> Result<RackDiameter, String> {
    match text {
        "pinion" => Ok(RackDiameter::Pinion),
        "developed" => Ok(RackDiameter::Developed),
        _ => text.parse().map(RackDiameter::Given).map_err(|error: crate::quantity::QuantityError| {
            format!("{error}; or write pinion or developed, for a rack")
        }),
    }
}

impl Args {
    pub(super) fn run(mut self, output: &mut Output) -> Result<Status, Failure> {
        let path = self.obtained.take().map(|path| (path, true)).or_else(|| Some((self.spec.take()?, false)));
        let spec = match &path {
            Some((path, _)) => Some(self.set.read_spec(path, output)?),
            None if self.set.is_empty() => None,
            None => Some(self.set.without_file(output)?),
        };
        let written = spec.as_ref().and_then(|spec| spec.get(keys::TOLERANCE_STANDARD));
        let is_complete = self.grade.is_some() || self.delta_cd.is_some() || path.as_ref().is_some_and(|path| path.1);
        let Some(standard) = self.standard.or(written).filter(|_| is_complete) else {
            return Err(self.lacking(self.standard.or(written), is_complete, spec.as_ref()).into());
        };
        let doubts = self.doubts(output)?;
        match (&spec, &path) {
            (Some(spec), Some((path, true))) => self.run_obtained(standard, spec, path, output),
            _ => match (self.grade, &self.delta_cd) {
                (Some(grade), _) => self.run_grade(standard, grade, spec.as_ref(), doubts, output),
                (None, Some(limit)) => self.run_search(standard, limit.abs(), spec.as_ref(), output),
                (None, None) => Err(self.lacking(Some(standard), false, spec.as_ref()).into()),
            },
        }
    }

    /// Reports every missing value at once.
    fn lacking(&self, standard: Option<Standard>, has_task: bool, spec: Option<&Spec>) -> Diagnostic {
        let mut lacks = Vec::new();
        if standard.is_none() {
            let known = Standard::ALL.map(Standard::id).join(", ");
            lacks.push(format!("--standard, or [tolerance] standard in the spec ({known}; there is no default)"));
        }
        if !has_task {
            lacks.push("--grade, or --delta-cd, or --obtained SPEC".to_owned());
        }
        let of = standard.unwrap_or(Standard::Iso1328Part1Of1995);
        // without a diameter the wheel is not known
        let wheel = self.sized(self.part(), spec).map(|sized| sized.wheel).unwrap_or_default();
        let sizes = of.sizes_missing(self.grade.unwrap_or(*of.grades().end()), &wheel);
        if !sizes.is_empty() {
            lacks.push(format!("{}, or --spec SPEC with them", options_of(&sizes)));
        }
        Diagnostic::usage("the class is not asked for completely").help(format!("give {}", lacks.join("; and ")))
    }

    /// Warnings of suspicious options; impossible ones are refused.
    fn doubts(&self, output: &mut Output) -> Result<Vec<String>, Failure> {
        let doubts = [
            ("--normal-module", self.normal_module.and_then(plausible::normal_module)),
            ("--face-width", self.face_width.and_then(|width| plausible::face_width(width, self.normal_module))),
            ("--helix-angle", self.helix_angle.and_then(plausible::helix_angle)),
            ("--pressure-angle", self.pressure_angle.and_then(plausible::pressure_angle)),
        ];
        sensible(output, &doubts)
    }

    /// The part, from the options, else from the spec.
    fn sized(&self, part: Part, spec: Option<&Spec>) -> Result<SizedPart, Failure> {
        let mut wheel = spec.map(|spec| spec.wheel(part)).unwrap_or_default();
        wheel.normal_module = self.normal_module.or(wheel.normal_module);
        wheel.face_width = self.face_width.or(wheel.face_width);
        wheel.teeth = self.tooth_count.or(wheel.teeth);
        wheel.helix_angle = self.helix_angle.or(wheel.helix_angle);
        positive(Size::NormalModule, wheel.normal_module)?;
        positive(Size::FaceWidth, wheel.face_width)?;
        let (diameter, source) = self.diameter(part, &wheel, spec)?;
        wheel.diameter = diameter;
        let diameter_source = wheel.diameter.as_ref().map(|_| source);
        let written = spec.and_then(|spec| spec.get(keys::PAIR_NORMAL_PRESSURE_ANGLE));
        let meshing = Meshing {
            part,
            pressure_angle: self.pressure_angle.or(written),
            helix_angle: wheel.helix_angle,
            face_width: wheel.face_width,
        };
        let pressure_angle = meshing.pressure_angle.map(|angle| domain::NORMAL_PRESSURE_ANGLE.check_angle(angle));
        let helix_angle = meshing.helix_angle.map(|angle| domain::RACK_HELIX_ANGLE.check_angle(angle));
        for checked in [pressure_angle, helix_angle].into_iter().flatten() {
            checked.map_err(Diagnostic::with_code(Code::OutOfDomain))?;
        }
        Ok(SizedPart { wheel, diameter_source, meshing })
    }

    /// The reference diameter by which a part is graded, if it is known, and its source.
    fn diameter(
        &self,
        part: Part,
        wheel: &Wheel,
        spec: Option<&Spec>,
    ) -> Result<(Option<Length>, DiameterSource), Failure> {
        let written = spec.and_then(|spec| spec.get(keys::TOLERANCE_DIAMETER));
        // where both parts are graded, --diameter is the rack's unless the pinion's own is not known
        let is_own = part == Part::Pinion && self.grade.is_none() && pinion_diameter(part, wheel, spec)?.is_some();
        let choice = match part {
            Part::Rack => self.diameter.clone().or(written),
            Part::Pinion if is_own => None,
            Part::Pinion => self.diameter.clone(),
        };
        match (part, choice) {
            (_, Some(RackDiameter::Given(diameter))) => {
                positive(Size::Diameter, Some(diameter))?;
                Ok((Some(diameter), DiameterSource::Given))
            }
            (Part::Rack, Some(RackDiameter::Developed)) => {
                let length = spec.and_then(|spec| spec.get(keys::RACK_TOOTHED_LENGTH));
                let length = length.ok_or_else(|| {
                    Diagnostic::usage("a developed diameter needs the toothed length of the rack")
                        .help("give --spec SPEC with rack.toothed_length, or the diameter itself")
                })?;
                let diameter = class::developed_diameter(length).map_err(Diagnostic::with_code(Code::OutOfDomain))?;
                Ok((Some(diameter), DiameterSource::Developed))
            }
            (Part::Rack, Some(RackDiameter::Pinion)) => {
                let diameter = pinion_diameter(part, wheel, spec)?;
                if diameter.is_none() {
                    let message = "the diameter of the mating pinion needs its normal module and number of teeth";
                    return Err(Diagnostic::usage(message)
                        .help("give --spec SPEC with them, or the diameter itself")
                        .into());
                }
                Ok((diameter, DiameterSource::MatingPinion))
            }
            (Part::Rack, None) => {
                let message = "which diameter stands for the rack is not said, and there is no default";
                let help = "give --diameter pinion, developed or a length, or [tolerance] diameter in the spec";
                Err(Diagnostic::usage(message).help(help).into())
            }
            (Part::Pinion, _) => Ok((pinion_diameter(part, wheel, spec)?, DiameterSource::Own)),
        }
    }

    fn part(&self) -> Part {
        if self.part == "rack" { Part::Rack } else { Part::Pinion }
    }

    /// The permissible values of one grade.
    fn run_grade(
        &self,
        standard: Standard,
        grade: u8,
        spec: Option<&Spec>,
        mut notes: Vec<String>,
        output: &mut Output,
    ) -> Result<Status, Failure> {
        let sized = self.sized(self.part(), spec)?;
        if let Some(doubt) = sized.doubted_diameter().map_err(Diagnostic::with_code(Code::OutOfDomain))? {
            let doubt = Diagnostic::warning(Code::Implausible, doubt).help("leave --diameter out, or check these");
            notes.push(doubt.sentence());
            output.diagnostic(&doubt);
        }
        let pair = spec.map(|spec| spec.pair("the exact mesh")).transpose().unwrap_or_else(|problems| {
            let first = problems.0.first().map(|problem| problem.message.clone()).unwrap_or_default();
            notes.push(format!("no exact mesh: {first}"));
            None
        });
        let permitted = PermittedValues::new(standard, grade, &sized.wheel)
            .map_err(|error| no_class(&error, &standard.sizes_missing(grade, &sized.wheel)))?;
        let rows = permitted.values.into_iter().map(|value| row(value, &sized, self.model, pair.as_ref())).collect();
        let not_given = permitted.not_given.into_iter();
        let not_given = not_given.map(|(one, deviation, error)| (one, deviation, reason(&error))).collect();
        let title = spec.and_then(|spec| spec.title.clone());
        let report = ClassReport { title, standard, sized, grade, rows, not_given, notes };
        output.report(&report, self.format)?;
        Ok(Status::Pass)
    }

    /// The grades that measured values reach.
    fn run_obtained(
        &self,
        standard: Standard,
        spec: &Spec,
        path: &Path,
        output: &mut Output,
    ) -> Result<Status, Failure> {
        let values = spec.measured_deviations(&super::spec_files::measured_tables(spec, path, output)?)?;
        let (mut obtained, mut not_graded, mut diameters) = (Vec::<ObtainedGrade>::new(), Vec::new(), Vec::new());
        for part in [Part::Rack, Part::Pinion] {
            let of_part: Vec<&MeasuredValue> = values.iter().filter(|value| value.part == part).collect();
            if of_part.is_empty() {
                continue;
            }
            let sized = self.sized(part, Some(spec))?;
            diameters.extend(sized.diameter_in_words().map(|words| format!("{}: {words}", part.name())));
            for value in of_part {
                let deviation = match value.graded {
                    Ok(deviation) => deviation,
                    Err(reason) => {
                        not_graded.push(format!("{}: {reason}", value.origin));
                        continue;
                    }
                };
                match grade::obtained(standard, part, deviation, value.amount, &value.origin, &sized.wheel) {
                    Ok(one) => obtained.push(one),
                    Err(error @ StandardError::OutOfScope { .. }) => return Err(no_class(&error, &[]).into()),
                    Err(error) => not_graded.push(format!("{} {deviation}: {}", part.name(), reason(&error))),
                }
            }
        }
        if obtained.is_empty() && not_graded.is_empty() {
            return Err(Diagnostic::error(Code::NoErrors, "the spec has no measured value to grade")
                .help("give [errors], rack.measured or pinion.measured")
                .into());
        }
        let report = ObtainedReport { title: spec.title.clone(), standard, diameters, obtained, not_graded };
        output.report(&report, self.format)?;
        Ok(if report.obtained.is_empty() { Status::Undecided } else { Status::Pass })
    }

    /// With a spec its errors, or the paper's; without one the independent deviations of the part's teeth.
    fn kinds_searched(&self, spec: Option<&Spec>) -> Vec<DeviationKind> {
        match spec {
            Some(spec) if !spec.errors.is_empty() => spec.errors.iter().map(|(kind, _)| *kind).collect(),
            Some(_) => DeviationKind::OF_PAPER.to_vec(),
            None => match self.part() {
                Part::Rack => vec![DeviationKind::RackOverRoller, DeviationKind::RackPitch, DeviationKind::RackLead],
                Part::Pinion => vec![DeviationKind::PinionRadial, DeviationKind::PinionPitch],
            },
        }
    }

    /// The coarsest grade within a ΔCD.
    fn run_search(
        &self,
        standard: Standard,
        limit: Length,
        spec: Option<&Spec>,
        output: &mut Output,
    ) -> Result<Status, Failure> {
        let kinds = self.kinds_searched(spec);
        let (kinds, left_out): (Vec<_>, Vec<_>) =
            kinds.into_iter().partition(|kind| class::deviation_of(*kind).is_some());
        if kinds.is_empty() {
            return Err(Diagnostic::error(Code::NoClass, class::NO_OVER_ROLLER_CLASS).into());
        }
        let mut parts = Vec::new();
        for part in [Part::Rack, Part::Pinion] {
            if kinds.iter().any(|kind| kind.part() == part) {
                parts.push(self.sized(part, spec)?);
            }
        }
        let errors = || kinds.iter().flat_map(|kind| parts.iter().map(move |part| (*kind, part)));
        let basis = spec.map(Spec::pair_basis).transpose()?.unwrap_or_default();
        let search = GradeSearch::new(standard, limit, &basis, |grade| {
            let on_its_part = errors().filter(|(kind, part)| part.meshing.part == kind.part());
            on_its_part.map(|(kind, part)| part.tolerance(kind, standard, grade)).collect()
        })
        .map_err(Diagnostic::with_code(Code::NoResult))?;
        if let Some(error) = search.failure() {
            return Err(no_tolerance(error).into());
        }
        let title = spec.and_then(|spec| spec.title.clone());
        let report = GradeSearchReport { title, standard, search, kinds, left_out, parts };
        output.report(&report, self.format)?;
        Ok(if report.search.coarsest(Stack::Rss).is_some() { Status::Pass } else { Status::Fail })
    }
}

/// The reference diameter of the spec's pinion for a rack, else of this wheel; `None` if it is not known.
fn pinion_diameter(part: Part, wheel: &Wheel, spec: Option<&Spec>) -> Result<Option<Length>, Failure> {
    let mate = spec.filter(|_| part == Part::Rack).map(|spec| spec.wheel(Part::Pinion));
    let wheel = mate.map_or_else(
        || wheel.clone(),
        |mate| Wheel { normal_module: wheel.normal_module.or(mate.normal_module), ..mate },
    );
    Ok(class::own_diameter(&wheel).map_err(Diagnostic::with_code(Code::OutOfDomain))?)
}

/// Why there is no ΔCD of any grade.
fn no_tolerance(error: &NoEffect) -> Diagnostic {
    match error {
        NoEffect::Standard(error) => no_class(error, &[]),
        error => Diagnostic::error(Code::NoResult, format!("ΔCD of a class has no value: {error}"))
            .help("give it as an option or in the spec"),
    }
}

fn row(permissible: Permissible, sized: &SizedPart, model: Model, pair: Option<&Pair>) -> ClassRow {
    let deviation = permissible.deviation;
    let delta_cd = class::delta_cd(deviation, permissible.length(), &sized.meshing, model);
    let mesh = pair.and_then(|pair| {
        let pitches = permissible.ranges.iter().find(|used| used.size == Size::Teeth).map_or(1.0, |used| used.taken);
        let arranged = ArrangedDeviation {
            part: sized.meshing.part,
            deviation,
            amount_mm: permissible.length().mm(),
            face_width_mm: sized.wheel.face_width.map_or(1.0, Length::mm),
            pitches: pitches as i64,
        };
        arranged.largest_delta_cd_mm(pair)
    });
    ClassRow { permissible, delta_cd, mesh }
}

/// The option that gives a size.
fn option_of(size: Size) -> String {
    // `--teeth` is another option of other commands
    if size == Size::Teeth { "tooth-count".to_owned() } else { size.key().replace('_', "-") }
}

/// Why a value is missing, with the option that gives it.
fn reason(error: &StandardError) -> String {
    match error {
        StandardError::Missing { size, .. } => {
            format!("the {} is not given (--{})", size.name(), option_of(*size))
        }
        _ => error.to_string(),
    }
}

/// Why there is no value, with all sizes that are `missing` where one is.
fn no_class(error: &StandardError, missing: &[Size]) -> Diagnostic {
    let diagnostic = Diagnostic::error(Code::NoClass, error.to_string());
    match error {
        StandardError::Missing { size, .. } => {
            let sizes = if missing.is_empty() { std::slice::from_ref(size) } else { missing };
            let them = if sizes.len() == 1 { "it" } else { "them" };
            diagnostic.help(format!("give {}, or --spec SPEC with {them}", options_of(sizes)))
        }
        _ => diagnostic,
    }
}

/// The options that give these sizes.
fn options_of(sizes: &[Size]) -> String {
    sizes.iter().map(|size| format!("--{}", option_of(*size))).collect::<Vec<_>>().join(", ")
}

fn positive(size: Size, length: Option<Length>) -> Result<(), Failure> {
    match length {
        Some(length) if length <= Length::ZERO => {
            let message = format!("the {} is {length}; it must be above 0 mm", size.name());
            Err(Diagnostic::error(Code::OutOfDomain, message).into())
        }
        _ => Ok(()),
    }
}
