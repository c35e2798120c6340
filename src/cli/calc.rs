//! `rackmesh calc`: one formula, no file.

mod asked;

use asked::{Asked, Question};
use clap::Subcommand;

use super::explain::for_screen;
use super::output::{Failure, Output, Status};
use crate::batch::Decimals;
use crate::deviation::plausible::{self, Doubt, WrittenIn};
use crate::deviation::{DeviationValue, Extent};
use crate::diagnostic::{Code, Diagnostic};
use crate::formula::law::lead_slope;
use crate::formula::over_pin::OverPin;
use crate::formula::{FormulaPage, IDEAL_PIN, Law, Model, OVER_PIN, ROLLER_CHANGE, ideal_pin, roller_change};
use crate::quantity::{Angle, AngleUnit, DomainError, Length, LengthUnit, QuantityError, Unit};
use crate::report::{Calculation, Format, ResultUnit};

pub(super) const ABOUT: &str = "Compute one formula: just the number and its unit";

#[derive(Debug, clap::Args)]
#[command(after_help = "Values are in mm or degrees, or take a unit: 20um, 0.5in, 15arcmin, 0.3mrad.

Examples:
  rackmesh calc over-roller --measured 25.0131 --nominal 25
  rackmesh calc pitch 20um --pressure-angle 20 --helix-angle 12 --explain
  rackmesh calc radial -4um --extent all
  rackmesh calc lead --inverse 50um --face-width 19.7 --pressure-angle 19.9
  rackmesh calc over-pin --normal-module 2 --pressure-angle 20 --pin 4 --datum 22")]
pub(super) struct Args {
    #[command(subcommand)]
    formula: Formula,
}

#[derive(Debug, Subcommand)]
enum Formula {
    /// ΔCD from the over-roller error of the rack.
    #[command(
        alias = "rack-over-roller",
        after_help = "Example:
  rackmesh calc over-roller --measured 25.0131 --nominal 25"
    )]
    OverRoller(Signed),
    /// ΔCD from a pitch error of the rack.
    #[command(
        alias = "rack-pitch",
        after_help = "Examples:
  rackmesh calc pitch 20um --pressure-angle 20 --helix-angle 12
  rackmesh calc pitch --inverse 50um --pressure-angle 20"
    )]
    Pitch(Pitch),
    /// ΔCD from a lead angle error of the rack.
    #[command(
        alias = "rack-lead",
        after_help = "Examples:
  rackmesh calc lead 0.25deg --face-width 19.7 --pressure-angle 19.9
  rackmesh calc lead --f-h-beta 8um --length 18 --face-width 19.7 --pressure-angle 19.9
  rackmesh calc lead --inverse 20um --length 18 --face-width 19.7 --pressure-angle 19.9"
    )]
    Lead(Lead),
    /// ΔCD from the radial measurement error of the pinion.
    #[command(
        alias = "pinion-radial",
        after_help = "Example:
  rackmesh calc radial --measured 8.512 --nominal 8.5"
    )]
    Radial(Signed),
    /// ΔCD from a single pitch deviation of the pinion.
    #[command(after_help = "Example:
  rackmesh calc pinion-pitch 15um --pressure-angle 20 --helix-angle 25")]
    PinionPitch(Pitch),
    /// ΔCD from a helix slope deviation f_Hβ of the pinion.
    #[command(after_help = "Example:
  rackmesh calc pinion-lead 12um --pressure-angle 20 --helix-angle 25")]
    PinionLead(Pitch),
    /// The ideal pin diameter for measuring a rack.
    #[command(after_help = "Example:
  rackmesh calc pin --normal-module 2 --pressure-angle 20")]
    Pin {
        /// Normal module m_n.
        #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
        normal_module: Length,
        /// Normal pressure angle α_n.
        #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
        pressure_angle: Angle,
        /// Normal tooth thickness s_n; π m_n / 2 unless given.
        #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
        tooth_thickness: Option<Length>,
        #[command(flatten)]
        common: Common,
    },
    /// The nominal measure over a chosen pin.
    #[command(after_help = "Example:
  rackmesh calc over-pin --normal-module 2 --pressure-angle 20 --pin 4 --datum 22")]
    OverPin {
        /// Normal module m_n.
        #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
        normal_module: Length,
        /// Normal pressure angle α_n.
        #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
        pressure_angle: Angle,
        /// Diameter of the pin.
        #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
        pin: Length,
        /// Distance K from the datum to the reference plane.
        #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
        datum: Length,
        /// Normal tooth thickness s_n; π m_n / 2 unless given.
        #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
        tooth_thickness: Option<Length>,
        #[command(flatten)]
        common: Common,
    },
    /// The difference of two over-pin measures made with different rollers.
    #[command(after_help = "Example:
  rackmesh calc roller-change --old-roller 4 --new-roller 3.5 --pressure-angle 20")]
    RollerChange {
        /// Diameter of the roller that is replaced.
        #[arg(long, value_name = "LENGTH", alias = "from", allow_hyphen_values = true)]
        old_roller: Length,
        /// Diameter of the roller that replaces it.
        #[arg(long, value_name = "LENGTH", alias = "to", allow_hyphen_values = true)]
        new_roller: Length,
        /// Normal pressure angle α_n.
        #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
        pressure_angle: Angle,
        #[command(flatten)]
        common: Common,
    },
}

/// Options of every calculation.
#[derive(Debug, clap::Args)]
struct Common {
    /// The unit of the result; mm or deg unless given.
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Decimals of the lengths in the result.
    #[arg(long, value_name = "N|full")]
    decimals: Option<Decimals>,
    /// Show the formula's page too.
    #[arg(long)]
    explain: bool,
    /// Output format.
    #[arg(long, short, value_enum, conflicts_with = "explain")]
    format: Option<Format>,
}

/// The error, or the ΔCD for which the error is asked.
#[derive(Debug, clap::Args)]
struct GivenValue {
    /// The error; with --inverse, the ΔCD.
    #[arg(allow_hyphen_values = true)]
    value: Option<String>,
    /// What was measured: a value, or in `mesh` a curve, as a table of stroke and ΔCD.
    ///
    /// The error is measured - nominal.
    #[arg(long, requires = "nominal", conflicts_with = "value", allow_hyphen_values = true)]
    measured: Option<String>,
    /// The nominal value.
    #[arg(long, requires = "measured", allow_hyphen_values = true)]
    nominal: Option<String>,
    /// The largest error that stays within this ΔCD.
    #[arg(long, value_name = "ΔCD", num_args = 0..=1, allow_negative_numbers = true,
          conflicts_with_all = ["measured", "nominal"])]
    #[expect(clippy::option_option, reason = "tells an absent flag, the bare flag, and the flag with a value apart")]
    inverse: Option<Option<String>>,
    /// On which teeth the error is: adds what it can do wherever it is. Unless given, that of a measured error in a spec.
    #[arg(long, value_enum)]
    extent: Option<Extent>,
}

#[derive(Debug, clap::Args)]
struct Signed {
    #[command(flatten)]
    given: GivenValue,
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, clap::Args)]
struct Pitch {
    #[command(flatten)]
    given: GivenValue,
    #[command(flatten)]
    gear: Gear,
    #[command(flatten)]
    common: Common,
}

/// The angles of a part, and how its formula is read.
#[derive(Debug, clap::Args)]
struct Gear {
    /// Normal pressure angle α_n.
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true)]
    pressure_angle: Angle,
    /// Helix angle β, right hand positive.
    #[arg(long, value_name = "ANGLE", default_value = "0", allow_hyphen_values = true)]
    helix_angle: Angle,
    /// Formulas exact for rigid teeth, or as the paper prints them.
    #[arg(long, value_enum, default_value_t)]
    model: Model,
}

/// The value of an option that may be doubted.
pub(super) type OptionDoubt = (&'static str, Option<Doubt>);

fn pressure_angle_doubt(angle: Angle) -> OptionDoubt {
    ("--pressure-angle", plausible::pressure_angle(angle))
}

impl Gear {
    fn doubts(&self) -> [OptionDoubt; 2] {
        let helix_angle = plausible::helix_angle(self.helix_angle);
        [pressure_angle_doubt(self.pressure_angle), ("--helix-angle", helix_angle)]
    }
}

#[derive(Debug, clap::Args)]
#[command(group(clap::ArgGroup::new("f_h_beta_or_inverse").args(["f_h_beta", "inverse"])))]
struct Lead {
    #[command(flatten)]
    given: GivenValue,
    /// Helix slope deviation f_Hβ, in place of the angle.
    #[arg(long, requires = "length", conflicts_with_all = ["value", "measured", "inverse"],
          allow_hyphen_values = true)]
    f_h_beta: Option<Length>,
    /// Evaluation length of the helix slope deviation; with --inverse, the result is one too, in µm.
    #[arg(long, value_name = "LENGTH", requires = "f_h_beta_or_inverse", allow_hyphen_values = true)]
    length: Option<Length>,
    /// Face width.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    face_width: Length,
    #[command(flatten)]
    gear: Gear,
    #[command(flatten)]
    common: Common,
}

/// A unit by its symbol.
fn by_symbol(unit: Unit) -> ResultUnit {
    ResultUnit { unit, spelling: unit.symbol().to_owned() }
}

fn usage(message: impl Into<String>) -> Failure {
    Diagnostic::usage(message).help("`rackmesh calc --help` shows examples").into()
}

impl From<DomainError> for Failure {
    fn from(error: DomainError) -> Self {
        let code = match error {
            DomainError::Outside { .. } | DomainError::NoSpace { .. } | DomainError::WrongDimension { .. } => {
                Code::OutOfDomain
            }
            DomainError::NeverReached { .. } | DomainError::Overflow(_) => Code::NoResult,
        };
        Diagnostic::error(code, error.to_string()).into()
    }
}

fn read<Q: std::str::FromStr<Err = QuantityError>>(text: &str) -> Result<Q, Failure> {
    text.parse().map_err(|error: QuantityError| Diagnostic::error(Code::BadQuantity, error.to_string()).into())
}

impl GivenValue {
    fn asked<E: std::str::FromStr<Err = QuantityError> + Into<DeviationValue>>(&self) -> Result<Question, Failure> {
        let value = |text: &str| -> Result<DeviationValue, Failure> { Ok(read::<E>(text)?.into()) };
        match (&self.value, &self.measured, &self.nominal, &self.inverse) {
            (None, _, _, Some(Some(delta_cd))) | (Some(delta_cd), _, _, Some(None)) => {
                Ok(Question::Error(read(delta_cd)?))
            }
            (Some(_), _, _, Some(Some(_))) => Err(usage("--inverse already gives the ΔCD; leave the other value out")),
            (None, _, _, Some(None)) => Err(usage("--inverse needs a ΔCD: --inverse 50um")),
            (Some(error), ..) => Ok(Question::DeltaCd(value(error)?)),
            (None, Some(measured), Some(nominal), None) => {
                Ok(Question::DeltaCd(value(measured)?.less(value(nominal)?)))
            }
            (None, ..) => {
                Err(usage("give the error (such as 20um), or --measured and --nominal, or --inverse with a ΔCD"))
            }
        }
    }
}

impl Common {
    /// The unit of a result: the one asked for, or the default.
    fn unit(&self, own: ResultUnit) -> Result<ResultUnit, Failure> {
        let Some(spelling) = self.unit.clone() else { return Ok(own) };
        let (known, dimension, names) = match own.unit {
            Unit::Angle(_) => (AngleUnit::from_symbol(&spelling).map(Unit::Angle), "an angle", AngleUnit::NAMES),
            Unit::Length(_) => (LengthUnit::from_symbol(&spelling).map(Unit::Length), "a length", LengthUnit::NAMES),
        };
        let unknown = || usage(format!("the result is {dimension}, and `{spelling}` is none of its units: {names}"));
        Ok(ResultUnit { unit: known.ok_or_else(unknown)?, spelling })
    }

    /// Prints a result: its line, its explanation, or a report; what it returns has the unit and decimals that are printed.
    fn print(&self, output: &mut Output, calculation: Calculation) -> Result<Calculation, Failure> {
        let unit = self.unit(calculation.unit)?;
        let decimals = match self.decimals {
            None => Some(unit.decimals()),
            Some(Decimals::Places(places)) => Some(places.into()),
            Some(Decimals::Full) => None,
        };
        let calculation = Calculation { unit, decimals, ..calculation };
        if let Some(format) = self.format {
            output.report(&calculation, format)?;
        } else if self.explain {
            let width = output.screen().width;
            let page = for_screen(calculation.formula.text, width);
            output.text(&format!("{}\n{page}", calculation.by_each_model()))?;
        } else {
            output.text(&format!("{}\n", calculation.line()))?;
            if let Some(remark) = calculation.model_remark() {
                output.remark(&remark);
            }
        }
        Ok(calculation)
    }

    /// Prints the result of a formula that is no law.
    fn print_value(
        &self,
        output: &mut Output,
        page: &'static FormulaPage,
        result: Length,
        doubts: &[OptionDoubt],
    ) -> Result<Status, Failure> {
        let notes = sensible(output, doubts)?;
        self.print(output, Calculation { notes, ..calculation(page, result.into()) })?;
        Ok(Status::Pass)
    }
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        match self.formula {
            Formula::OverRoller(args) => signed(&args, output, Law::rack_over_roller()),
            Formula::Radial(args) => signed(&args, output, Law::pinion_radial()),
            Formula::Pitch(args) => pitch(&args, output, Law::rack_pitch),
            Formula::PinionPitch(args) => pitch(&args, output, Law::pinion_pitch),
            Formula::PinionLead(args) => pitch(&args, output, Law::pinion_lead),
            Formula::Lead(args) => lead(&args, output),
            Formula::Pin { normal_module, pressure_angle, tooth_thickness, common } => {
                let diameter = ideal_pin::diameter(normal_module, pressure_angle, tooth_thickness)?;
                common.print_value(output, &IDEAL_PIN, diameter, &rack_doubts(pressure_angle, normal_module))
            }
            Formula::OverPin { normal_module, pressure_angle, pin, datum, tooth_thickness, common } => {
                let (pin_diameter, normal_pressure_angle) = (pin, pressure_angle);
                let over_pin = OverPin { normal_module, normal_pressure_angle, tooth_thickness, pin_diameter, datum };
                let [angle, module] = rack_doubts(pressure_angle, normal_module);
                let doubts = [angle, module, ("--pin", over_pin.doubted_pin(None))];
                common.print_value(output, &OVER_PIN, over_pin.measure()?, &doubts)
            }
            Formula::RollerChange { old_roller, new_roller, pressure_angle, common } => {
                let difference = roller_change::difference(old_roller, new_roller, pressure_angle)?;
                common.print_value(output, &ROLLER_CHANGE, difference, &[pressure_angle_doubt(pressure_angle)])
            }
        }
    }
}

fn rack_doubts(pressure_angle: Angle, normal_module: Length) -> [OptionDoubt; 2] {
    [pressure_angle_doubt(pressure_angle), ("--normal-module", plausible::normal_module(normal_module))]
}

/// Warns of suspicious arguments, and refuses impossible ones. The warnings go with the result.
pub(super) fn sensible(output: &mut Output, doubts: &[OptionDoubt]) -> Result<Vec<String>, Failure> {
    let mut said = Vec::new();
    for (name, doubt) in doubts.iter().filter_map(|(name, doubt)| Some((name, doubt.as_ref()?))) {
        let (message, help) = (format!("{name}: {doubt}"), doubt.remedy(WrittenIn::Argument));
        if doubt.is_impossible {
            return Err(Diagnostic::error(Code::Implausible, message).help(help).into());
        }
        let warning = Diagnostic::warning(Code::Implausible, message).help(help);
        output.diagnostic(&warning);
        said.push(warning.sentence());
    }
    Ok(said)
}

/// A result of a formula in its base unit.
fn calculation(formula: &'static FormulaPage, result: DeviationValue) -> Calculation {
    Calculation {
        formula,
        result,
        model: None,
        other: None,
        unit: by_symbol(match result {
            DeviationValue::Length(_) => Unit::Length(LengthUnit::Millimetre),
            DeviationValue::Angle(_) | DeviationValue::Slope(_) => Unit::Angle(AngleUnit::Degree),
        }),
        decimals: None,
        is_bound: false,
        worst_case: None,
        notes: Vec::new(),
    }
}

/// The laws whose ΔCD is the error itself.
fn signed(Signed { given, common }: &Signed, output: &mut Output, law: Law) -> Result<Status, Failure> {
    Asked { law, given, question: given.asked::<Length>()?, model: None }.print(output, common, &[])
}

fn pitch(
    Pitch { given, gear, common }: &Pitch,
    output: &mut Output,
    law: fn(Angle, Angle) -> Result<Law, DomainError>,
) -> Result<Status, Failure> {
    let law = law(gear.pressure_angle, gear.helix_angle)?;
    let question = given.asked::<Length>()?;
    Asked { law, given, question, model: Some(gear.model) }.print(output, common, &gear.doubts())
}

fn lead(args: &Lead, output: &mut Output) -> Result<Status, Failure> {
    let Lead { given, gear, face_width, length, .. } = args;
    sensible(output, &[("--length", length.and_then(plausible::evaluation_length))])?;
    let question = match (args.f_h_beta, *length) {
        (Some(slope), Some(length)) => Question::DeltaCd(lead_slope(slope, length)?),
        (_, length) => match (given.asked::<Angle>()?, length) {
            (Question::Error(delta_cd), Some(length)) => Question::SlopeDeviation { delta_cd, length },
            (question, _) => question,
        },
    };
    let law = Law::rack_lead(gear.pressure_angle, gear.helix_angle, *face_width)?;
    let [pressure_angle, helix_angle] = gear.doubts();
    let doubts = [pressure_angle, helix_angle, ("--face-width", plausible::face_width(*face_width, None))];
    Asked { law, given, question, model: Some(gear.model) }.print(output, &args.common, &doubts)
}
