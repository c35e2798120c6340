//! `rackmesh mesh`: ΔCD along the stroke, by the exact zero-backlash mesh.

use std::path::{Path, PathBuf};

use super::output::{Failure, Output, Status};
use crate::cmm;
use crate::decision::{LimitTarget, Prediction, Verdict};
use crate::deviation::RackDeviationKind;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::mesh::{Curve, Mesh, MeshError, Support};
use crate::quantity::Length;
use crate::report::mesh_points::{self, ListedPoint, Trust};
use crate::report::plot::{CurvePlot, Mark, PlotError, Series};
use crate::report::{Format, MeshReport};
use crate::spec::{MeasuredTables, MeshInput, Origin, Spec, WrittenPinionDeviation};

pub(super) const ABOUT: &str = "Solve the exact zero-backlash mesh along the stroke, with every tooth's own deviations";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  rackmesh mesh examples/mesh.toml                      summary and a sketch of the curve
  rackmesh mesh examples/mesh.toml --plot curve.svg
  rackmesh mesh examples/mesh.toml --from 0 --to 50 --step 0.1 --format csv

Exit status: 0 inside limits.center_distance or none given, 1 outside, 2 could not solve.")]
pub(super) struct Args {
    /// The gear spec (TOML); `-` reads standard input.
    spec: String,
    #[command(flatten)]
    range: Range,
    /// List strokes this far apart, both ends included, instead of where the curve needs them.
    #[arg(long, conflicts_with = "points", value_name = "LENGTH")]
    step: Option<Length>,
    /// List this many strokes, both ends included.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100_000_000))]
    points: Option<u32>,
    /// Write the curve as a picture; the name ends in .svg or .png.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Output format.
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// The stroke, and how closely it is followed.
#[derive(Debug, clap::Args)]
pub(super) struct Range {
    /// First stroke.
    #[arg(long, default_value = "0", allow_hyphen_values = true, value_name = "LENGTH")]
    pub(super) from: Length,
    /// Last stroke.
    #[arg(long, default_value = "50", allow_hyphen_values = true, value_name = "LENGTH")]
    pub(super) to: Length,
    /// The promised error of the curve between its points.
    #[arg(long, default_value = "1e-6", value_name = "LENGTH")]
    pub(super) tolerance: Length,
}

impl Range {
    pub(super) fn curve(&self, mesh: &Mesh) -> Result<Curve, Failure> {
        mesh.curve(self.from.mm(), self.to.mm(), self.tolerance.mm()).map_err(|error| unsolved(&error))
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

/// Reads the tables that a spec names, relative to the spec's own folder.
pub(super) fn measured_tables(spec: &Spec, spec_path: &str) -> Result<MeasuredTables, Failure> {
    let folder = Path::new(spec_path).parent().unwrap_or(Path::new(""));
    let read = |file: &crate::spec::Located<String>| -> Result<(String, String), Failure> {
        let path = folder.join(&file.value);
        let name = path.display().to_string();
        match std::fs::read(&path) {
            Ok(bytes) => match String::from_utf8(bytes) {
                Ok(text) => Ok((name, text)),
                Err(_) => Err(Diagnostic::error(Code::FileAccess, format!("{name} is not text in UTF-8"))
                    .at(&spec.source, file.span.clone(), "")
                    .into()),
            },
            Err(error) => Err(Diagnostic::error(Code::FileAccess, format!("cannot read {name}: {error}"))
                .at(&spec.source, file.span.clone(), "")
                .help("paths are relative to the spec")
                .into()),
        }
    };
    let mut tables = MeasuredTables::default();
    if let Some(file) = &spec.rack.measured {
        let (name, text) = read(file)?;
        tables.rack = Some(cmm::rack_spaces(&name, &text).map_err(Diagnostics::from)?);
    }
    if let Some(file) = &spec.pinion.measured {
        let (name, text) = read(file)?;
        tables.pinion = Some(cmm::pinion_teeth(&name, &text).map_err(Diagnostics::from)?);
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
    prediction.rack_rows(pair, &input.rack_rows).pinion_rows(pair, &input.pinion_rows)
}

/// Remarks on the input, and on why mesh and formulas differ.
pub(super) fn notes(input: &MeshInput) -> Vec<String> {
    let mut notes = Vec::new();
    if input.origin == Origin::Errors {
        notes.push(
            "the spec has no deviations per tooth, so the values in [errors] are put on the teeth: over-roller and \
             radial on all, the rack's pitch and lead on teeth 4.., the pinion's pitch as one step half way round"
                .to_owned(),
        );
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
    notes
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

/// A list longer than this is for programs, not for a table.
const MOST_LISTED: u64 = 1000;

impl Args {
    pub(super) fn run(self, output: &mut Output) -> Result<Status, Failure> {
        let spec = super::read_spec(&self.spec)?;
        let strokes = self.strokes()?;
        let input = spec.mesh(&measured_tables(&spec, &self.spec)?)?;
        let limits = spec.limits();
        let limit = limits.iter().find(|(target, _)| *target == LimitTarget::CenterDistance).map(|(_, limit)| limit);
        if let (Some(strokes), Format::Csv, None, None) = (&strokes, self.format, &self.plot, limit) {
            // nothing is asked that needs the curve between these strokes
            list_csv(strokes, &input.mesh, output)?;
            return Ok(Status::Pass);
        }
        let curve = self.range.curve(&input.mesh)?;
        let prediction = prediction(&input);
        let mut notes = notes(&input);
        notes.extend(sinks(&input, &curve, &prediction));
        let mut listed: Vec<ListedPoint> = Vec::new();
        if let (Some(strokes), Format::Table | Format::Markdown) = (&strokes, self.format) {
            if strokes.count <= MOST_LISTED {
                let at: Vec<f64> = (0..strokes.count).map(|index| strokes.at(index)).collect();
                listed = at.iter().copied().zip(input.mesh.sample(&at)).collect();
                if let Some(error) = Trust::of(&listed).failure {
                    output.diagnostic(&unsolved_stroke(&error));
                }
            } else {
                notes.push(format!("--format csv lists the {} strokes; a table lists {MOST_LISTED}", strokes.count));
            }
        }
        let report = MeshReport {
            title: spec.title.as_deref(),
            mesh: &input.mesh,
            curve: &curve,
            listed: &listed,
            prediction: &prediction,
            limit,
            notes,
            screen: output.screen(),
        };
        if let Some(path) = &self.plot {
            let plot = plot(&report);
            write_picture(path, || plot.svg(), || plot.png())?;
        }
        match (&strokes, self.format) {
            (Some(strokes), Format::Csv) => list_csv(strokes, &input.mesh, output)?,
            (Some(strokes), Format::Json) => list_json(strokes, &report, output)?,
            _ => output.report(&report, self.format)?,
        }
        Ok(match report.verdict() {
            Some(Verdict::Fail) => Status::Fail,
            Some(Verdict::Indeterminate) => Status::Indeterminate,
            Some(Verdict::Pass) | None => Status::Pass,
        })
    }

    /// The strokes asked for; `None` for those that the curve needs.
    fn strokes(&self) -> Result<Option<Strokes>, Failure> {
        const MOST: f64 = 1e8;
        let (from, to) = (self.range.from.mm(), self.range.to.mm());
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
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bounded by MOST")]
        let whole = (intervals * (1.0 + 1e-12)).floor() as u32;
        // with a step, the last stroke is `to` itself even if the step does not divide the range
        let divides = (to - (from + f64::from(whole) * step)).abs() <= 1e-9 * step.abs();
        Ok(Some(Strokes { from, to, step, count: u64::from(whole) + if divides { 1 } else { 2 } }))
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
        #[expect(clippy::cast_precision_loss, reason = "at most 1e8 strokes")]
        let place = self.from + index as f64 * self.step;
        if index + 1 == self.count { self.to } else { place }
    }
}

fn unsolved_stroke(error: &MeshError) -> Diagnostic {
    Diagnostic::warning(Code::NoMesh, error.to_string())
}

/// Writes CSV as it is solved.
fn list_csv(strokes: &Strokes, mesh: &Mesh, output: &mut Output) -> Result<(), Failure> {
    output.text(&mesh_points::csv_header())?;
    let trust = list(strokes, mesh, mesh_points::csv_lines, |text| output.text(text))?;
    remark_on(trust, output);
    Ok(())
}

/// Writes JSON as it is solved.
fn list_json(strokes: &Strokes, report: &MeshReport<'_>, output: &mut Output) -> Result<(), Failure> {
    output.text(&report.json_around(Trust::default()).0)?;
    let mut first = true;
    let trust = list(strokes, report.mesh, mesh_points::json_elements, |text| {
        let text = if std::mem::take(&mut first) { text.trim_start_matches(',') } else { text };
        output.text(text)
    })?;
    output.text(&report.json_around(trust).1)?;
    remark_on(trust, output);
    Ok(())
}

fn remark_on(trust: Trust, output: &mut Output) {
    if let Some(error) = trust.failure {
        output.diagnostic(&unsolved_stroke(&error));
    }
    trust.notes().iter().for_each(|note| output.remark(note));
}

/// Solves strokes on all cores and writes them in order.
fn list(
    strokes: &Strokes,
    mesh: &Mesh,
    text: impl Fn(&[ListedPoint]) -> String + Sync,
    mut write: impl FnMut(&str) -> Result<(), Failure>,
) -> Result<Trust, Failure> {
    let mut trust = Trust::default();
    mesh.sample_blocks(
        strokes.count,
        |index| strokes.at(index),
        |points| (text(points), Trust::of(points)),
        |(text, of_block)| {
            trust = trust.and(of_block);
            write(&text)
        },
    )?;
    Ok(trust)
}

/// The picture of a curve.
fn plot(report: &MeshReport<'_>) -> CurvePlot {
    let marks = report.curve.kinks.iter().filter_map(|kink| {
        let (before, after) = (kink.before, kink.after);
        let label = match (before.0.rack_tooth != after.0.rack_tooth, before.1.rack_tooth != after.1.rack_tooth) {
            (true, true) => format!("r{} l{}", after.0.rack_tooth, after.1.rack_tooth),
            (true, false) => format!("r{}", after.0.rack_tooth),
            (false, true) => format!("l{}", after.1.rack_tooth),
            // the place on the flank changes, not the tooth
            (false, false) => return None,
        };
        Some(Mark { stroke_mm: kink.stroke_mm, delta_cd_mm: kink.delta_cd_mm, label })
    });
    let limits = report.limit.into_iter().flat_map(|limit| [limit.lower, limit.upper]);
    CurvePlot {
        title: report.title.unwrap_or("ΔCD along the stroke").to_owned(),
        curves: vec![Series {
            label: "exact mesh".to_owned(),
            points: report.curve.points.iter().map(|point| (point.stroke_mm, point.delta_cd_mm)).collect(),
        }],
        band: Some(report.prediction.range_mm()),
        limits: limits.flatten().map(Length::mm).collect(),
        marks: marks.collect(),
        ..CurvePlot::default()
    }
}

/// Writes a picture in the format that the file's name asks for.
pub(super) fn write_picture(
    path: &Path,
    svg: impl FnOnce() -> Result<String, PlotError>,
    png: impl FnOnce() -> Result<Vec<u8>, PlotError>,
) -> Result<(), Failure> {
    let failed = |problem: String| Diagnostic::error(Code::FileAccess, problem);
    let drawing = |error: PlotError| failed(format!("cannot draw {}: {error}", path.display()));
    let bytes = match path.extension().and_then(|extension| extension.to_str()) {
        Some("svg") => svg().map_err(drawing)?.into_bytes(),
        Some("png") => png().map_err(drawing)?,
        _ => {
            let message = format!("--plot {}: the name must end in .svg or .png", path.display());
            return Err(Diagnostic::error(Code::Usage, message).into());
        }
    };
    std::fs::write(path, bytes).map_err(|error| failed(format!("cannot write {}: {error}", path.display())))?;
    Ok(())
}
