//! `rackmesh reproduce`: the paper's tables and its last figure beside the computed ones.

use std::path::PathBuf;

use super::bar::SharedBar;
use super::output::{Failure, Output, Status};
use super::picture::Picture;
use super::target;
use crate::diagnostic::{Code, Diagnostic};
use crate::report::chart::{Chart, Layer, Shape};
use crate::report::{Format, Reproduction};
use crate::reproduction::PaperTable;

pub(super) const ABOUT: &str = "Recompute the paper's Tables 1 to 3 beside what it prints";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh reproduce
  rackmesh reproduce --plots figures      the paper's last figure, and the same for pitch and lead

Exit status: 0 if every analytic entry agrees to the printed digit and every row was simulated, 1 if not.")]
pub(super) struct Args {
    /// Draw the centre distance over the stroke into this folder, two pictures for each table.
    #[arg(long, value_name = "FOLDER")]
    plots: Option<PathBuf>,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
}

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        if let Some(folder) = &self.plots {
            target::create_folder(folder)?;
        }
        let bar = SharedBar::new(output);
        let reproduction = Reproduction::new(&|share| bar.show(Some(share), "simulating the rows of Tables 1 to 3"));
        drop(bar);
        let reproduction = reproduction.map_err(Diagnostic::with_code(Code::NoResult))?;
        if let Some(folder) = &self.plots {
            for (table, name, what) in [
                (PaperTable::OverRoller, "over-roller", "Over-roller error ΔM [mm]"),
                (PaperTable::Pitch, "pitch", "Pitch error Δp [mm]"),
                (PaperTable::Lead, "lead", "Lead angle error Δβ [deg]"),
            ] {
                for (sign, suffix) in [('+', "plus"), ('-', "minus")] {
                    let curves = reproduction.curves(table, sign);
                    let layers = curves.map(|(label, points)| Layer::new(label, Shape::Line(points))).collect();
                    let title = format!("{what}: centre distance over the stroke, simulated");
                    let mut chart = Chart::along_the_stroke(&title, layers);
                    "centre distance [mm]".clone_into(&mut chart.y.label);
                    let path = folder.join(format!("{name}-{suffix}.svg"));
                    Picture::begin(&path, &[])?.draw(&chart)?.finish()?;
                }
            }
        }
        output.report(&reproduction, self.format)?;
        Ok(if reproduction.agrees() { Status::Pass } else { Status::Fail })
    }
}
