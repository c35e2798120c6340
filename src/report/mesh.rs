//! The reports of `mesh` and `measure`, and the mesh part of `eval --mesh`.

use serde_json::{Value, json};

use super::number::{plain, signed, tidy};
use super::{Block, Column, Report, Screen, Table, sketch};
use crate::decision::{Limit, Prediction, Verdict};
use crate::mesh::{Curve, Mesh, MeshError, MeshPoint, Summary};
use crate::quantity::Length;

/// A solved stroke range.
#[derive(Debug)]
pub struct MeshReport<'a> {
    /// The spec's title.
    pub title: Option<&'a str>,
    /// What was solved.
    pub mesh: &'a Mesh,
    /// The curve with its kinks, from which the summary comes.
    pub curve: &'a Curve,
    /// The strokes to list, if not the curve's own, each with its point or why there is none.
    pub grid: Option<&'a [(f64, Result<MeshPoint, MeshError>)]>,
    /// What the formulas say about the same deviations.
    pub prediction: &'a Prediction,
    /// The limit of the combined ΔCD.
    pub limit: Option<&'a Limit>,
    /// Remarks on where the deviations come from and why mesh and formulas differ.
    pub notes: Vec<String>,
    /// Room for the sketch, which is drawn on a screen only.
    pub screen: Screen,
}

const HEADER: [&str; 8] = [
    "stroke_mm",
    "delta_cd_mm",
    "center_distance_mm",
    "pinion_angle_deg",
    "right_tooth",
    "left_tooth",
    "right_contact",
    "left_contact",
];

const DEGREES_PER_RADIAN: f64 = 180.0 / std::f64::consts::PI;

/// The accuracy that the solver claims, as decimals of a millimetre: ΔCD is judged to it.
const JUDGED_DECIMALS: usize = 9;

impl MeshReport<'_> {
    fn summary(&self) -> Option<Summary> {
        self.curve.summary(self.mesh)
    }

    /// The verdict on the limit, judged to the accuracy of the solution.
    #[must_use]
    pub fn verdict(&self) -> Option<Verdict> {
        let summary = self.summary()?;
        let length = |mm: f64| format!("{mm:.JUDGED_DECIMALS$}").parse::<Length>().ok();
        Some(self.limit?.judge(&length(summary.min_mm)?, &length(summary.max_mm)?))
    }

    fn points(&self) -> impl Iterator<Item = (f64, Option<&MeshPoint>)> + '_ {
        let own = self.grid.is_none().then(|| self.curve.points.iter().map(|point| (point.stroke_mm, Some(point))));
        let grid = self.grid.into_iter().flatten().map(|(stroke, point)| (*stroke, point.as_ref().ok()));
        own.into_iter().flatten().chain(grid)
    }

    fn unconverged(&self) -> usize {
        self.points().filter(|(_, point)| point.is_some_and(|point| !point.converged())).count()
    }

    fn largest_residual_mm(&self) -> f64 {
        self.points().filter_map(|(_, point)| point).fold(0.0, |largest, point| largest.max(point.residual_mm.abs()))
    }
}

fn millimetres(mm: f64) -> String {
    super::number::millimetres(tidy(mm))
}

/// Why one number of the summary stands where it stands.
fn summary_table(summary: &Summary) -> Table {
    let row = |name: &str, value: String, at: Option<f64>| {
        vec![name.to_owned(), value, at.map_or_else(String::new, |stroke| format!("{stroke:.4}"))]
    };
    let mm = |value: f64| format!("{} mm", millimetres(value));
    let plain_mm = |value: f64| mm(value).trim_start_matches('+').to_owned();
    Table {
        columns: vec![Column::text("exact mesh"), Column::number("value"), Column::number("at stroke [mm]")],
        rows: vec![
            row("mean ΔCD", mm(summary.mean_mm), None),
            row("smallest ΔCD", mm(summary.min_mm), Some(summary.min_stroke_mm)),
            row("largest ΔCD", mm(summary.max_mm), Some(summary.max_stroke_mm)),
            row("peak to peak (F_i'' over a turn)", plain_mm(summary.peak_to_peak_mm), None),
            row("tooth to tooth (f_i'')", plain_mm(summary.tooth_to_tooth_mm), None),
            row(
                "largest rate",
                format!("{} µm/mm", signed(1000.0 * summary.largest_rate, 2).trim_start_matches('+')),
                None,
            ),
            row("transmission error, rack travel", plain_mm(summary.transmission_error_mm), None),
        ],
    }
}

/// What the formulas say, and the mesh beside it.
fn comparison_table(summary: &Summary, prediction: &Prediction) -> Table {
    let row = |name: &str, lower: f64, upper: f64| vec![name.to_owned(), millimetres(lower), millimetres(upper)];
    let mut rows: Vec<_> = prediction.terms.iter().map(|term| row(&term.what, term.lower_mm, term.upper_mm)).collect();
    let (lower, upper) = prediction.range_mm();
    rows.push(row("formulas, together", lower, upper));
    rows.push(row("exact mesh", summary.min_mm, summary.max_mm));
    Table { columns: vec![Column::text("by formula"), Column::number("from\n[mm]"), Column::number("to\n[mm]")], rows }
}

impl Report for MeshReport<'_> {
    fn json(&self) -> Value {
        let points: Vec<_> = self
            .points()
            .map(|(stroke, point)| match point {
                Some(point) => json!({
                    "stroke_mm": stroke,
                    "delta_cd_mm": tidy(point.delta_cd_mm),
                    "center_distance_mm": tidy(point.center_distance_mm),
                    "pinion_angle_deg": tidy(point.pinion_angle_rad * DEGREES_PER_RADIAN),
                    "right_tooth": point.right.rack_tooth,
                    "left_tooth": point.left.rack_tooth,
                    "right_contact": point.right.contact.name(),
                    "left_contact": point.left.contact.name(),
                }),
                None => json!({ "stroke_mm": stroke, "delta_cd_mm": null }),
            })
            .collect();
        let summary = self.summary().map(|summary| {
            json!({
                "mean_mm": tidy(summary.mean_mm),
                "min_mm": tidy(summary.min_mm),
                "min_stroke_mm": summary.min_stroke_mm,
                "max_mm": tidy(summary.max_mm),
                "max_stroke_mm": summary.max_stroke_mm,
                "peak_to_peak_mm": tidy(summary.peak_to_peak_mm),
                "tooth_to_tooth_mm": tidy(summary.tooth_to_tooth_mm),
                "largest_rate": tidy(summary.largest_rate),
                "transmission_error_mm": tidy(summary.transmission_error_mm),
                "transmission_error_deg": tidy(summary.transmission_error_rad * DEGREES_PER_RADIAN),
            })
        });
        let (lower, upper) = self.prediction.range_mm();
        json!({
            "title": self.title,
            "nominal_center_distance_mm": self.mesh.pair().nominal_center_distance_mm(),
            "tolerance_mm": self.curve.tolerance_mm,
            "largest_residual_mm": self.largest_residual_mm(),
            "unconverged": self.unconverged(),
            "resolved": self.curve.resolved,
            "summary": summary,
            "formula_range_mm": { "lower": lower, "upper": upper },
            "verdict": self.verdict().map(Verdict::name),
            "kinks": self.curve.kinks.iter().map(|kink| json!({
                "stroke_mm": kink.stroke_mm,
                "delta_cd_mm": tidy(kink.delta_cd_mm),
                "right_tooth": kink.after.0.rack_tooth,
                "left_tooth": kink.after.1.rack_tooth,
            })).collect::<Vec<_>>(),
            "points": points,
            "notes": self.notes,
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let mut rows = vec![HEADER.map(str::to_owned).to_vec()];
        rows.extend(self.points().map(|(stroke, point)| {
            let mut row = vec![plain(stroke)];
            match point {
                Some(point) => row.extend([
                    plain(tidy(point.delta_cd_mm)),
                    plain(tidy(point.center_distance_mm)),
                    plain(tidy(point.pinion_angle_rad * DEGREES_PER_RADIAN)),
                    point.right.rack_tooth.to_string(),
                    point.left.rack_tooth.to_string(),
                    point.right.contact.to_string(),
                    point.left.contact.to_string(),
                ]),
                None => row.resize(HEADER.len(), String::new()),
            }
            row
        }));
        rows
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = Vec::new();
        if let Some(title) = self.title {
            blocks.push(Block::Title(title.to_owned()));
        }
        let Some(summary) = self.summary() else { return blocks };
        blocks.push(Block::Table(summary_table(&summary)));
        if let Some(width) = self.screen.width {
            let points: Vec<_> =
                self.curve.points.iter().map(|point| (point.stroke_mm, tidy(point.delta_cd_mm))).collect();
            blocks.extend(sketch::sketch(&points, usize::from(width.min(100)), 8).map(Block::Drawing));
        }
        blocks.push(Block::Table(comparison_table(&summary, self.prediction)));
        blocks.extend(self.notes.iter().map(|note| Block::Note(format!("note: {note}"))));
        let unconverged = self.unconverged();
        if unconverged > 0 {
            let residual = self.largest_residual_mm();
            blocks.push(Block::Note(format!(
                "note: {unconverged} strokes did not converge; the largest residual is {residual:.1e} mm"
            )));
        }
        if !self.curve.resolved {
            blocks.push(Block::Note(format!(
                "note: the curve bends too often to be resolved to {} mm everywhere; choose a shorter stroke or a larger \
                 --tolerance",
                plain(self.curve.tolerance_mm)
            )));
        }
        if let Some(verdict) = self.verdict() {
            let range = format!("{} … {} mm", millimetres(summary.min_mm), millimetres(summary.max_mm));
            let end =
                |end: Option<&Length>| end.map_or_else(|| "open".to_owned(), |end| format!("{} mm", plain(end.mm())));
            let limit = self.limit.map_or_else(String::new, |limit| {
                format!("{} … {}", end(limit.lower.as_ref()), end(limit.upper.as_ref()))
            });
            let sentence = match verdict {
                Verdict::Pass => format!("ΔCD {range} is within the limits {limit}"),
                Verdict::Fail => format!("ΔCD {range} is not within the limits {limit}"),
                Verdict::Indeterminate => format!("ΔCD {range} is too near the limits {limit}"),
            };
            blocks.push(Block::Verdict(verdict, sentence));
        }
        blocks
    }
}

/// The readings of the virtual measuring machine.
#[derive(Debug)]
pub enum MeasureReport {
    /// The rack's spaces.
    Rack {
        /// Diameter of the pin, mm.
        pin_mm: f64,
        /// Distance K from the datum to the reference plane, mm, if the spec gives it.
        datum_mm: Option<f64>,
        /// One per space.
        readings: Vec<crate::mesh::RackReading>,
    },
    /// The pinion's teeth.
    Pinion {
        /// Diameter of the ball, mm.
        ball_mm: f64,
        /// One per tooth.
        readings: Vec<crate::mesh::PinionReading>,
    },
}

impl MeasureReport {
    /// Headings, and the cells of each row; `text` writes a number.
    fn cells(&self, text: impl Fn(f64) -> String) -> (Vec<&'static str>, Vec<Vec<String>>) {
        match self {
            Self::Rack { datum_mm, readings, .. } => {
                let mut header = vec![
                    "space",
                    "over_pin_deviation_mm",
                    "position_mm",
                    "position_deviation_mm",
                    "lead_deviation_deg",
                ];
                if datum_mm.is_some() {
                    header.insert(1, "over_pin_mm");
                }
                let rows = readings.iter().map(|reading| {
                    let mut row = vec![
                        reading.space.to_string(),
                        text(tidy(reading.height_deviation_mm)),
                        text(tidy(reading.position_mm)),
                        text(tidy(reading.position_deviation_mm)),
                        text(tidy(reading.lead_rad * DEGREES_PER_RADIAN)),
                    ];
                    if let Some(datum) = datum_mm {
                        row.insert(1, text(tidy(datum + reading.over_pin_mm)));
                    }
                    row
                });
                (header, rows.collect())
            }
            Self::Pinion { readings, .. } => {
                let header = vec!["tooth", "radius_mm", "radial_deviation_mm"];
                let rows = readings.iter().map(|reading| {
                    vec![reading.tooth.to_string(), text(tidy(reading.radius_mm)), text(tidy(reading.radial_mm))]
                });
                (header, rows.collect())
            }
        }
    }

    fn note(&self) -> String {
        match self {
            Self::Rack { pin_mm, datum_mm: Some(datum), .. } => {
                format!("pin {} mm; M from the datum, {} mm below the reference plane", plain(*pin_mm), plain(*datum))
            }
            Self::Rack { pin_mm, datum_mm: None, .. } => {
                format!("pin {} mm; give rack.datum for the measure M itself", plain(*pin_mm))
            }
            Self::Pinion { ball_mm, .. } => format!("ball {} mm, in the space after each tooth", plain(*ball_mm)),
        }
    }
}

impl Report for MeasureReport {
    fn json(&self) -> Value {
        let (header, rows) = self.cells(plain);
        let rows: Vec<Value> = rows
            .iter()
            .map(|row| {
                let cells = header.iter().zip(row).map(|(name, cell)| {
                    let number = cell.parse::<i64>().map(Value::from).or_else(|_| cell.parse::<f64>().map(Value::from));
                    ((*name).to_owned(), number.unwrap_or(Value::Null))
                });
                Value::Object(cells.collect())
            })
            .collect();
        match self {
            Self::Rack { pin_mm, datum_mm, .. } => {
                json!({ "part": "rack", "pin_mm": pin_mm, "datum_mm": datum_mm, "rows": rows })
            }
            Self::Pinion { ball_mm, .. } => json!({ "part": "pinion", "pin_mm": ball_mm, "rows": rows }),
        }
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let (header, rows) = self.cells(plain);
        let mut all = vec![header.into_iter().map(str::to_owned).collect()];
        all.extend(rows);
        all
    }

    fn blocks(&self) -> Vec<Block> {
        let (header, rows) = self.cells(|value| format!("{value:.5}"));
        let columns = header.into_iter().map(|name| {
            let (name, unit) =
                name.rsplit_once('_').filter(|(_, unit)| matches!(*unit, "mm" | "deg")).unwrap_or((name, ""));
            let name = name.replace('_', " ");
            Column::number(if unit.is_empty() { name } else { format!("{name}\n[{unit}]") })
        });
        vec![Block::Table(Table { columns: columns.collect(), rows }), Block::Note(self.note())]
    }
}
