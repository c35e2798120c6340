//! Solved strokes as rows of CSV, elements of a JSON array and lines of a table. Called block by block, on any
//! thread, so that a million strokes need no memory; never solves a stroke.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::number::{millimetres, plain, tidy};
use super::{Block, Table, function};
use crate::function::AtStroke;
use crate::mesh::{Carrier, Ending, LARGEST_ROLL_RAD, MeshError, MeshPoint};

/// A stroke with its solution, or why it has none.
pub type ListedPoint = (f64, Result<MeshPoint, MeshError>);

pub(super) const COLUMNS: &str =
    "stroke_mm delta_cd_mm center_distance_mm pinion_angle_deg right_tooth left_tooth right_contact left_contact";

/// How far a list of points can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Trust {
    /// Strokes that did not converge, those solved to [`SOLVED_MM`](crate::mesh::SOLVED_MM) apart.
    pub unconverged: usize,
    /// Of those, the ones of which only the rack's roll is in doubt.
    pub roll_not_found: usize,
    /// Largest |residual|, mm.
    pub largest_residual_mm: f64,
    /// Why the first stroke without a solution has none.
    pub failure: Option<MeshError>,
    /// Whether the list was interrupted before its last stroke.
    pub interrupted: bool,
}

impl Trust {
    /// That of two lists, the first of them first.
    #[must_use]
    pub fn and(self, next: Self) -> Self {
        Self {
            unconverged: self.unconverged + next.unconverged,
            roll_not_found: self.roll_not_found + next.roll_not_found,
            largest_residual_mm: self.largest_residual_mm.max(next.largest_residual_mm),
            failure: self.failure.or(next.failure),
            interrupted: self.interrupted || next.interrupted,
        }
    }

    /// That of some points.
    #[must_use]
    pub fn of<'a>(points: impl IntoIterator<Item = &'a ListedPoint>) -> Self {
        points.into_iter().fold(Self::default(), |trust, (_, point)| trust.and(Self::of_point(point.as_ref())))
    }

    /// Remarks on strokes that did not converge.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let strokes = |count: usize| if count == 1 { "1 stroke".to_owned() } else { format!("{count} strokes") };
        let apart = self.unconverged - self.roll_not_found;
        let mut notes = Vec::new();
        if self.interrupted {
            notes.push("interrupted: the strokes listed are the first of those asked for".to_owned());
        }
        if apart > 0 {
            notes.push(format!(
                "{} did not converge; the largest residual is {:.1e} mm",
                strokes(apart),
                self.largest_residual_mm
            ));
        }
        if self.roll_not_found > 0 {
            notes.push(format!(
                "at {} the rack's roll is not known to be the one with the smallest centre distance, which may be \
                 smaller than given; rolls up to {:.1}° are searched",
                strokes(self.roll_not_found),
                LARGEST_ROLL_RAD.to_degrees()
            ));
        }
        notes
    }

    pub(super) fn of_point(point: Result<&MeshPoint, &MeshError>) -> Self {
        match point {
            Ok(point) => Self {
                unconverged: usize::from(!point.converged() && !point.is_solved()),
                roll_not_found: usize::from(point.ending == Ending::RollNotFound),
                largest_residual_mm: point.residual_mm.abs(),
                ..Self::default()
            },
            Err(error) => Self { failure: Some(*error), ..Self::default() },
        }
    }
}

/// The yoke's figures at each of some strokes, if there is one.
pub type AtListed<'a> = Option<&'a [Option<AtStroke>]>;

/// The columns of a list of strokes.
pub(super) fn columns(has_yoke: bool) -> String {
    if has_yoke { format!("{COLUMNS} {}", function::COLUMNS) } else { COLUMNS.to_owned() }
}

/// The header line of the CSV.
#[must_use]
pub fn csv_header(has_yoke: bool) -> String {
    columns(has_yoke).split_whitespace().collect::<Vec<_>>().join(",") + "\n"
}

/// A line of CSV for each point; fields are empty where there is no solution.
#[must_use]
pub fn csv_lines(points: &[ListedPoint], yoke: AtListed<'_>) -> String {
    let mut text = String::with_capacity(96 * points.len());
    for (index, (stroke, point)) in points.iter().enumerate() {
        // writing to a String cannot fail
        let _ = match point {
            Ok(point) => {
                let [delta, center, angle] = numbers(point).map(plain);
                let (right, left) = (&point.right, &point.left);
                write!(
                    text,
                    "{},{delta},{center},{angle},{},{},{},{}",
                    plain(*stroke),
                    right.rack_tooth,
                    left.rack_tooth,
                    right.contact,
                    left.contact
                )
            }
            Err(_) => write!(text, "{},,,,,,,", plain(*stroke)),
        };
        for value in yoke.into_iter().flat_map(|yoke| function::values(yoke.get(index).and_then(Option::as_ref))) {
            text.push(',');
            text += &value.map(plain).unwrap_or_default();
        }
        text.push('\n');
    }
    text
}

/// ΔCD, centre distance and angle as they are printed.
fn numbers(point: &MeshPoint) -> [f64; 3] {
    [point.delta_cd_mm, point.center_distance_mm, point.pinion_angle_rad.to_degrees()].map(tidy)
}

/// A point, with the figures of a yoke if there is one.
pub(super) fn json_point(stroke: f64, point: Option<&MeshPoint>, yoke: Option<&AtStroke>) -> Value {
    let Some(point) = point else { return json!({ "stroke_mm": stroke, "delta_cd_mm": null }) };
    let [delta, center, angle] = numbers(point);
    let mut json = json!({
        "stroke_mm": stroke,
        "delta_cd_mm": delta,
        "center_distance_mm": center,
        "pinion_angle_deg": angle,
        "right_tooth": point.right.rack_tooth,
        "left_tooth": point.left.rack_tooth,
        "right_contact": point.right.contact.name(),
        "left_contact": point.left.contact.name(),
    });
    if yoke.is_some() {
        function::add_values(yoke, &mut json);
    }
    json
}

/// The points as elements of the array in [`MeshReport::json_around`](super::MeshReport::json_around), a comma before
/// each.
#[must_use]
pub fn json_elements(points: &[ListedPoint], yoke: AtListed<'_>) -> String {
    let mut text = String::new();
    for (index, (stroke, point)) in points.iter().enumerate() {
        let at = yoke.and_then(|yoke| yoke.get(index)?.as_ref());
        let element = format!("{:#}", json_point(*stroke, point.as_ref().ok(), at));
        text.push_str(",\n    ");
        text.push_str(&element.replace('\n', "\n    "));
    }
    text
}

/// The points as a table for people; `None` without one.
pub(super) fn table(points: &[ListedPoint]) -> Option<Block> {
    let cell =
        |point: &ListedPoint, text: fn(&MeshPoint) -> String| point.1.as_ref().map_or_else(|_| "–".to_owned(), text);
    let degrees = |point: &MeshPoint| format!("{:.4}", point.pinion_angle_rad.to_degrees());
    let flank = |of: fn(&MeshPoint) -> Carrier| {
        move |(_, point): &&ListedPoint| match point {
            Ok(point) => format!("{}, {}", of(point).rack_tooth, of(point).contact),
            Err(_) => "–".to_owned(),
        }
    };
    Table::of(points)
        .number("stroke\n[mm]", |(stroke, _)| plain(tidy(*stroke)))
        .number("ΔCD\n[mm]", |point| cell(point, |point| millimetres(tidy(point.delta_cd_mm))))
        .number("centre distance\n[mm]", |point| cell(point, |point| format!("{:.4}", point.center_distance_mm)))
        .number("pinion angle\n[°]", |point| cell(point, degrees))
        .text("right flank\nof rack tooth", flank(|point| point.right))
        .text("left flank\nof rack tooth", flank(|point| point.left))
        .block_if_any()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What did not converge is told apart from what is only not known to be the lowest.
    #[test]
    fn notes_say_what_is_in_doubt() {
        let notes = |unconverged, roll_not_found| {
            let trust = Trust { unconverged, roll_not_found, largest_residual_mm: 2.5e-7, ..Trust::default() };
            trust.and(Trust::default()).notes().join("\n")
        };
        let apart = "1 stroke did not converge; the largest residual is 2.5e-7 mm";
        let rolled = "at 3 strokes the rack's roll is not known to be the one with the smallest centre distance, which \
                      may be smaller than given; rolls up to 4.3° are searched";
        assert_eq!(notes(0, 0), "");
        assert_eq!(notes(1, 0), apart);
        assert_eq!(notes(3, 3), rolled);
        assert_eq!(notes(4, 3), format!("{apart}\n{rolled}"));
    }

    #[test]
    fn an_ending_is_counted_once() {
        let pair = crate::reproduction::pair().expect("the paper's pair");
        let mesh = crate::mesh::Mesh::nominal(pair).expect("teeth in order");
        let mut point = mesh.at(0.0).expect("contact");
        for (ending, unconverged, roll_not_found) in [
            (Ending::Converged, 0, 0),
            (Ending::BracketExhausted, 1, 0),
            (Ending::Unbalanced, 1, 0),
            (Ending::IterationLimit, 1, 0),
            (Ending::RollNotFound, 1, 1),
        ] {
            (point.ending, point.residual_mm) = (ending, 2e-9);
            let trust = Trust::of(&[(0.0, Ok(point))]).and(Trust::of(&[(0.0, Ok(point))]));
            assert_eq!((trust.unconverged, trust.roll_not_found), (2 * unconverged, 2 * roll_not_found));
        }
        (point.ending, point.residual_mm) = (Ending::BracketExhausted, 9e-10);
        assert_eq!(Trust::of(&[(0.0, Ok(point))]).unconverged, 0);
    }
}
