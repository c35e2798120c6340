//! One result of many designs as a picture, and as a sketch on a terminal: a line for one key, lines for a second with few
//! values, a map for two, and points where designs are no grid.

use super::chart::{Axis, Bar, Chart, Layer, Scale, Shape};
use super::number::plain;
use super::{Screen, sketch};
use crate::design::{self, Designs};

/// A result of every design, in their order.
pub struct SweptResult<'a> {
    /// The designs.
    pub designs: &'a Designs,
    /// The name of the result.
    pub name: &'a str,
    /// Its value; `None` of a design without one, and missing behind the last that was computed.
    pub values: &'a [Option<f64>],
}

/// The most lines that can be distinguished.
const MOST_LINES: usize = 8;

/// The name of an axis of numbers.
fn label(axis: &design::Axis) -> String {
    if axis.unit.is_empty() { axis.key.clone() } else { format!("{} [{}]", axis.key, axis.unit) }
}

impl SweptResult<'_> {
    /// The picture; `None` where no key has numbers, or more than two keys make a grid.
    #[must_use]
    pub fn chart(&self, title: &str) -> Option<Chart> {
        let axes = self.designs.axes();
        let (x, layers) = match axes {
            _ if !self.designs.is_grid() => self.points()?,
            [_] => (0, self.lines(0, None)),
            [_, _] => self.of_two()?,
            _ => return None,
        };
        let y = match layers.first().map(|layer| &layer.shape) {
            Some(Shape::Map(_)) => Axis { label: label(&axes[1 - x]), scale: Scale::Tight },
            _ => Axis { label: self.name.to_owned(), scale: Scale::Airy },
        };
        let x = axes.get(x).filter(|axis| axis.is_numeric())?;
        let x = Axis { label: label(x), scale: Scale::Tight };
        Some(Chart { title: title.to_owned(), x, y, layers, ..Chart::default() })
    }

    /// The number of a key at a design.
    fn number(&self, axis: usize, design: usize) -> f64 {
        self.designs.values(design)[axis].number.unwrap_or(f64::NAN)
    }

    /// A point for each design, over the first key with numbers.
    fn points(&self) -> Option<(usize, Vec<Layer>)> {
        let x = self.designs.axes().iter().position(design::Axis::is_numeric)?;
        let points =
            self.values.iter().enumerate().map(|(design, value)| (self.number(x, design), value.unwrap_or(f64::NAN)));
        Some((x, vec![Layer::new("", Shape::Dots(points.collect()))]))
    }

    /// Lines over the key with more values where the other has few, or a map.
    fn of_two(&self) -> Option<(usize, Vec<Layer>)> {
        let axes = self.designs.axes();
        let counts: Vec<_> = axes.iter().map(|axis| axis.count().unwrap_or(0)).collect();
        let first_is_x = axes[0].is_numeric() && (counts[0] >= counts[1] || !axes[1].is_numeric());
        let x = usize::from(!first_is_x);
        if counts[1 - x] <= MOST_LINES {
            return Some((x, (0..counts[1 - x]).flat_map(|other| self.lines(x, Some(other))).collect()));
        }
        let is_map = axes.iter().all(design::Axis::is_numeric);
        is_map.then(|| (0, vec![self.map([counts[0], counts[1]])]))
    }

    /// A line over a key, at the value of the other key with that index, in pieces between designs without a result.
    fn lines(&self, x: usize, other: Option<usize>) -> Vec<Layer> {
        let axes = self.designs.axes();
        let count = axes[x].count().unwrap_or(0);
        let design = |index: usize| match (other, x) {
            (None, _) => index,
            (Some(other), 0) => index * axes[1].count().unwrap_or(1) + other,
            (Some(other), _) => other * count + index,
        };
        let label = other.map_or_else(String::new, |other| {
            let axis = 1 - x;
            let value = &self.designs.values(if x == 0 { other } else { other * count })[axis];
            format!("{} = {}", axes[axis].key, value.text)
        });
        let point = |index: usize| {
            let value = self.values.get(design(index)).copied().flatten();
            (self.number(x, design(index)), value.unwrap_or(f64::NAN))
        };
        let mut points: Vec<_> = (0..count).map(point).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let pieces = points.split(|point| point.1.is_nan()).filter(|piece| !piece.is_empty());
        let shape = |piece: &[(f64, f64)]| {
            const MOST_MARKED: usize = 40;
            if count <= MOST_MARKED { Shape::Track(piece.to_vec()) } else { Shape::Line(piece.to_vec()) }
        };
        pieces
            .enumerate()
            .map(|(index, piece)| Layer::new(if index == 0 { &label } else { "" }, shape(piece)))
            .collect()
    }

    /// Every design of two keys as a rectangle.
    fn map(&self, [columns, rows]: [usize; 2]) -> Layer {
        /// The most texts for which there is room.
        const MOST_TEXTS: [usize; 2] = [9, 14];
        let known = || self.values.iter().flatten().copied();
        let (low, high) = (known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max));
        let edges = |axis: usize, count: usize, stride: usize| {
            let at: Vec<_> = (0..count).map(|index| self.number(axis, index * stride)).collect();
            let middle = |index: usize| 0.5 * (at[index - 1] + at[index]);
            let first = at[0] - (middle(1) - at[0]);
            let last = at[count - 1] + (at[count - 1] - middle(count - 1));
            std::iter::once(first).chain((1..count).map(middle)).chain([last]).collect::<Vec<_>>()
        };
        let (x, y) = (edges(0, columns, rows), edges(1, rows, 1));
        let has_texts = columns <= MOST_TEXTS[0] && rows <= MOST_TEXTS[1];
        let cells = self.values.iter().enumerate().filter_map(|(design, value)| {
            let (column, row, value) = (design / rows, design % rows, (*value)?);
            let text = if has_texts { format!("{value:.4}") } else { String::new() };
            let bar = Bar { left: x[column], right: x[column + 1], low: y[row], high: y[row + 1], text };
            Some((bar, if high > low { (value - low) / (high - low) } else { 0.5 }))
        });
        let label = format!("{}: {} (pale) to {}", self.name, plain(low), plain(high));
        Layer::new(&label, Shape::Map(cells.collect()))
    }

    /// The result over a single key, drawn in the terminal; `None` where nothing can be drawn.
    #[must_use]
    pub fn sketch(&self, screen: Screen) -> Option<String> {
        const HEIGHT: usize = 8;
        let [axis] = self.designs.axes() else { return None };
        let width = screen.drawing_width().filter(|_| axis.is_numeric())?;
        let values = self.values.iter().enumerate();
        let mut points: Vec<_> =
            values.filter_map(|(design, value)| Some((self.number(0, design), (*value)?))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let ends = [points.first()?.0, points.last()?.0].map(|end| axis.text(end));
        let drawn = sketch::labelled(&points, [width, HEIGHT], "", ends)?;
        Some(format!("\n{} over {}\n{drawn}\n", self.name, axis.key))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn designs(axes: &[&str]) -> Designs {
        Designs::grid(axes.iter().map(|axis| design::Axis::parse(axis, |_| false).unwrap()).collect()).unwrap()
    }

    fn chart(axes: &[&str], values: &[Option<f64>]) -> Option<Chart> {
        SweptResult { designs: &designs(axes), name: "range_upper_mm", values }.chart("a spec")
    }

    fn shapes(chart: &Chart) -> Vec<(&str, Vec<(f64, f64)>)> {
        chart
            .layers
            .iter()
            .map(|layer| match &layer.shape {
                Shape::Track(points) | Shape::Line(points) | Shape::Dots(points) => {
                    (layer.label.as_str(), points.clone())
                }
                Shape::Map(cells) => {
                    (layer.label.as_str(), cells.iter().map(|(bar, share)| (bar.left, *share)).collect())
                }
                _ => panic!("{layer:?}"),
            })
            .collect()
    }

    #[test]
    fn one_key_is_a_line_with_gaps_and_two_are_lines_or_a_map() {
        let gap = chart(&["k=1..4:1"], &[Some(0.1), None, Some(0.3), Some(0.2)]).unwrap();
        assert_eq!(shapes(&gap), [("", vec![(1.0, 0.1)]), ("", vec![(3.0, 0.3), (4.0, 0.2)])]);
        let values: Vec<_> = (0..6).map(|value| Some(f64::from(value))).collect();
        let lines =
            [("z = 6", vec![(1.0, 0.0), (2.0, 2.0), (3.0, 4.0)]), ("z = 7", vec![(1.0, 1.0), (2.0, 3.0), (3.0, 5.0)])];
        assert_eq!(shapes(&chart(&["k=1..3:1", "z=6,7"], &values).unwrap()), lines);
        let turned: Vec<_> = [0, 2, 4, 1, 3, 5].map(|index| values[index]).into();
        assert_eq!(shapes(&chart(&["z=6,7", "k=1..3:1"], &turned).unwrap()), lines);
        let values: Vec<_> = (0..81).map(|value| Some(f64::from(value))).collect();
        let map = chart(&["k=1..9:1", "l=1..9:1"], &values).unwrap();
        let [(label, cells)] = &shapes(&map)[..] else { panic!("{map:?}") };
        assert_eq!((*label, cells.len(), cells[80]), ("range_upper_mm: 0 (pale) to 80", 81, (8.5, 1.0)));
        assert_eq!(map.y.label, "l");
        assert!(map.svg().unwrap().contains("fill-opacity=\"0.650\""));
        assert!(
            chart(&["a=x,y"], &[Some(1.0), Some(2.0)]).is_none() && chart(&["a=1,2", "b=1,2", "c=1,2"], &[]).is_none()
        );
    }
}
