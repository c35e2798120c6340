//! `rackmesh mesh`: ΔCD along the stroke, by the exact zero-backlash mesh.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use super::decision::DecisionArgs;
use super::long::{self, Interruption};
use super::output::{Failure, Output, Status};
use super::picture::Picture;
use super::set::SetArgs;
use super::teeth::{Judged, with_known_teeth};
use crate::deviation::plausible::{DoubtedColumn, Reach};
use crate::deviation::{DeviationValue, PinionToothRow, RackDeviationKind};
use crate::diagnostic::{Code, Diagnostic};
use crate::judge::{LimitTarget, Prediction, Verdict};
use crate::mesh::{Curve, Mesh, MeshError, Support};
use crate::quantity::Length;
use crate::report::chart::{Chart, Layer, Mark, Shape, Span};
use crate::report::mesh_points::{self, ListedPoint, Trust};
use crate::report::{Format, MeshReport, noted};
use crate::spec::{Located, MeasuredTables, MeshInput, Origin, Spec, WrittenPinionDeviation, keys};
use crate::table::{self, Source, Teeth};

pub(super) const ABOUT: &str = "Solve the exact mesh of rigid teeth along the stroke, no forces";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh mesh examples/mesh.toml                      summary and a sketch of the curve
  rackmesh mesh examples/mesh.toml --plot curve.svg
  rackmesh mesh examples/mesh.toml --from 0 --to 50 --step 0.1 --format csv

Exit status: 0 inside limits.center_distance or none given, 1 outside, 2 could not solve,
130 or 143 if Ctrl-C or SIGTERM ended a list of strokes.")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: String,
    #[command(flatten)]
    range: Range,
    /// List strokes this far apart.
    #[arg(long, conflicts_with = "points", value_name = "LENGTH", allow_hyphen_values = true)]
    step: Option<Length>,
    /// List this many strokes, both ends included.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100_000_000))]
    points: Option<u32>,
    /// Draw the result to this file (.svg).
    #[arg(long, value_name = "FILE")]
    plot: Option<String>,
    #[command(flatten)]
    set: SetArgs,
    /// Output format.
    #[arg(long, short, value_enum, default_value_t)]
    format: Format,
}

/// The stroke.
#[derive(Debug, clap::Args)]
pub(super) struct Stroke {
    /// First stroke.
    #[arg(long, default_value = "0", allow_hyphen_values = true, value_name = "LENGTH")]
    pub(super) from: Length,
    /// Last stroke.
    #[arg(long, default_value = "50", allow_hyphen_values = true, value_name = "LENGTH")]
    pub(super) to: Length,
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

impl Range {
    pub(super) fn curve(&self, mesh: &Mesh) -> Result<Curve, Failure> {
        mesh.curve(self.stroke.from.mm(), self.stroke.to.mm(), self.tolerance.mm()).map_err(|error| unsolved(&error))
    }
}

/// Why there is no solution.
pub(super) fn unsolved(error: &MeshError) -> Failure {
    let diagnostic = Diagnostic::error(Code::NoMesh, error.to_string());
    match error {
        MeshError::NoContact { .. } => diagnostic
            .help("check the diameters, the addendum and the deviations: the teeth do not reach each other")
            .into(),
        MeshError::TipOnTip { .. } => diagnostic
            .help("check the tooth thicknesses and the deviations: the teeth are wider than the spaces")
            .into(),
        _ => diagnostic.into(),
    }
}

/// Where a table is that a spec names, relative to the spec's own folder.
fn table_path(spec_path: &str, name: &str) -> PathBuf {
    Path::new(spec_path).parent().unwrap_or(Path::new("")).join(name)
}

/// The files that are read for a spec: itself and the tables that it names.
pub(super) fn files_read(spec: &Spec, spec_path: &str) -> Vec<String> {
    let tables = [keys::RACK_MEASURED, keys::PINION_MEASURED].into_iter().filter_map(|key| spec.get(key));
    let paths = tables.map(|table| table_path(spec_path, &table).display().to_string());
    std::iter::once(spec_path.to_owned()).chain(paths).collect()
}

/// Reads the tables that a spec names.
pub(super) fn measured_tables(spec: &Spec, spec_path: &str) -> Result<MeasuredTables, Failure> {
    let read = |file: &Located<String>| -> Result<Teeth, Failure> {
        let path = table_path(spec_path, &file.value);
        let opened = std::fs::File::open(&path).map_err(|error| {
            Diagnostic::error(Code::FileAccess, format!("cannot read {}: {error}", path.display()))
                .at(&spec.source, file.span.clone(), "")
                .help("paths are relative to the spec")
        })?;
        Ok(table::of_one_part(&path.display().to_string(), Source::File(opened), &spec.want())?)
    };
    let wrong = |file: &Located<String>, what: &str| {
        let message = format!("{} holds no {what}", file.value);
        Failure::from(Diagnostic::error(Code::BadTable, message).at(&spec.source, file.span.clone(), ""))
    };
    let mut tables = MeasuredTables::default();
    if let Some(file) = &spec.values.located(keys::RACK_MEASURED) {
        match read(file)? {
            Teeth::Rack(rack) => tables.rack = Some(rack),
            Teeth::Pinion(_) => return Err(wrong(file, "spaces of a rack")),
        }
    }
    if let Some(file) = &spec.values.located(keys::PINION_MEASURED) {
        match read(file)? {
            Teeth::Pinion(pinion) => tables.pinion = Some(pinion),
            Teeth::Rack(_) => return Err(wrong(file, "teeth of a pinion")),
        }
    }
    Ok(tables)
}

/// What the formulas say about the deviations of a mesh.
pub(super) fn prediction(input: &MeshInput) -> Prediction {
    let pair = input.mesh.pair();
    let mut prediction = Prediction::new().rack(pair, &input.rack_deviations);
    for deviation in &input.pinion_deviations {
        prediction = match deviation {
            WrittenPinionDeviation::Teeth(deviation) => prediction.pinion(pair, &[*deviation]),
            WrittenPinionDeviation::Eccentricity(eccentricity) => prediction.eccentricity(eccentricity),
        };
    }
    if let Some(deviation_mm) = input.pinion_lead_mm {
        prediction = prediction.pinion_lead(pair, deviation_mm);
    }
    prediction.rack_rows(pair, &input.rack_rows).pinion_rows(pair, &input.pinion_rows)
}

/// Remarks on the input, and on why mesh and formulas differ.
pub(super) fn notes(input: &MeshInput) -> Vec<String> {
    let mut notes = Vec::new();
    if input.origin == Origin::Errors {
        let lead = if input.pinion_lead_mm.is_some() { ", its lead on all" } else { "" };
        notes.push(format!(
            "the spec has no deviations per tooth, so the values in [errors] are put on the teeth: over-roller and \
             radial on all, the rack's pitch and lead on teeth 4.., the pinion's pitch as one step half way round{lead}"
        ));
    }
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
    let unmeasured = input.unmeasured_tooth.map(|tooth| format!("tooth {tooth} of the pinion"));
    let unmeasured = unmeasured.or_else(|| input.unmeasured_space().map(|space| format!("space {space} of the rack")));
    notes.extend(unmeasured.map(|place| {
        format!("{place} was not measured, or not everything of it: what was not measured is taken as nominal")
    }));
    notes.extend(doubted_rows(input));
    notes
}

/// Remarks on measured rows whose deviations are suspicious.
fn doubted_rows(input: &MeshInput) -> Vec<String> {
    let usual = Reach::usual(Length::from_mm(input.mesh.pair().normal_module_mm()).ok());
    let note = |part: &str, values: Vec<f64>| {
        let values = values.into_iter().filter_map(|mm| Length::from_mm(mm).ok()).map(DeviationValue::Length);
        let count = usual.doubted(&values.collect::<Vec<_>>());
        (count > 0).then(|| format!("the {part}'s table: {}", DoubtedColumn { usual, is_lead: false, count }))
    };
    let of_pinion = |row: &PinionToothRow| [row.radial_mm, row.left_pitch_mm, row.right_pitch_mm];
    let rack = note("rack", input.rack_rows.iter().map(|row| row.height_mm).collect());
    let pinion = note("pinion", input.pinion_rows.iter().flat_map(of_pinion).flatten().collect());
    rack.into_iter().chain(pinion).collect()
}

/// A remark where a pinion tooth carries alone in a space that is too wide, which the formulas do not know.
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

const WORST_TEETH: &str = "the spec has no deviations per tooth, so the values in [errors] are put on the worst teeth that a \
                           search finds, as their extents allow; the verdict is that of the worst case";

/// A list longer than this is for programs, not for a table.
const MOST_LISTED: u64 = 1000;

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = with_known_teeth(self.set.read_spec(&self.spec, output)?, &self.spec)?;
        let strokes = self.strokes()?;
        let picture = self.plot.as_deref().map(|path| Picture::new(path, files_read(&spec, &self.spec))).transpose()?;
        let mut input = spec.mesh(&measured_tables(&spec, &self.spec)?)?;
        let limits = spec.limits();
        let limit = limits.iter().find(|(target, _)| *target == LimitTarget::CenterDistance).map(|(_, limit)| limit);
        if let (Some(strokes), Format::Csv, None, None) = (&strokes, self.format, &picture, limit) {
            // nothing is asked that needs the curve between these strokes
            return Ok(list_csv(strokes, &input.mesh, output)?.unwrap_or(Status::Pass));
        }
        let judged = Judged::new(&spec)?;
        let mut notes = notes(&input);
        if input.origin == Origin::Errors
            && let Some(mesh) = judged.worst_mesh(&spec, input.mesh.pair(), limit)?
        {
            input.mesh = mesh;
            WORST_TEETH.clone_into(&mut notes[0]);
        }
        let curve = self.range.curve(&input.mesh)?;
        let prediction = prediction(&input);
        notes.extend(sinks(&input, &curve, &prediction));
        notes.extend(spec.suspicions_in_words());
        let mut listed: Vec<ListedPoint> = Vec::new();
        if let (Some(strokes), Format::Table | Format::Markdown) = (&strokes, self.format) {
            match listed_in_table(strokes, &input.mesh, output) {
                Some(points) => listed = points,
                None => {
                    notes
                        .push(format!("--format csv lists the {} strokes; a table lists {MOST_LISTED}", strokes.count));
                }
            }
        }
        let report = MeshReport {
            title: spec.title.as_deref(),
            mesh: &input.mesh,
            over_pin: spec.nominal_over_pin().ok(),
            curve: &curve,
            listed: &listed,
            prediction: &prediction,
            limit,
            judged: judged.range,
            judged_by: judged.by,
            checks: &judged.checks,
            verdict: judged.verdict,
            rule: DecisionArgs::of_spec().rule(&spec),
            notes,
            screen: output.screen(),
        };
        if let Some(picture) = &picture {
            picture.write(&chart(&report))?;
        }
        let interrupted = match (&strokes, self.format) {
            (Some(strokes), Format::Csv) => list_csv(strokes, &input.mesh, output)?,
            (Some(strokes), Format::Json) => list_json(strokes, &report, output)?,
            _ => {
                output.report(&report, self.format)?;
                None
            }
        };
        Ok(interrupted.unwrap_or(status(&report)))
    }

    /// The strokes asked for; `None` for those that the curve needs.
    fn strokes(&self) -> Result<Option<Strokes>, Failure> {
        const MOST: f64 = 1e8;
        let (from, to) = (self.range.stroke.from.mm(), self.range.stroke.to.mm());
        if from > to {
            let message = format!("--from {from} lies beyond --to {to}");
            return Err(Diagnostic::error(Code::Usage, message).into());
        }
        let (step, intervals) = match (&self.step, self.points) {
            (None, None) => return Ok(None),
            (_, Some(points)) => ((to - from) / f64::from(points - 1), f64::from(points - 1)),
            (Some(step), None) => {
                let intervals = (to - from) / step.mm();
                if !(step.mm() > 0.0 && (0.0..=MOST).contains(&intervals)) {
                    let message =
                        format!("--step {step} does not divide the stroke from {from} to {to} mm into 1 to 1e8 steps");
                    return Err(Diagnostic::error(Code::Usage, message).into());
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

/// The strokes of a table with their solutions; `None` if they are too many for one.
fn listed_in_table(strokes: &Strokes, mesh: &Mesh, output: &mut Output) -> Option<Vec<ListedPoint>> {
    if strokes.count > MOST_LISTED {
        return None;
    }
    let at: Vec<f64> = (0..strokes.count).map(|index| strokes.at(index)).collect();
    let listed: Vec<ListedPoint> = at.iter().copied().zip(mesh.sample(&at)).collect();
    if let Some(error) = Trust::of(&listed).failure {
        output.diagnostic(&unsolved_stroke(&error));
    }
    Some(listed)
}

/// How a command ends that solved a mesh.
pub(super) fn status(report: &MeshReport<'_>) -> Status {
    match report.verdict {
        Some(Verdict::Fail) => Status::Fail,
        Some(Verdict::Indeterminate) => Status::Indeterminate,
        None if !report.checks.is_empty() => Status::Undecided,
        Some(Verdict::Pass) | None => Status::Pass,
    }
}

/// Strokes a step apart, both ends included.
struct Strokes {
    from: f64,
    to: f64,
    step: f64,
    count: u64,
}

impl Strokes {
    fn at(&self, index: u64) -> f64 {
        let place = self.from + index as f64 * self.step;
        if index + 1 == self.count { self.to } else { place }
    }
}

fn unsolved_stroke(error: &MeshError) -> Diagnostic {
    Diagnostic::warning(Code::NoMesh, error.to_string())
}

/// Writes CSV as it is solved; the status is that of an interruption, if one came.
fn list_csv(strokes: &Strokes, mesh: &Mesh, output: &mut Output) -> Result<Option<Status>, Failure> {
    let interruption = long::interrupted();
    output.text(&mesh_points::csv_header())?;
    let listed = list(strokes, mesh, &interruption, mesh_points::csv_lines, |text| output.text(text))?;
    remark_on(listed.trust, output);
    Ok(listed.interrupted)
}

/// Writes JSON as it is solved; the status is that of an interruption, if one came.
fn list_json(strokes: &Strokes, report: &MeshReport<'_>, output: &mut Output) -> Result<Option<Status>, Failure> {
    // from the first byte on a signal has to leave whole JSON
    let interruption = long::interrupted();
    output.text(&report.json_around(Trust::default()).0)?;
    let mut first = true;
    let listed = list(strokes, report.mesh, &interruption, mesh_points::json_elements, |text| {
        let text = if std::mem::take(&mut first) { text.trim_start_matches(',') } else { text };
        output.text(text)
    })?;
    output.text(&report.json_around(listed.trust).1)?;
    remark_on(listed.trust, output);
    Ok(listed.interrupted)
}

fn remark_on(trust: Trust, output: &mut Output) {
    if let Some(error) = trust.failure {
        output.diagnostic(&unsolved_stroke(&error));
    }
    trust.notes().iter().for_each(|note| output.remark(&noted(note)));
}

/// What came of a list of strokes.
struct Listed {
    trust: Trust,
    interrupted: Option<Status>,
}

/// Why a list ends before its last stroke.
enum EndedEarly {
    Unwritten(Failure),
    Interrupted,
}

/// Solves strokes on all cores and writes them in order, until the last one or a signal.
fn list(
    strokes: &Strokes,
    mesh: &Mesh,
    interruption: &Interruption,
    text: impl Fn(&[ListedPoint]) -> String + Sync,
    mut write: impl FnMut(&str) -> Result<(), Failure>,
) -> Result<Listed, Failure> {
    let mut trust = Trust::default();
    let mut written = 0;
    let solved = mesh.sample_blocks(
        strokes.count,
        |index| strokes.at(index),
        |points| (text(points), Trust::of(points), points.len() as u64),
        |(text, of_block, points)| {
            trust = trust.and(of_block);
            written += points;
            write(&text).map_err(EndedEarly::Unwritten)?;
            let is_last = written == strokes.count;
            if !is_last && interruption.stop().load(Ordering::Relaxed) { Err(EndedEarly::Interrupted) } else { Ok(()) }
        },
    );
    match solved {
        Ok(()) => Ok(Listed { trust, interrupted: None }),
        Err(EndedEarly::Unwritten(failure)) => Err(failure),
        Err(EndedEarly::Interrupted) => {
            Ok(Listed { trust: Trust { interrupted: true, ..trust }, interrupted: interruption.status() })
        }
    }
}

/// The picture of a curve, with what it is held against.
pub(super) fn chart(report: &MeshReport<'_>) -> Chart {
    let marks = report.curve.kinks.iter().filter_map(|kink| {
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
    let limits = report.limit.into_iter().flat_map(|limit| [limit.lower, limit.upper]);
    let points: Vec<_> = report.curve.points.iter().map(|point| (point.stroke_mm, point.delta_cd_mm)).collect();
    let (low, high) = report.prediction.range_mm();
    let ends = points.first().into_iter().chain(points.last());
    let layers = vec![
        Layer::new("formulas", Shape::Band(ends.map(|(x, _)| Span { x: *x, low, high }).collect())),
        Layer::new("limits", Shape::Limits(limits.flatten().map(Length::mm).collect())),
        Layer::new("exact mesh", Shape::Line(points)),
        Layer::new("contact moves to the right (r) or left (l) flank of a tooth", Shape::Marks(marks.collect())),
    ];
    Chart::along_the_stroke(report.title.unwrap_or("ΔCD along the stroke"), layers)
}
