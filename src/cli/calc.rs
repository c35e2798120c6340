//! `rackmesh calc`: one formula, no file.

use clap::Subcommand;

use super::eval::ModelArg;
use super::output::{Failure, Output, Status};
use crate::deviation::ErrorValue;
use crate::diagnostic::{Code, Diagnostic};
use crate::formula::over_pin::OverPin;
use crate::formula::{Model, PinionPitch, RackLead, RackPitch, ideal_pin, over_roller, pinion_radial, roller_change};
use crate::quantity::{Angle, AngleUnit, DomainError, Length, LengthUnit, QuantityError};
use crate::report::{Calculation, Computed, Format, ResultUnit};

pub(super) const ABOUT: &str = "Compute one formula: prints just the number and its unit";

#[derive(Debug, clap::Args)]
#[command(after_help = "Values are in mm or degrees, or take a unit: 20um, 0.5in, 15arcmin, 0.3mrad.

Examples:
  rackmesh calc over-roller --measured 25.0131 --nominal 25
  rackmesh calc pitch 20um --pressure-angle 20 --helix-angle 12 --explain
  rackmesh calc lead --inverse 50um --face-width 19.7 --pressure-angle 19.9
  rackmesh calc over-pin --normal-module 2 --pressure-angle 20 --pin 4 --datum 22")]
pub(super) struct Args {
    #[command(subcommand)]
    formula: Formula,
}

#[derive(Debug, Subcommand)]
enum Formula {
    /// ΔCD from the over-roller error of the rack.
    #[command(after_help = "Example:
  rackmesh calc over-roller --measured 25.0131 --nominal 25")]
    OverRoller(Signed),
    /// ΔCD from a pitch error of the rack.
    #[command(after_help = "Examples:
  rackmesh calc pitch 20um --pressure-angle 20 --helix-angle 12
  rackmesh calc pitch --inverse 50um --pressure-angle 20")]
    Pitch(Pitch),
    /// ΔCD from a lead angle error of the rack.
    #[command(after_help = "Examples:
  rackmesh calc lead 0.25deg --face-width 19.7 --pressure-angle 19.9
  rackmesh calc lead --f-h-beta 8um --length 18 --face-width 19.7 --pressure-angle 19.9")]
    Lead(Lead),
    /// ΔCD from the radial measurement error of the pinion.
    #[command(after_help = "Example:
  rackmesh calc radial --measured 8.512 --nominal 8.5")]
    Radial(Signed),
    /// ΔCD from a single pitch deviation of the pinion.
    #[command(after_help = "Example:
  rackmesh calc pinion-pitch 15um --pressure-angle 20 --helix-angle 25")]
    PinionPitch(Pitch),
    /// The ideal pin diameter for measuring a rack.
    #[command(after_help = "Example:
  rackmesh calc pin --normal-module 2 --pressure-angle 20")]
    Pin(Pin),
    /// The nominal measure over a chosen pin.
    #[command(after_help = "Example:
  rackmesh calc over-pin --normal-module 2 --pressure-angle 20 --pin 4 --datum 22")]
    OverPin(OverPinArgs),
    /// The difference of two over-pin measures made with different rollers.
    #[command(after_help = "Example:
  rackmesh calc roller-change --from 4 --to 3.5 --pressure-angle 20")]
    RollerChange(RollerChange),
}

/// Options of every calculation.
#[derive(Debug, clap::Args)]
struct Common {
    /// The unit of the result; mm or deg unless given.
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Round the result to this many decimals; all digits, and at least six decimals, unless given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=100))]
    decimals: Option<u8>,
    /// Show the formula with the numbers put in.
    #[arg(long)]
    explain: bool,
    /// Write the result in this format instead of a single line.
    #[arg(long, value_enum, conflicts_with = "explain")]
    format: Option<Format>,
}

/// The error, or the ΔCD of which the error is asked.
#[derive(Debug, clap::Args)]
struct Given {
    /// The error; with --inverse, the ΔCD.
    #[arg(allow_hyphen_values = true)]
    value: Option<String>,
    /// The measured value; the error is measured - nominal.
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
}

#[derive(Debug, clap::Args)]
struct Signed {
    #[command(flatten)]
    given: Given,
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, clap::Args)]
struct Pitch {
    #[command(flatten)]
    given: Given,
    /// Normal pressure angle α_n.
    #[arg(long)]
    pressure_angle: Angle,
    /// Helix angle β of the part that has the error, right hand positive.
    #[arg(long, default_value = "0", allow_hyphen_values = true)]
    helix_angle: Angle,
    /// Formula exact for rigid teeth, or as the paper prints it.
    #[arg(long, value_enum, default_value_t)]
    model: ModelArg,
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, clap::Args)]
struct Lead {
    #[command(flatten)]
    given: Given,
    /// Helix slope deviation f_Hβ, in place of the angle.
    #[arg(long, requires = "length", conflicts_with_all = ["value", "measured", "inverse"],
          allow_hyphen_values = true)]
    f_h_beta: Option<Length>,
    /// Evaluation length of the helix slope deviation.
    #[arg(long, requires = "f_h_beta")]
    length: Option<Length>,
    /// Face width k of the rack.
    #[arg(long)]
    face_width: Length,
    /// Normal pressure angle α_n.
    #[arg(long)]
    pressure_angle: Angle,
    /// Helix angle β_r of the rack, right hand positive.
    #[arg(long, default_value = "0", allow_hyphen_values = true)]
    helix_angle: Angle,
    /// Formula exact for rigid teeth, or as the paper prints it.
    #[arg(long, value_enum, default_value_t)]
    model: ModelArg,
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, clap::Args)]
struct Pin {
    /// Normal module m_n.
    #[arg(long)]
    normal_module: Length,
    /// Normal pressure angle α_n.
    #[arg(long)]
    pressure_angle: Angle,
    /// Normal tooth thickness s_n; π m_n / 2 unless given.
    #[arg(long)]
    tooth_thickness: Option<Length>,
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, clap::Args)]
struct OverPinArgs {
    /// Normal module m_n.
    #[arg(long)]
    normal_module: Length,
    /// Normal pressure angle α_n.
    #[arg(long)]
    pressure_angle: Angle,
    /// Pin diameter d_p.
    #[arg(long)]
    pin: Length,
    /// Distance K from the datum to the reference plane.
    #[arg(long)]
    datum: Length,
    /// Normal tooth thickness s_n; π m_n / 2 unless given.
    #[arg(long)]
    tooth_thickness: Option<Length>,
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, clap::Args)]
struct RollerChange {
    /// Diameter of the roller that is replaced.
    #[arg(long)]
    from: Length,
    /// Diameter of the roller that replaces it.
    #[arg(long)]
    to: Length,
    /// Normal pressure angle α_n.
    #[arg(long)]
    pressure_angle: Angle,
    #[command(flatten)]
    common: Common,
}

/// What a ΔCD formula is asked for.
enum Asked<E> {
    /// ΔCD of this error.
    DeltaCd(E),
    /// The largest error within this ΔCD.
    Error(Length),
}

fn usage(message: impl Into<String>) -> Failure {
    Diagnostic::error(Code::Usage, message).help("`rackmesh calc --help` shows examples").into()
}

/// A value that a formula refuses.
fn refused(error: &DomainError) -> Failure {
    let code = match error {
        DomainError::Outside { .. } | DomainError::NoSpace { .. } => Code::OutOfDomain,
        DomainError::NeverReached { .. } | DomainError::Overflow(_) => Code::NoResult,
    };
    Diagnostic::error(code, error.to_string()).into()
}

fn read<Q: std::str::FromStr<Err = QuantityError>>(text: &str) -> Result<Q, Failure> {
    text.parse().map_err(|error: QuantityError| Diagnostic::error(Code::BadQuantity, error.to_string()).into())
}

impl Given {
    fn asked<E>(&self, subtract: impl Fn(&E, &E) -> E) -> Result<Asked<E>, Failure>
    where
        E: std::str::FromStr<Err = QuantityError>,
    {
        match (&self.value, &self.measured, &self.nominal, &self.inverse) {
            (None, _, _, Some(Some(delta_cd))) | (Some(delta_cd), _, _, Some(None)) => {
                Ok(Asked::Error(read(delta_cd)?))
            }
            (Some(_), _, _, Some(Some(_))) => Err(usage("--inverse already gives the ΔCD; leave the other value out")),
            (None, _, _, Some(None)) => Err(usage("--inverse needs a ΔCD: --inverse 50um")),
            (Some(error), ..) => Ok(Asked::DeltaCd(read(error)?)),
            (None, Some(measured), Some(nominal), None) => {
                Ok(Asked::DeltaCd(subtract(&read(measured)?, &read(nominal)?)))
            }
            (None, ..) => {
                Err(usage("give the error (such as 20um), or --measured and --nominal, or --inverse with a ΔCD"))
            }
        }
    }
}

impl Common {
    fn unit(&self, is_angle: bool) -> Result<ResultUnit, Failure> {
        let invalid = |dimension: &str, names: &str, unit: &str| {
            let message = format!("the result is {dimension}, and `{unit}` is none of its units: {names}");
            usage(message)
        };
        let written = self.unit.as_deref();
        if is_angle {
            let unit = written.unwrap_or("deg");
            AngleUnit::from_symbol(unit)
                .map(|known| ResultUnit::Angle(known, unit.to_owned()))
                .ok_or_else(|| invalid("an angle", AngleUnit::NAMES, unit))
        } else {
            let unit = written.unwrap_or("mm");
            LengthUnit::from_symbol(unit)
                .map(|known| ResultUnit::Length(known, unit.to_owned()))
                .ok_or_else(|| invalid("a length", LengthUnit::NAMES, unit))
        }
    }

    /// Prints a result: its line, its explanation, or a report.
    fn print(
        &self,
        output: &mut Output,
        formula: &'static str,
        result: Computed,
        models: Option<(Model, Computed)>,
        is_bound: bool,
    ) -> Result<Status, Failure> {
        let (model, other) = models.unzip();
        let calculation = Calculation {
            formula,
            unit: self.unit(matches!(result.value, ErrorValue::Angle(_)))?,
            result,
            model,
            other,
            decimals: self.decimals.map(usize::from),
            is_bound,
        };
        if let Some(format) = self.format {
            output.report(&calculation, format)?;
        } else if self.explain {
            output.text(&calculation.explanation())?;
        } else {
            output.text(&format!("{}\n", calculation.line()))?;
            if let Some(remark) = calculation.model_remark() {
                output.remark(&remark);
            }
        }
        Ok(Status::Pass)
    }
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        match self.formula {
            Formula::OverRoller(args) => signed(&args, output, "rack-over-roller", ["M", "M_nom"]),
            Formula::Radial(args) => signed(&args, output, "pinion-radial", ["r", "r_nom"]),
            Formula::Pitch(args) => {
                let formula = RackPitch::new(&args.pressure_angle, &args.helix_angle).map_err(|e| refused(&e))?;
                pitch(&args, output, "rack-pitch", ["Δp", "β_r"], |asked, model| match asked {
                    Asked::DeltaCd(error) => formula.delta_cd(error, model),
                    Asked::Error(delta_cd) => formula.largest_error(delta_cd, model),
                })
            }
            Formula::PinionPitch(args) => {
                let formula = PinionPitch::new(&args.pressure_angle, &args.helix_angle).map_err(|e| refused(&e))?;
                pitch(&args, output, "pinion-pitch", ["f_p", "β_p"], |asked, model| match asked {
                    Asked::DeltaCd(error) => formula.delta_cd(error, model),
                    Asked::Error(delta_cd) => formula.largest_error(delta_cd, model),
                })
            }
            Formula::Lead(args) => lead(&args, output),
            Formula::Pin(args) => pin(&args, output),
            Formula::OverPin(args) => over_pin(&args, output),
            Formula::RollerChange(args) => roller_change_line(&args, output),
        }
    }
}

/// The formulas whose ΔCD is the error itself.
fn signed(
    args: &Signed,
    output: &mut Output,
    formula: &'static str,
    [measure, nominal]: [&str; 2],
) -> Result<Status, Failure> {
    let given = &args.given;
    let (equation, with_numbers, value) = match given.asked::<Length>(|a, b| a - b)? {
        Asked::DeltaCd(error) => {
            let numbers = match (&given.measured, &given.nominal) {
                (Some(measured), Some(nominal)) => {
                    format!("{} - {}", read::<Length>(measured)?, read::<Length>(nominal)?)
                }
                _ => error.to_string(),
            };
            let delta_cd = if formula == "pinion-radial" {
                pinion_radial::delta_cd(&error)
            } else {
                over_roller::delta_cd(&error)
            };
            (format!("ΔCD = {measure} - {nominal}"), numbers, delta_cd)
        }
        Asked::Error(delta_cd) => {
            (format!("{measure} - {nominal} = ΔCD"), delta_cd.to_string(), over_roller::largest_error(&delta_cd))
        }
    };
    let result = Computed { equation, with_numbers, value: ErrorValue::Length(value) };
    args.common.print(output, formula, result, None, given.inverse.is_some())
}

fn pitch(
    args: &Pitch,
    output: &mut Output,
    formula: &'static str,
    [error, helix]: [&str; 2],
    compute: impl Fn(&Asked<Length>, Model) -> Result<Length, DomainError>,
) -> Result<Status, Failure> {
    let asked = args.given.asked::<Length>(|a, b| a - b)?;
    let (alpha, beta) = (&args.pressure_angle, &args.helix_angle);
    let computed = |model| -> Result<Computed, Failure> {
        let value = ErrorValue::Length(compute(&asked, model).map_err(|e| refused(&e))?);
        let (equation, with_numbers) = match (&asked, model) {
            (Asked::DeltaCd(e), Model::Exact) => (
                format!("ΔCD = |{error}| cos {helix} / (2 tan α_n)"),
                format!("|{e}| · cos {beta} / (2 · tan {alpha})"),
            ),
            (Asked::DeltaCd(e), Model::Paper) => {
                (format!("ΔCD = |{error}| / (2 tan α_n)"), format!("|{e}| / (2 · tan {alpha})"))
            }
            (Asked::Error(d), Model::Exact) => {
                (format!("|{error}| = 2 ΔCD tan α_n / cos {helix}"), format!("2 · {d} · tan {alpha} / cos {beta}"))
            }
            (Asked::Error(d), Model::Paper) => (format!("|{error}| = 2 ΔCD tan α_n"), format!("2 · {d} · tan {alpha}")),
        };
        Ok(Computed { equation, with_numbers, value })
    };
    print_models(&args.common, output, formula, args.model.into(), matches!(asked, Asked::Error(_)), computed)
}

/// Prints the chosen model's value and, if it has one, the other's.
fn print_models(
    common: &Common,
    output: &mut Output,
    formula: &'static str,
    model: Model,
    is_bound: bool,
    computed: impl Fn(Model) -> Result<Computed, Failure>,
) -> Result<Status, Failure> {
    let other = if model == Model::Exact { Model::Paper } else { Model::Exact };
    let result = computed(model)?;
    // the other model may have no value where the chosen one has
    let other = computed(other).unwrap_or_else(|_| result.clone());
    common.print(output, formula, result, Some((model, other)), is_bound)
}

fn lead(args: &Lead, output: &mut Output) -> Result<Status, Failure> {
    let (alpha, beta, k) = (&args.pressure_angle, &args.helix_angle, &args.face_width);
    let asked = match (&args.f_h_beta, &args.length) {
        (Some(slope), Some(length)) => {
            Asked::DeltaCd(RackLead::error_from_slope(slope, length).map_err(|e| refused(&e))?)
        }
        _ => args.given.asked::<Angle>(|a, b| a - b)?,
    };
    let formula = RackLead::new(alpha, beta, k).map_err(|e| refused(&e))?;
    let computed = |model| -> Result<Computed, Failure> {
        let value = match &asked {
            Asked::DeltaCd(error) => formula.delta_cd(error, model).map(ErrorValue::Length),
            Asked::Error(delta_cd) => formula.largest_error(delta_cd, model).map(ErrorValue::Angle),
        };
        let (equation, with_numbers) = match (&asked, model) {
            (Asked::DeltaCd(e), Model::Exact) => (
                "ΔCD = k |sin Δβ| / (2 cos β_r tan α_n)".to_owned(),
                format!("{k} · |sin {e}| / (2 · cos {beta} · tan {alpha})"),
            ),
            (Asked::DeltaCd(e), Model::Paper) => {
                ("ΔCD = k |tan Δβ| / (2 tan α_n)".to_owned(), format!("{k} · |tan {e}| / (2 · tan {alpha})"))
            }
            (Asked::Error(d), Model::Exact) => (
                "|Δβ| = asin(2 ΔCD cos β_r tan α_n / k)".to_owned(),
                format!("asin(2 · {d} · cos {beta} · tan {alpha} / {k})"),
            ),
            (Asked::Error(d), Model::Paper) => {
                ("|Δβ| = atan(2 ΔCD tan α_n / k)".to_owned(), format!("atan(2 · {d} · tan {alpha} / {k})"))
            }
        };
        Ok(Computed { equation, with_numbers, value: value.map_err(|e| refused(&e))? })
    };
    print_models(&args.common, output, "rack-lead", args.model.into(), matches!(asked, Asked::Error(_)), computed)
}

fn pin(args: &Pin, output: &mut Output) -> Result<Status, Failure> {
    let diameter = ideal_pin::diameter(&args.normal_module, &args.pressure_angle, args.tooth_thickness.as_ref())
        .map_err(|e| refused(&e))?;
    let result = Computed {
        equation: format!("d_p' = (π m_n - {}) / cos α_n", thickness_symbol(args.tooth_thickness.as_ref())),
        with_numbers: format!(
            "(π · {} - {}) / cos {}",
            args.normal_module,
            thickness_number(&args.normal_module, args.tooth_thickness.as_ref()),
            args.pressure_angle
        ),
        value: ErrorValue::Length(diameter),
    };
    args.common.print(output, "ideal-pin", result, None, false)
}

fn thickness_symbol(tooth_thickness: Option<&Length>) -> &'static str {
    if tooth_thickness.is_some() { "s_n" } else { "π m_n / 2" }
}

fn thickness_number(normal_module: &Length, tooth_thickness: Option<&Length>) -> String {
    tooth_thickness.map_or_else(|| format!("π · {normal_module} / 2"), Length::to_string)
}

fn over_pin(args: &OverPinArgs, output: &mut Output) -> Result<Status, Failure> {
    let measure = OverPin {
        normal_module: args.normal_module.clone(),
        normal_pressure_angle: args.pressure_angle.clone(),
        tooth_thickness: args.tooth_thickness.clone(),
        pin_diameter: args.pin.clone(),
        datum: args.datum.clone(),
    }
    .measure()
    .map_err(|e| refused(&e))?;
    let thickness = args.tooth_thickness.as_ref();
    let result = Computed {
        equation: format!(
            "M = K - (π m_n - {}) / (2 tan α_n) + (d_p / 2) (1 + 1 / sin α_n)",
            thickness_symbol(thickness)
        ),
        with_numbers: format!(
            "{K} - (π · {m} - {s}) / (2 · tan {alpha}) + ({d} / 2) · (1 + 1 / sin {alpha})",
            K = args.datum,
            m = args.normal_module,
            s = thickness_number(&args.normal_module, thickness),
            alpha = args.pressure_angle,
            d = args.pin
        ),
        value: ErrorValue::Length(measure),
    };
    args.common.print(output, "over-pin", result, None, false)
}

fn roller_change_line(args: &RollerChange, output: &mut Output) -> Result<Status, Failure> {
    let difference = roller_change::difference(&args.from, &args.to, &args.pressure_angle).map_err(|e| refused(&e))?;
    let result = Computed {
        equation: "ΔM = (D_2 - D_1) / 2 · (1 + 1 / sin α_n)".to_owned(),
        with_numbers: format!("({} - {}) / 2 · (1 + 1 / sin {})", args.to, args.from, args.pressure_angle),
        value: ErrorValue::Length(difference),
    };
    args.common.print(output, "roller-change", result, None, false)
}
