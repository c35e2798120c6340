//! Lists of strokes: solved on all cores, written in order as they are solved.

use crate::cli::bar::Bar;
use crate::cli::output::{Failure, Output, Status};
use crate::cli::signals;
use crate::diagnostic::{Code, Diagnostic};
use crate::mesh::{Mesh, MeshError};
use crate::report::function::at_listed;
use crate::report::mesh_points::{self, AtListed, ListedPoint, Trust};
use crate::report::{FunctionPart, MeshReport, grouped, noted};

/// The strokes of a table with their solutions.
pub(super) fn listed_in_table(strokes: &Strokes, mesh: &Mesh, output: &mut Output) -> Vec<ListedPoint> {
    let at: Vec<f64> = (0..strokes.count).map(|index| strokes.at(index)).collect();
    let listed: Vec<ListedPoint> = at.iter().copied().zip(mesh.sample(&at)).collect();
    if let Some(error) = Trust::of(&listed).failure {
        output.diagnostic(&unsolved_stroke(&error));
    }
    listed
}

/// Strokes a step apart, both ends included.
pub(super) struct Strokes {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) step: f64,
    pub(super) count: u64,
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

/// The mesh of a list of strokes, and the yoke if there is one.
pub(super) struct Listed<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) part: Option<&'a FunctionPart>,
}

impl<'a> Listed<'a> {
    pub(super) fn of(report: &'a MeshReport<'_>) -> Self {
        Self { mesh: report.mesh, part: report.function() }
    }
}

/// Text of solved strokes, with the figures of a yoke.
type PointsText = fn(&[ListedPoint], AtListed<'_>) -> String;

pub(super) fn list_csv(strokes: &Strokes, of: &Listed<'_>, output: &mut Output) -> Result<Option<Status>, Failure> {
    let header = mesh_points::csv_header(of.part.is_some());
    list(strokes, of, output, (&header, mesh_points::csv_lines, |_| String::new()))
}

fn remark_on(trust: Trust, output: &mut Output) {
    if let Some(error) = trust.failure {
        output.diagnostic(&unsolved_stroke(&error));
    }
    trust.notes().iter().for_each(|note| output.remark(&noted(note)));
}

/// Solves strokes on all cores and writes them in order as they are solved, until the last one or a signal; `before` and
/// `after` stand around them. The status is that of an interruption, if one came.
pub(super) fn list(
    strokes: &Strokes,
    of: &Listed<'_>,
    output: &mut Output,
    (before, text, after): (&str, PointsText, impl Fn(Trust) -> String),
) -> Result<Option<Status>, Failure> {
    // from the first byte on, a signal must leave complete JSON
    let interruption = signals::interrupted(output);
    output.piece(before)?;
    let (mut trust, mut bar) = (Trust::default(), Bar::new(output));
    let mut written = 0;
    let listed = |points: &[ListedPoint]| {
        let yoke = of.part.map(|part| at_listed(&part.function, of.mesh, points));
        text(points, yoke.as_deref())
    };
    let solved = of.mesh.sample_blocks(
        strokes.count,
        |index| strokes.at(index),
        |points| (listed(points), Trust::of(points), points.len() as u64),
        |(text, of_block, points)| {
            trust = trust.and(of_block);
            // a comma stands between elements
            output.piece(if written == 0 { text.trim_start_matches(',') } else { &text }).map_err(Some)?;
            written += points;
            let is_last = written == strokes.count;
            bar.show(Some(written as f64 / strokes.count as f64), || format!("{} strokes", grouped(written)));
            if !is_last && interruption.came() { Err(None) } else { Ok(()) }
        },
    );
    bar.finish();
    match solved {
        Err(Some(failure)) => return Err(failure),
        Err(None) => trust.interrupted = true,
        Ok(()) => {}
    }
    output.text(&after(trust))?;
    remark_on(trust, output);
    Ok(interruption.status().filter(|_| trust.interrupted))
}
