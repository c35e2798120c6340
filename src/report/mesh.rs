//! The reports of `mesh` and `measure`, and the mesh part of `eval --mesh`.

use serde_json::{Value, json};

use super::chart::{Chart, Layer, Mark, Shape, Span};
use super::evaluation::failure_sentence;
use super::grounds::{assumed, assumptions_of};
use super::mesh_points::{self, ListedPoint, Trust};
use super::number::{SEEN_MM, interval_text, plain, stroke_text, tidy, unsigned};
use super::rows::rate_text;
use super::uncertainty::rule_words;
use super::{
    Block, Column, FunctionPart, Report, Screen, Table, TracePart, YokeSection, document, fact, geometry, noted,
    sketch, titled, worst_last,
};
use crate::deviation::Part;
use crate::evaluation::{Evaluation, subject};
use crate::function::Check;
use crate::judge::bound::Note;
use crate::judge::{Limit, LimitTarget, Prediction, Verdict};
use crate::mesh::{Curve, FlankSide, Mesh, PinionReading, RackReading, Summary};
use crate::quantity::{Length, Rounded};

/// A solved stroke range.
#[derive(Debug)]
pub struct MeshReport<'a> {
    /// The spec's title.
    pub title: Option<&'a str>,
    /// The solved mesh.
    pub mesh: &'a Mesh,
    /// The nominal measure M over the pin with its name: computed, or else as given.
    pub over_pin: Option<(&'static str, Length)>,
    /// The curve with its kinks, from which the summary comes.
    pub curve: Curve,
    /// Strokes to list in tables.
    pub listed: Vec<ListedPoint>,
    /// The same deviations by the formulas.
    pub prediction: Prediction,
    /// The limit of the combined ΔCD.
    pub limit: Option<&'a Limit>,
    /// The range that the limits judge, over all strokes at which a deviated tooth can carry or wherever errors are, and its
    /// verdicts.
    pub evaluation: Evaluation,
    /// The yoke over the stroke, if the spec has one.
    pub yoke: Option<YokeSection>,
    /// A measured curve, if there is one.
    pub measured: Option<TracePart>,
    /// Remarks on where the deviations come from and why mesh and formulas differ.
    pub notes: Vec<String>,
    /// Room for the sketch, which is drawn on a screen only.
    pub screen: Screen,
}

impl MeshReport<'_> {
    fn summary(&self) -> Option<Summary> {
        self.curve.summary(self.mesh)
    }

    /// What ΔCD is at every stroke, in a sentence; `None` of a curve that varies.
    #[must_use]
    pub fn level(&self) -> Option<String> {
        let summary = self.summary().filter(|summary| summary.peak_to_peak_mm < SEEN_MM)?;
        let (from, to) = (self.curve.points.first()?.stroke_mm, self.curve.points.last()?.stroke_mm);
        Some(format!("ΔCD is {} mm at every stroke from {from} to {to} mm.", millimetres(summary.mean_mm)))
    }

    /// The picture of the curve, with its limits.
    #[must_use]
    pub fn chart(&self) -> Chart {
        if let Some(measured) = &self.measured {
            return measured.chart(self.title.unwrap_or("ΔCD along the stroke"));
        }
        let marks = self.curve.kinks.iter().filter_map(|kink| {
            let (before, after) = (kink.before, kink.after);
            let text = match (before.0.rack_tooth != after.0.rack_tooth, before.1.rack_tooth != after.1.rack_tooth) {
                (true, true) => format!("r{} l{}", after.0.rack_tooth, after.1.rack_tooth),
                (true, false) => format!("r{}", after.0.rack_tooth),
                (false, true) => format!("l{}", after.1.rack_tooth),
                // the place on the flank changes, not the tooth
                (false, false) => return None,
            };
            Some(Mark { x: kink.stroke_mm, y: kink.delta_cd_mm, text })
        });
        let limits = self.limit.copied().into_iter().flat_map(Limit::ends);
        let points: Vec<_> = self.curve.points.iter().map(|point| (point.stroke_mm, point.delta_cd_mm)).collect();
        let (low, high) = self.prediction.range_mm();
        let ends = points.first().into_iter().chain(points.last());
        let mut layers = vec![
            Layer::new("formulas", Shape::Band(ends.map(|(x, _)| Span { x: *x, low, high }).collect())),
            Layer::new("limits", Shape::Limits(limits.map(Length::mm).collect())),
            Layer::new("exact mesh", Shape::Line(points)),
            Layer::new("contact moves to the right (r) or left (l) flank of a tooth", Shape::Marks(marks.collect())),
        ];
        layers.extend(self.curve.extremes().and_then(|ends| {
            let ends = ends.map(|point| CurveEnd {
                stroke_mm: point.stroke_mm,
                delta_cd_mm: point.delta_cd_mm,
                rack_teeth: [point.right, point.left].map(|carrier| Some(carrier.rack_tooth)),
            });
            extreme_in_words(ends, self.mesh.pair().pinion().teeth)
        }));
        Chart::along_the_stroke(self.title.unwrap_or("ΔCD along the stroke"), layers)
    }

    /// The outcome of the limits on a yoke.
    fn checks(&self) -> &[Check] {
        self.yoke.as_ref().map_or(&[], YokeSection::checks)
    }

    /// The yoke's figures on the curve, where they are known.
    #[must_use]
    pub fn function(&self) -> Option<&FunctionPart> {
        self.yoke.as_ref()?.known()
    }

    /// How far the curve's own points can be trusted.
    fn trust(&self) -> Trust {
        self.curve.points.iter().fold(Trust::default(), |trust, point| trust.and(Trust::of_point(Ok(point))))
    }

    /// The JSON before and after the elements of its array of points, for a list that is written as it is solved.
    /// The text before does not depend on `trust`.
    #[must_use]
    pub fn json_around(&self, trust: Trust) -> (String, String) {
        let text = format!("{:#}\n", document(self.json_with(&Value::Null, trust)));
        // a line break within a JSON string is escaped, so this is the key itself
        let (before, after) = text.split_once("\n  \"points\": null").unwrap_or((&text, ""));
        (format!("{before}\n  \"points\": ["), format!("\n  ]{after}"))
    }
}

/// The smallest or the largest ΔCD of a curve.
#[derive(Debug, Clone, Copy)]
pub struct CurveEnd {
    /// Its stroke, mm.
    pub stroke_mm: f64,
    /// ΔCD, mm.
    pub delta_cd_mm: f64,
    /// The rack teeth that carry there, on their right and on their left flank.
    pub rack_teeth: [Option<i64>; 2],
}

/// The end of a curve that is farther from 0, the largest of equals: its stroke and the teeth that carry there, all in the legend.
/// `ends` are the smallest and the largest ΔCD, `teeth` is the number of the pinion's teeth.
#[must_use]
pub fn extreme_in_words(ends: [CurveEnd; 2], teeth: u32) -> Option<Layer> {
    let farther = |a: &CurveEnd, b: &CurveEnd| a.delta_cd_mm.abs().total_cmp(&b.delta_cd_mm.abs());
    let end = ends.into_iter().max_by(farther)?;
    let carriers = [FlankSide::Right, FlankSide::Left].into_iter().zip(end.rack_teeth);
    let carriers = carriers
        .filter_map(|(side, tooth)| Some(format!("{side} {}/{}", tooth?, side.pinion_tooth(tooth?, teeth))))
        .collect::<Vec<_>>();
    let text = format!(
        "extreme {} mm at stroke {:.2} mm; teeth rack/pinion: {}",
        millimetres(end.delta_cd_mm),
        end.stroke_mm,
        carriers.join(", ")
    );
    let mark = Mark { x: end.stroke_mm, y: end.delta_cd_mm, text: String::new() };
    Some(Layer::new(&text, Shape::Marks(vec![mark])))
}

/// The outcome of each limit, in a sentence.
pub(super) fn verdicts(evaluation: &Evaluation) -> impl Iterator<Item = Block> {
    let Evaluation { rule, judged_by, .. } = evaluation;
    let assumed = assumed(&assumptions_of(evaluation));
    let rejected = evaluation.rejection().map(|why| Block::Verdict(Some(Verdict::Fail), why));
    let of_limits = evaluation.limits.iter().map(move |check| {
        let by = match check.on {
            LimitTarget::CenterDistance => format!("judged by {judged_by}{}", rule_words(rule)),
            LimitTarget::Error(_) => format!("what it does alone{}", rule_words(rule)),
        };
        let sentence = match (check.result, check.open_because(*judged_by, rule)) {
            (_, Some(why)) => why,
            (Ok(_), None) if check.verdict == Some(Verdict::Fail) => {
                format!("{} ({by})", failure_sentence(check, *judged_by))
            }
            (result, None) => {
                let result = result.map(|result| interval_text(&result)).unwrap_or_default();
                let assumed = if check.verdict == Some(Verdict::Pass) { assumed.as_str() } else { "" };
                format!(
                    "{}: {result} mm is within the limit{assumed} ({}; {by})",
                    subject(check.on, *judged_by),
                    check.limit
                )
            }
        };
        Block::Verdict(check.verdict, sentence)
    });
    of_limits.chain(rejected)
}

fn millimetres(mm: f64) -> String {
    super::number::millimetres(tidy(mm))
}

/// The numbers of the summary, and where the extremes are.
fn summary_table(summary: &Summary) -> Block {
    let mm = |value: f64| format!("{} mm", millimetres(value));
    let plain_mm = |value: f64| format!("{} mm", unsigned(tidy(value)));
    let rows = [
        ("mean ΔCD", mm(summary.mean_mm), None),
        ("smallest ΔCD", mm(summary.min_mm), Some(summary.min_stroke_mm)),
        ("largest ΔCD", mm(summary.max_mm), Some(summary.max_stroke_mm)),
        ("peak to peak, the pair's own variation", plain_mm(summary.peak_to_peak_mm), None),
        ("tooth to tooth, the pair's own", plain_mm(summary.tooth_to_tooth_mm), None),
        ("largest rate", format!("{} µm/mm", rate_text(summary.largest_rate)), None),
        ("transmission error, rack travel", plain_mm(summary.transmission_error_mm), None),
    ];
    Table::of(rows)
        .text("exact mesh", |(name, ..)| *name)
        .number("value", |(_, value, _)| value.clone())
        .number("at stroke [mm]", |(.., at)| at.map(stroke_text).unwrap_or_default())
        .block()
}

/// The range of the formulas, what they leave out, and the range of the mesh.
fn comparison_table(summary: &Summary, prediction: &Prediction, notes: &[Note]) -> Block {
    let (lower, upper) = prediction.range_mm();
    let left_out = notes.iter().filter_map(|note| match note {
        Note::OwnRange(own) => Some(("share of form and geometry in the bound", own.lower, own.upper)),
        _ => None,
    });
    let together = std::iter::once(("formulas, together", lower, upper)).chain(left_out);
    let together = together.chain([("exact mesh", summary.min_mm, summary.max_mm)]);
    let terms = prediction.terms.iter().map(|term| (term.what.as_str(), term.lower_mm, term.upper_mm));
    Table::of(terms.chain(together))
        .text("by formula", |(what, ..)| *what)
        .number("from\n[mm]", |(_, lower, _)| millimetres(*lower))
        .number("to\n[mm]", |(.., upper)| millimetres(*upper))
        .block()
}

impl MeshReport<'_> {
    fn json_with(&self, points: &Value, trust: Trust) -> Value {
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
                "transmission_error_deg": tidy(summary.transmission_error_rad.to_degrees()),
            })
        });
        let (lower, upper) = self.prediction.range_mm();
        let mut json = json!({
            "title": self.title,
            "geometry": geometry::json(self.mesh.pair(), self.over_pin),
            "nominal_center_distance_mm": self.mesh.pair().nominal_center_distance_mm(),
            "tolerance_mm": self.curve.tolerance_mm,
            "resolved": self.curve.resolved,
            "summary": summary,
            "formula_range_mm": { "lower": lower, "upper": upper },
            "judged_mm": self.evaluation.judged.ok(),
            "judged_by": self.evaluation.judged_by.name(),
            "verdict": self.evaluation.verdict_with(self.checks()).map(Verdict::name),
            "reason": self.evaluation.reason_with(self.checks()),
            "assumes": assumptions_of(&self.evaluation),
            "kinks": self.curve.kinks.iter().map(|kink| json!({
                "stroke_mm": kink.stroke_mm,
                "delta_cd_mm": tidy(kink.delta_cd_mm),
                "right_tooth": kink.after.0.rack_tooth,
                "left_tooth": kink.after.1.rack_tooth,
            })).collect::<Vec<_>>(),
            "points": points,
            "interrupted": trust.interrupted,
            "largest_residual_mm": trust.largest_residual_mm,
            "unconverged": trust.unconverged,
            "roll_not_found": trust.roll_not_found,
            "notes": self.notes,
        });
        if let Some(yoke) = &self.yoke {
            json["yoke"] = yoke.json();
        }
        if let Some(measured) = &self.measured {
            json["measured"] = measured.json();
            if let Some(diagnosis) = measured.diagnosis_json() {
                json["diagnosis"] = diagnosis;
            }
        }
        json
    }
}

impl Report for MeshReport<'_> {
    fn json(&self) -> Value {
        let at = |index: usize| self.function().and_then(|part| part.function.along.get(index));
        let points = self.curve.points.iter().enumerate();
        let points = points.map(|(index, point)| mesh_points::json_point(point.stroke_mm, Some(point), at(index)));
        self.json_with(&points.collect(), self.trust())
    }

    fn brief(&self) -> Value {
        self.json_with(&Value::Null, self.trust())
    }

    fn rows(&self) -> Vec<Vec<String>> {
        if let Some(measured) = &self.measured {
            return measured.rows();
        }
        fact::rows(&self.json(), "points", &mesh_points::columns(self.function().is_some()))
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = titled(self.title);
        blocks.push(geometry::table(self.mesh.pair(), self.over_pin));
        let Some(summary) = self.summary() else { return blocks };
        blocks.push(summary_table(&summary));
        if let Some(width) = self.screen.drawing_width() {
            let drawn = if let Some(measured) = &self.measured {
                sketch::sketch(&measured.curve(), "measured ΔCD [mm]", [width, 8])
            } else {
                let points = self.curve.points.iter();
                let points: Vec<_> = points.map(|point| (point.stroke_mm, tidy(point.delta_cd_mm))).collect();
                sketch::sketch(&points, "ΔCD [mm]", [width, 8])
            };
            blocks.extend(drawn.map(Block::Drawing));
        }
        blocks.push(comparison_table(&summary, &self.prediction, &self.evaluation.notes));
        blocks.extend(self.measured.iter().flat_map(TracePart::blocks));
        blocks.extend(mesh_points::table(&self.listed));
        blocks.extend(self.yoke.iter().flat_map(YokeSection::blocks));
        blocks.extend(self.notes.iter().cloned().map(Block::Remark));
        let doubts = self.trust().and(Trust::of(&self.listed)).notes();
        blocks.extend(doubts.iter().map(|doubt| Block::Note(noted(doubt))));
        if !self.curve.resolved {
            blocks.push(Block::Note(noted(&format!(
                "the curve bends too often to be resolved to {} mm everywhere; choose a shorter stroke or a larger \
                 --tolerance",
                plain(self.curve.tolerance_mm)
            ))));
        }
        blocks.extend(verdicts(&self.evaluation));
        worst_last(blocks)
    }
}

/// The readings of the virtual measuring machine.
#[derive(Debug)]
pub struct MeasureReport {
    part: Part,
    pin_mm: f64,
    datum_mm: Option<f64>,
    /// What is numbered, and what is listed of each.
    columns: Vec<&'static str>,
    rows: Vec<Vec<Value>>,
    notes: Vec<String>,
}

/// A row: its number, and values as they are printed.
fn numbered(number: i64, values: impl IntoIterator<Item = f64>) -> Vec<Value> {
    let printed = |value| serde_json::from_str(&plain(tidy(value))).unwrap_or_default();
    std::iter::once(number.into()).chain(values.into_iter().map(printed)).collect()
}

impl MeasureReport {
    /// Of the rack's spaces, by a pin of that diameter; the distance K from the datum to the reference plane, mm, if the
    /// spec gives it.
    #[must_use]
    pub fn of_rack(pin_mm: f64, datum_mm: Option<f64>, readings: &[RackReading], notes: Vec<String>) -> Self {
        const DEVIATIONS: [&str; 4] =
            ["over_pin_deviation_mm", "position_mm", "position_deviation_mm", "lead_deviation_deg"];
        let over_pin = datum_mm.map(|_| "over_pin_mm");
        let columns = ["space"].into_iter().chain(over_pin).chain(DEVIATIONS).collect();
        let row = |reading: &RackReading| {
            let over_pin = datum_mm.map(|datum| datum + reading.over_pin_mm);
            let lead_deg = reading.lead_rad.to_degrees();
            let deviations =
                [reading.height_deviation_mm, reading.position_mm, reading.position_deviation_mm, lead_deg];
            numbered(reading.space, over_pin.into_iter().chain(deviations))
        };
        Self { part: Part::Rack, pin_mm, datum_mm, columns, rows: readings.iter().map(row).collect(), notes }
    }

    /// Of the pinion's teeth, by a ball of that diameter.
    #[must_use]
    pub fn of_pinion(ball_mm: f64, readings: &[PinionReading], notes: Vec<String>) -> Self {
        let columns = vec!["tooth", "radius_mm", "radial_deviation_mm", "position_deviation_mm"];
        let row = |reading: &PinionReading| {
            numbered(reading.tooth.into(), [reading.radius_mm, reading.radial_mm, reading.position_mm])
        };
        let rows = readings.iter().map(row).collect();
        Self { part: Part::Pinion, pin_mm: ball_mm, datum_mm: None, columns, rows, notes }
    }

    fn note(&self) -> String {
        let pin = Rounded(self.pin_mm);
        match (self.part, self.datum_mm) {
            (Part::Rack, Some(datum)) => {
                format!("pin {pin} mm; M from the datum, {} mm below the reference plane", Rounded(datum))
            }
            (Part::Rack, None) => format!("pin {pin} mm; give rack.datum for the measure M itself"),
            (Part::Pinion, _) => {
                format!("ball {pin} mm, in the space after each tooth; positions along the reference circle")
            }
        }
    }
}

impl Report for MeasureReport {
    fn json(&self) -> Value {
        let fact = |row: &Vec<Value>| -> Value {
            self.columns.iter().zip(row).map(|(name, cell)| ((*name).to_owned(), cell.clone())).collect()
        };
        let mut json = json!({ "part": self.part.name(), "pin_mm": self.pin_mm });
        if self.part == Part::Rack {
            json["datum_mm"] = self.datum_mm.into();
        }
        json["rows"] = self.rows.iter().map(fact).collect();
        json["notes"] = self.notes.clone().into();
        json
    }

    fn rows(&self) -> Vec<Vec<String>> {
        // a table of measured teeth has the deviation of the radius, not the radius
        let columns: Vec<_> = self.columns.iter().copied().filter(|name| *name != "radius_mm").collect();
        fact::rows(&self.json(), "rows", &columns.join(" "))
    }

    fn blocks(&self) -> Vec<Block> {
        let columns = self.columns.iter().map(|name| {
            let (name, unit) =
                name.rsplit_once('_').filter(|(_, unit)| matches!(*unit, "mm" | "deg")).unwrap_or((name, ""));
            let name = name.replace('_', " ");
            Column::number(if unit.is_empty() { name } else { format!("{name}\n[{unit}]") })
        });
        let text = |(column, cell): (usize, &Value)| match cell.as_f64() {
            Some(value) if column > 0 => format!("{value:.5}"),
            _ => cell.to_string(),
        };
        let rows = self.rows.iter().map(|row| row.iter().enumerate().map(text).collect()).collect();
        vec![Block::Table(Table { columns: columns.collect(), rows }), Block::Note(self.note())]
    }
}
