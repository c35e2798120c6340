//! `rackmesh measure`: a virtual measuring machine on the deviated parts of a spec.

use clap::ValueEnum;

use super::output::{Failure, Output, Status};
use super::set::SetArgs;
use super::spec_files::{measured_tables, unsolved};
use crate::diagnostic::{Code, Diagnostic};
use crate::quantity::Length;
use crate::report::{Format, MeasureReport};
use crate::spec::keys;

pub(super) const ABOUT: &str = "Measure virtually: roll a pin through the spaces of a spec's part";

#[derive(Debug, clap::Args)]
#[command(after_help = "What it prints can be measured data of another spec:
  rackmesh measure examples/mesh.toml --format csv > rack.csv
  (then `measured = \"rack.csv\"` below [rack])

Without --pin it is the spec's rack.pin, or a pin that touches near the reference line.

Examples:
  rackmesh measure examples/mesh.toml --pin 3.5 --first 0 --last 12
  rackmesh measure examples/mesh.toml --part pinion")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: String,
    /// Which part.
    #[arg(long, value_enum, default_value_t)]
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

#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum Part {
    /// The rack's spaces.
    #[default]
    Rack,
    /// The pinion's spaces.
    Pinion,
}

/// Spaces listed at most.
const MOST: i64 = 10_000_000;

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = self.set.read_spec(&self.spec, output)?;
        let input = spec.mesh(&measured_tables(&spec, &self.spec)?)?;
        let mesh = &input.mesh;
        let report = match self.part {
            Part::Rack => {
                if self.first > self.last || self.last.saturating_sub(self.first) >= MOST {
                    let message = format!("--first {} --last {} are no range of spaces", self.first, self.last);
                    return Err(Diagnostic::error(Code::Usage, message).into());
                }
                let ideal = || {
                    let pair = mesh.pair();
                    let space = std::f64::consts::PI * pair.normal_module_mm() - pair.rack().tooth_thickness_mm;
                    space / crate::trig::cos(pair.normal_pressure_angle_rad())
                };
                let written = self.pin.or(spec.get(keys::RACK_PIN));
                let pin_mm = written.map_or_else(ideal, Length::mm);
                let readings = mesh.measure_rack(pin_mm, self.first..=self.last).map_err(|error| unsolved(&error))?;
                let datum_mm = spec.get(keys::RACK_DATUM).map(Length::mm);
                MeasureReport::Rack { pin_mm, datum_mm, readings }
            }
            Part::Pinion => {
                let ball_mm = self.pin.map_or_else(|| mesh.pinion_ball_mm(), Length::mm);
                let readings = mesh.measure_pinion(ball_mm).map_err(|error| unsolved(&error))?;
                MeasureReport::Pinion { ball_mm, readings }
            }
        };
        output.report(&report, self.format)?;
        Ok(Status::Pass)
    }
}
