//! `rackmesh measure`: a virtual measuring machine on the deviated parts of a spec.

use std::path::PathBuf;

use super::calc::sensible;
use super::mesh::placement;
use super::output::{Failure, Output, Status};
use super::set::SetArgs;
use super::spec_files::measured_tables;
use super::teeth::{WorstTeeth, mesh_of};
use crate::deviation::{DeviationKind, Part, PinionForm, RackForm};
use crate::diagnostic::{Code, Diagnostic};
use crate::judge::LimitTarget;
use crate::judge::reached::TEETH;
use crate::mesh::Mesh;
use crate::quantity::Length;
use crate::report::{Format, MeasureReport, noted};
use crate::spec::{MeshInput, Origin, Spec, keys};

pub(super) const ABOUT: &str = "Measure virtually: roll a pin through the spaces of a spec's part";

#[derive(Debug, clap::Args)]
#[command(after_help = "What it prints can be measured data of another spec:
  rackmesh measure examples/mesh.toml --format csv > rack.csv
  (then `measured = \"rack.csv\"` below [rack])

Without --pin it is the spec's rack.pin, or a pin that touches near the reference line.
Errors without teeth, those of [errors], are put on the worst teeth that a search finds, and a note says on which.

Examples:
  rackmesh measure examples/mesh.toml --pin 3.5 --first 0 --last 12
  rackmesh measure examples/mesh.toml --part pinion")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: PathBuf,
    /// Which part.
    #[arg(long, value_enum, default_value = "rack")]
    part: Part,
    /// Diameter of the pin.
    #[arg(long, allow_hyphen_values = true)]
    pin: Option<Length>,
    /// First space of the rack; space j lies between the teeth j and j + 1.
    #[arg(long, default_value_t = -4, allow_negative_numbers = true)]
    first: i64,
    /// Last space of the rack.
    #[arg(long, default_value_t = 20, allow_negative_numbers = true)]
    last: i64,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
}

/// Spaces listed at most.
const MOST: i64 = 10_000_000;

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = self.set.read_spec(&self.spec, output)?;
        let mut input = mesh_of(&spec, &measured_tables(&spec, &self.spec, output)?)?;
        let mut said = put_on_teeth(&spec, self.part, &mut input)?;
        said.extend(unmeasured(self.part, &input.mesh));
        let mut notes = said.clone();
        let mesh = &input.mesh;
        let report = match self.part {
            Part::Rack => {
                if self.first > self.last || self.last.saturating_sub(self.first) >= MOST {
                    let message = format!("--first {} --last {} are no range of spaces", self.first, self.last);
                    return Err(Diagnostic::usage(message).into());
                }
                let ideal = || {
                    let pair = mesh.pair();
                    let space = std::f64::consts::PI * pair.normal_module_mm() - pair.rack().tooth_thickness_mm;
                    space / crate::trig::cos(pair.normal_pressure_angle_rad())
                };
                if matches!(input.origin, Origin::WorstTeeth { .. })
                    && (self.first < *TEETH.start() || self.last >= *TEETH.end())
                {
                    let (first, last) = (TEETH.start(), TEETH.end() - 1);
                    let message = format!("errors on the worst teeth are put on the spaces {first} to {last} alone");
                    return Err(Diagnostic::usage(message).help("choose --first and --last among them").into());
                }
                notes.extend(sensible(output, &[("--pin", self.pin.and_then(|pin| spec.doubted_pin(pin)))])?);
                let written = self.pin.or(spec.get(keys::RACK_PIN));
                let pin_mm = written.map_or_else(ideal, Length::mm);
                let readings = mesh.measure_rack(pin_mm, self.first..=self.last)?;
                let datum_mm = spec.get(keys::RACK_DATUM).map(Length::mm);
                MeasureReport::of_rack(pin_mm, datum_mm, &readings, notes)
            }
            Part::Pinion => {
                let ball_mm = self.pin.map_or_else(|| mesh.pinion_ball_mm(), Length::mm);
                let readings = mesh.measure_pinion(ball_mm)?;
                MeasureReport::of_pinion(ball_mm, &readings, notes)
            }
        };
        output.report(&report, self.format)?;
        for note in &said {
            output.remark(&noted(note));
        }
        Ok(Status::Pass)
    }
}

/// Remarks on deviations of the part that no reading shows.
fn unmeasured(part: Part, mesh: &Mesh) -> Vec<String> {
    let (rack, pinion) = (mesh.rack(), mesh.pinion());
    let is_eccentric = pinion.eccentricity_mm() != (0.0, 0.0);
    let has_lead = pinion.teeth().iter().any(|tooth| tooth.left.lead_rad != 0.0 || tooth.right.lead_rad != 0.0);
    let untold = match part {
        Part::Rack => vec![(*rack.form() != RackForm::default(), "the tip relief and the crowning of its flanks")],
        Part::Pinion => vec![
            (is_eccentric, "its eccentricity, for it turns about the axis of its teeth"),
            (has_lead || *pinion.form() != PinionForm::default(), "the leads and the form of its flanks"),
        ],
    };
    let untold = untold.into_iter().filter(|(is_wrong, _)| *is_wrong);
    untold.map(|(_, what)| format!("no reading tells of the {}: {what}", part.name())).collect()
}

/// Puts errors without known teeth on the worst ones, as `mesh` does, with a remark.
fn put_on_teeth(spec: &Spec, part: Part, input: &mut MeshInput) -> Result<Vec<String>, Failure> {
    let untold = |message: &str| {
        Diagnostic::error(Code::BadTeeth, message)
            .help("give the deviation of each tooth: [[rack.deviation]], [[pinion.deviation]]")
    };
    let is_of_part = |(kind, _): &(DeviationKind, _)| kind.part() == part;
    if !spec.scatter.is_empty() && spec.errors.is_empty() && !spec.knows_teeth(part) {
        return Err(untold("[scatter] does not tell which tooth has which deviation").into());
    }
    if input.origin == Origin::Teeth && spec.errors.iter().any(is_of_part) {
        return Err(untold("[errors] do not tell which teeth have them, beside those of the other part").into());
    }
    if matches!(input.origin, Origin::Errors { .. }) {
        let worst = WorstTeeth::of(spec.part_errors_or_none()?, &spec.basis()?)?;
        let message = "[errors] do not tell which teeth have them, and the worst ones are not known: the rack may roll, or an error is too large";
        worst.ok_or_else(|| untold(message))?.place(input, spec.limit_on(LimitTarget::CenterDistance))?;
    }
    let left_out = "[scatter] is left out: it does not tell which tooth has which deviation".to_owned();
    Ok(placement(input).into_iter().chain((!spec.scatter.is_empty()).then_some(left_out)).collect())
}
