//! `rackmesh mesh`: ΔCD along the stroke, by the exact zero-backlash mesh.

mod list;

use std::path::PathBuf;

use list::{Listed, Strokes, list, list_csv, listed_in_table};

use super::bar::Bar;
use super::decision::JudgeArgs;
use super::output::{Failure, Output, Status};
use super::picture::{PlotArgs, draw};
use super::set::SetArgs;
use super::spec_files::files_read;
use super::tables::ReadArgs;
use super::teeth::{judged, placed};
use super::trace::TraceArgs;
use super::{function, signals};
use crate::deviation::plausible::{DoubtedColumn, Reach};
use crate::deviation::{DeviationValue, FIRST_ODD_TOOTH, PinionToothRow, RackDeviationKind, RackSpaceRow, RowValue};
use crate::diagnostic::{Code, Diagnostic};
use crate::evaluation::Evaluation;
use crate::judge::{LimitTarget, Prediction};
use crate::mesh::{Curve, Mesh, STROKE_MM, Support};
use crate::quantity::Length;
use crate::report::chart::Chart;
use crate::report::mesh_points::{self, ListedPoint, Trust};
use crate::report::{Format, MeshReport, Screen, YokeSection};
use crate::spec::{MeshInput, Origin, Spec};

pub(super) const ABOUT: &str = "Solve the exact mesh of rigid teeth along the stroke, no forces";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh mesh examples/mesh.toml                      summary and a sketch of the curve
  rackmesh mesh examples/mesh.toml --plot curve.svg
  rackmesh mesh examples/master.toml --measured examples/trace.csv --diagnose
  rackmesh mesh examples/mesh.toml --from 0 --to 50 --step 0.1 --format csv

Exit status: 0 inside limits.center_distance or none given, 1 outside, 2 could not solve,
129, 130 or 143 if a signal ended it.")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: PathBuf,
    #[command(flatten)]
    range: Range,
    /// List strokes this far apart.
    #[arg(long, conflicts_with = "points", value_name = "LENGTH", allow_hyphen_values = true)]
    step: Option<Length>,
    /// List this many strokes, both ends included.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100_000_000))]
    points: Option<u32>,
    #[command(flatten)]
    plot: PlotArgs,
    #[command(flatten)]
    trace: TraceArgs,
    /// What --plot draws: ΔCD, or of a [yoke] its play or the pinion's torque.
    #[arg(long, value_enum, default_value_t, value_name = "WHAT", hide_possible_values = true)]
    plot_of: PlotOf,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
    #[command(flatten)]
    read: ReadArgs,
}

/// What is drawn along the stroke.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
enum PlotOf {
    #[default]
    DeltaCd,
    Play,
    Torque,
}

/// The stroke.
#[derive(Debug, clap::Args)]
pub(super) struct Stroke {
    /// First stroke. Default: that of rack.travel, or 0.
    #[arg(long, allow_hyphen_values = true, value_name = "LENGTH")]
    from: Option<Length>,
    /// Last stroke. Default: that of rack.travel, or 50.
    #[arg(long, allow_hyphen_values = true, value_name = "LENGTH")]
    to: Option<Length>,
}

impl Stroke {
    /// The strokes as options of a command line.
    pub(super) fn options(&self) -> Vec<String> {
        let ends = [("from", self.from), ("to", self.to)].into_iter();
        ends.filter_map(|(name, end)| Some(format!("--{name}={}", end?))).collect()
    }

    /// From the first to the last, mm.
    pub(super) fn ends(&self, spec: &Spec) -> Result<(f64, f64), Failure> {
        self.ends_or(spec.travel_mm().unwrap_or(STROKE_MM))
    }

    /// From the first to the last, mm; each of these where the option does not say it.
    pub(super) fn ends_or(&self, travel: (f64, f64)) -> Result<(f64, f64), Failure> {
        let (from, to) = (self.from.map_or(travel.0, Length::mm), self.to.map_or(travel.1, Length::mm));
        if from > to {
            let message = format!("--from {from} lies beyond --to {to}");
            return Err(Diagnostic::usage(message).into());
        }
        Ok((from, to))
    }

    /// The strokes if they are the rack's travel: the spec or both options say so.
    pub(super) fn travel(&self, spec: &Spec) -> Result<Option<(f64, f64)>, Failure> {
        let is_travel = spec.travel_mm().is_some() || (self.from.is_some() && self.to.is_some());
        is_travel.then(|| self.ends(spec)).transpose()
    }
}

/// The stroke, and how closely it is followed.
#[derive(Debug, clap::Args)]
pub(super) struct Range {
    #[command(flatten)]
    pub(super) stroke: Stroke,
    /// The promised error of the curve between its points.
    #[arg(long, default_value = "1e-6", value_name = "LENGTH", allow_hyphen_values = true)]
    pub(super) tolerance: Length,
}

/// The deviations of a mesh by the formulas.
fn prediction(input: &MeshInput) -> Result<Prediction, Failure> {
    let pair = input.mesh.pair();
    if let Origin::WorstTeeth { errors, .. } = &input.origin {
        let prediction = Prediction::placed(pair, errors);
        return prediction.map_err(|error| Diagnostic::error(Code::NoResult, error.to_string()).into());
    }
    let mut prediction = Prediction::new().rack(pair, &input.rack_deviations).pinion(pair, &input.pinion_deviations);
    if let Some(deviation_mm) = input.pinion_lead_mm {
        prediction = prediction.pinion_lead(pair, deviation_mm);
    }
    Ok(prediction.rack_rows(pair, &input.rack_rows).pinion_rows(pair, &input.pinion_rows))
}

/// A remark on which teeth, if any, the values of `[errors]` are, if the spec has no deviations per tooth.
pub(super) fn placement(input: &MeshInput) -> Option<String> {
    let on = match &input.origin {
        Origin::WorstTeeth { errors, is_upper } => {
            let errors: Vec<_> = errors.iter().map(|error| error.in_words(input.mesh.pair())).collect();
            let [end, other] = if *is_upper { ["largest", "smallest"] } else { ["smallest", "largest"] };
            format!(
                "the teeth on which a search finds the {end} ΔCD, as their extents allow (for the {other} they may be others): {}",
                errors.join("; ")
            )
        }
        Origin::Errors { elsewhere } => {
            let lead = if input.pinion_lead_mm.is_some() { ", its lead on all" } else { "" };
            let names: Vec<_> = elsewhere.iter().map(|kind| kind.name()).collect();
            let elsewhere = match &names[..] {
                [] => String::new(),
                names => {
                    format!("; the extent of {} is not followed here, `eval` has its worst case", names.join(", "))
                }
            };
            format!(
                "the teeth: over-roller and radial on all, the rack's pitch as one step before tooth {FIRST_ODD_TOOTH}, its lead on \
                 teeth {FIRST_ODD_TOOTH}.., the pinion's pitch as one step half way round{lead}{elsewhere}"
            )
        }
        Origin::AllTeeth => return Some("the values in [errors] are on all teeth alike".to_owned()),
        Origin::Teeth if input.left_out.is_empty() => return None,
        Origin::Teeth => {
            let names: Vec<_> = input.left_out.iter().map(|kind| kind.name()).collect();
            return Some(format!(
                "the values in [errors] ({}) are on no teeth here, for the spec knows the other part's one by one: only the \
                 worst case counts them",
                names.join(", ")
            ));
        }
    };
    Some(format!("the spec has no deviations per tooth, so the values in [errors] are put on {on}"))
}

/// The report on the curve of a spec's mesh.
pub(super) fn solved<'a>(
    spec: &'a Spec,
    input: &'a MeshInput,
    curve: Curve,
    evaluation: Evaluation,
) -> Result<MeshReport<'a>, Failure> {
    Ok(MeshReport {
        title: None,
        mesh: &input.mesh,
        over_pin: match spec.computed_over_pin() {
            Some(computed) => Some(("measure M over the pin", computed)),
            None => spec.nominal_over_pin().ok().map(|given| ("measure M over the pin, as given", given)),
        },
        curve,
        listed: Vec::new(),
        prediction: prediction(input)?,
        limit: spec.limit_on(LimitTarget::CenterDistance),
        notes: [notes(input), spec.circles_in_words(&[])]
            .concat()
            .into_iter()
            .chain(evaluation.note_of_unsolved())
            .collect(),
        yoke: None,
        measured: None,
        evaluation,
        screen: Screen::default(),
    })
}

/// Remarks on the input, and on why mesh and formulas differ.
pub(super) fn notes(input: &MeshInput) -> Vec<String> {
    let mut notes: Vec<String> = placement(input).into_iter().collect();
    let ratio = input.mesh.pair().contact_ratio().total;
    let several_pitches = input.rack_deviations.iter().any(|deviation| {
        matches!(deviation.kind, RackDeviationKind::Pitch(_))
            && (deviation.teeth.first() != deviation.teeth.last() || deviation.teeth.first().is_none())
    });
    if several_pitches || input.rack_rows.len() > 1 {
        notes.push(format!(
            "the formula counts one pitch error; where several successive pitches are off, those within the contact \
             zone (contact ratio {ratio:.2}) add up"
        ));
    }
    let lead = input.rack_deviations.iter().any(|deviation| matches!(deviation.kind, RackDeviationKind::Lead(_)));
    if lead {
        notes.push(
            "with a lead error flanks touch at points on their end faces or edges; the formula takes the ends of the \
             rack's face width, the mesh those points that both parts have"
                .to_owned(),
        );
    }
    if matches!(input.mesh.support(), Support::FreeRoll { .. }) {
        notes.push(
            "the rack rolls about its own axis to where the centre distance is smallest; the formulas hold it"
                .to_owned(),
        );
    }
    notes.extend(input.warnings.iter().map(ToString::to_string));
    notes.extend(unmeasured(input));
    notes.extend(doubted_rows(input));
    notes
}

/// A remark on the first space or tooth that a measured table leaves out.
pub(super) fn unmeasured(input: &MeshInput) -> Option<String> {
    let tooth = input.unmeasured_tooth.map(|tooth| format!("tooth {tooth} of the pinion"));
    let place = tooth.or_else(|| input.unmeasured_space.map(|(space, _)| format!("space {space} of the rack")))?;
    Some(format!("{place} was not measured, or not everything of it: what was not measured is taken as nominal"))
}

/// Remarks on measured rows whose deviations are suspicious.
fn doubted_rows(input: &MeshInput) -> Vec<String> {
    let usual = Reach::usual(Length::from_mm(input.mesh.pair().normal_module_mm()).ok());
    let note = |part: &str, values: Vec<DeviationValue>| {
        let (leads, lengths): (Vec<_>, Vec<_>) =
            values.into_iter().partition(|value| matches!(value, DeviationValue::Angle(_)));
        let of = |values: &[DeviationValue], is_lead| {
            let count = values.iter().filter(|value| usual.is_reached_by(**value)).count() as u64;
            (count > 0).then(|| format!("the {part}'s table: {}", DoubtedColumn { usual, is_lead, count }))
        };
        [of(&lengths, false), of(&leads, true)].into_iter().flatten()
    };
    let values = |values: RowValue| values.value;
    let rack = note("rack", input.rack_rows.iter().flat_map(RackSpaceRow::values).map(values).collect());
    let pinion = note("pinion", input.pinion_rows.iter().flat_map(PinionToothRow::values).map(values).collect());
    rack.chain(pinion).collect()
}

/// A remark where a pinion tooth carries alone in a space that is too wide, which the formulas do not cover.
fn sinks(input: &MeshInput, curve: &Curve, prediction: &Prediction) -> Option<String> {
    use crate::deviation::RackDeviationKind::{Lead, Pitch, Shift};
    let kind = |of: fn(&RackDeviationKind) -> bool| input.rack_deviations.iter().any(|deviation| of(&deviation.kind));
    let lowest = curve.points.iter().map(|point| point.delta_cd_mm).fold(f64::INFINITY, f64::min);
    let below = lowest < prediction.range_mm().0 - curve.tolerance_mm.max(1e-6);
    let ratio = input.mesh.pair().contact_ratio().total;
    (below && ratio < 2.0 && kind(|kind| matches!(kind, Pitch(_) | Shift(_))) && !kind(|kind| matches!(kind, Lead(_))))
        .then(|| {
            format!(
                "the exact mesh goes below the formulas: with a contact ratio of {ratio:.2} a pinion tooth sometimes carries \
                 alone, and in a space that is too wide it sinks"
            )
        })
}

/// A list longer than this is for programs, not for a table.
const MOST_LISTED: u64 = 1000;

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = self.set.read_spec(&self.spec, output)?;
        let trace = self.trace.read(&spec, &self.read, output)?;
        let ends = TraceArgs::ends(&self.range.stroke, &spec, trace.as_ref())?;
        let strokes = self.strokes(ends)?;
        let picture = self.plot.picture(&self.trace.inputs(files_read(&spec, &self.spec)))?;
        let (spec, input) = placed(spec, &self.spec, output)?;
        let judged = judged(&spec, &JudgeArgs::of_spec(), output)?;
        let status = Status::of(judged.verdict, &judged.limits);
        if let (Format::Csv, None, false, None) = (self.format, &picture, spec.has_yoke(), &trace) {
            // no output needs the whole curve
            let listed = match &strokes {
                Some(strokes) => list_csv(strokes, &Listed { mesh: &input.mesh, part: None }, output),
                None => self.curve_csv(ends, &input.mesh, output),
            };
            return closed_is(status, listed);
        }
        let (from, to) = match &trace {
            // a yoke is judged over the travel, however short the measured curve is
            Some(_) if spec.has_yoke() => {
                let travel = self.range.stroke.ends(&spec)?;
                (ends.0.min(travel.0), ends.1.max(travel.1))
            }
            _ => ends,
        };
        let curve = input.mesh.curve(from, to, self.range.tolerance.mm())?;
        let function = function::part(&spec, &input, &curve, self.range.stroke.travel(&spec)?, &judged)?;
        let status = status.max(function.as_ref().map_or(Status::Pass, |part| function::status(&part.checks)));
        let mut report = solved(&spec, &input, curve, judged)?;
        (report.title, report.screen) = (spec.title.as_deref(), output.screen());
        report.yoke = function.map(|part| YokeSection::Known(Box::new(part)));
        if let Some(trace) = trace {
            report.measured = Some(self.trace.part(trace, &spec, &input, ends, output)?);
        }
        report.notes.extend(sinks(&input, &report.curve, &report.prediction));
        report.notes.extend(spec.suspicions_in_words());
        if let (Some(strokes), Format::Table | Format::Markdown) = (&strokes, self.format) {
            if strokes.count > MOST_LISTED {
                let count = strokes.count;
                report.notes.push(format!("--format csv lists the {count} strokes; a table lists {MOST_LISTED}"));
            } else {
                report.listed = listed_in_table(strokes, &input.mesh, output);
            }
        }
        let chart = self.chart(&report)?;
        draw(picture, || chart.clone().unwrap_or_else(|| report.chart()), true, output)?;
        let listed = match (&strokes, self.format) {
            (Some(strokes), Format::Csv) => list_csv(strokes, &Listed::of(&report), output),
            (Some(strokes), Format::Json) => {
                let (before, after) = (report.json_around(Trust::default()).0, |trust| report.json_around(trust).1);
                list(strokes, &Listed::of(&report), output, (&before, mesh_points::json_elements, after))
            }
            _ => output.report(&report, self.format).map(|()| None),
        };
        closed_is(status, listed)
    }

    /// The picture of a quantity of the yoke; `None` for ΔCD.
    fn chart(&self, report: &MeshReport<'_>) -> Result<Option<Chart>, Diagnostic> {
        let points = &report.curve.points;
        let part = report.function();
        let (chart, needs) = match self.plot_of {
            PlotOf::DeltaCd => return Ok(None),
            PlotOf::Play => (part.map(|part| part.play_chart(report.title, points)), "play: it needs [yoke]"),
            PlotOf::Torque => {
                let chart = part.and_then(|part| part.torque_chart(report.title, points));
                (chart, "torque: it needs `preload` below [yoke], and the rates of the mesh at every stroke")
            }
        };
        let missing = || Diagnostic::usage(format!("--plot-of {needs}")).help("see `rackmesh explain yoke`");
        chart.map_or_else(|| Err(missing()), |chart| Ok(Some(chart)))
    }

    /// Writes the points of the curve as they are found; returns the status of an interruption, if one came.
    fn curve_csv(&self, ends: (f64, f64), mesh: &Mesh, output: &mut Output) -> Result<Option<Status>, Failure> {
        let interruption = signals::interrupted(output);
        let mut before = mesh_points::csv_header(false);
        let ((from, to), mut bar) = (ends, Bar::new(output));
        let written = mesh.curve_pieces(from, to, self.range.tolerance.mm(), |piece| {
            for points in piece.points.chunks(1 << 10) {
                let points: Vec<ListedPoint> = points.iter().map(|point| (point.stroke_mm, Ok(*point))).collect();
                output.piece(&(std::mem::take(&mut before) + &mesh_points::csv_lines(&points, None)))?;
            }
            let end = piece.points.last().map_or(from, |point| point.stroke_mm);
            let is_last = end >= to;
            bar.show(Some((end - from) / (to - from)), || format!("stroke {end:.1} mm"));
            let is_stopped = !is_last && interruption.came();
            if is_stopped { Err(Ended::Early) } else { Ok(()) }
        });
        bar.finish();
        match written {
            Err(Ended::Failed(failure)) => Err(failure),
            Err(Ended::Early) => Ok(interruption.status()),
            Ok(()) => Ok(None),
        }
    }

    /// The strokes asked for; `None` for those that the curve needs.
    fn strokes(&self, (from, to): (f64, f64)) -> Result<Option<Strokes>, Failure> {
        const MOST: f64 = 1e8;
        let (step, intervals) = match (&self.step, self.points) {
            (None, None) => return Ok(None),
            (_, Some(points)) => ((to - from) / f64::from(points - 1), f64::from(points - 1)),
            (Some(step), None) => {
                let intervals = (to - from) / step.mm();
                if !(step.mm() > 0.0 && (0.0..=MOST).contains(&intervals)) {
                    let message =
                        format!("--step {step} does not divide the stroke from {from} to {to} mm into 1 to 1e8 steps");
                    return Err(Diagnostic::usage(message).into());
                }
                (step.mm(), intervals)
            }
        };
        let whole = (intervals * (1.0 + 1e-12)).floor() as u32;
        // with a step, the last stroke is `to` itself even if the step does not divide the range
        let divides = (to - (from + f64::from(whole) * step)).abs() <= 1e-9 * step.abs();
        Ok(Some(Strokes { from, to, step, count: u64::from(whole) + if divides { 1 } else { 2 } }))
    }
}

/// Why a list of points was not written to its end.
enum Ended {
    /// A signal came.
    Early,
    Failed(Failure),
}

impl<E: Into<Failure>> From<E> for Ended {
    fn from(error: E) -> Self {
        Self::Failed(error.into())
    }
}

/// The status of a list of points: the verdict is that of the curve, also if the reader stops early.
fn closed_is(verdict: Status, listed: Result<Option<Status>, Failure>) -> Result<Status, Failure> {
    match listed {
        Err(failure) if failure.is_closed_pipe() => Ok(verdict),
        listed => Ok(listed?.unwrap_or(verdict)),
    }
}
