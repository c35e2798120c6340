//! Points on two logarithmic axes: error against run time, with the settings that no other beats.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::axis::LogAxis;
use super::canvas::{Drawing, Failure, Frame, GRID, INK, PlotError, SERIES, legend};

/// A plot of y against x, both logarithmic.
#[derive(Debug, Clone, Default)]
pub struct LogPlot {
    /// Above the picture.
    pub title: String,
    /// Below it, with unit.
    pub x_label: String,
    /// At its left, with unit.
    pub y_label: String,
    /// The points; those that are not positive cannot be shown and are left out.
    pub series: Vec<LogSeries>,
}

/// Points that belong together, joined by a line in their order.
#[derive(Debug, Clone, Default)]
pub struct LogSeries {
    /// For the legend.
    pub label: String,
    /// x and y.
    pub points: Vec<(f64, f64)>,
}

impl LogPlot {
    /// The points that no other point beats in both x and y (the Pareto front), from left to right.
    #[must_use]
    pub fn front(&self) -> Vec<(f64, f64)> {
        let mut points: Vec<(f64, f64)> = self.series.iter().flat_map(|series| shown(&series.points)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut lowest = f64::INFINITY;
        points.retain(|point| {
            let better = point.1 < lowest;
            lowest = lowest.min(point.1);
            better
        });
        points
    }

    /// The picture as SVG.
    ///
    /// # Errors
    /// [`PlotError`] if there is nothing to show.
    pub fn svg(&self) -> Result<String, PlotError> {
        self.to_svg()
    }

    /// The picture as PNG.
    ///
    /// # Errors
    /// [`PlotError`] if there is nothing to show.
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        self.to_png()
    }
}

/// The points that a logarithmic axis can show.
fn shown(points: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> + '_ {
    points.iter().copied().filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite())
}

impl Drawing for LogPlot {
    const SIZE: (u32, u32) = (1200, 720);

    fn draw_on<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Result<(), Failure> {
        let span = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)))
        };
        let points = || self.series.iter().flat_map(|series| shown(&series.points));
        let (x, y) = (span(&mut points().map(|p| p.0)), span(&mut points().map(|p| p.1)));
        if x.0 > x.1 {
            return Err(Failure::Plot(PlotError::NothingPositive));
        }
        let frame =
            Frame { title: &self.title, labels: (&self.x_label, &self.y_label), room: (56, 96), ticks: (20, 20) };
        let mut chart = frame.draw(area, LogAxis::around(x), LogAxis::around(y))?;
        let front = self.front();
        chart
            .draw_series(LineSeries::new(steps(&front), GRID.stroke_width(6)))?
            .label("no setting is both faster and closer")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 22, y)], GRID.stroke_width(6)));
        for (index, (series, color)) in self.series.iter().zip(SERIES.iter().cycle()).enumerate() {
            // from the second round of colours on, the line is thinner
            let style = color.stroke_width(if index < SERIES.len() { 2 } else { 1 });
            let points: Vec<_> = shown(&series.points).collect();
            chart
                .draw_series(LineSeries::new(points.iter().copied(), style))?
                .label(&series.label)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 22, y)], style));
            chart.draw_series(points.iter().map(|point| Circle::new(*point, 4, color.filled())))?;
            let on_front = points.iter().filter(|point| front.contains(point));
            chart.draw_series(on_front.map(|point| Circle::new(*point, 9, INK.stroke_width(2))))?;
        }
        legend(chart, area, SeriesLabelPosition::LowerLeft)
    }
}

/// The front as a staircase: between two of its points the left one is the best there is.
fn steps(front: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut line = Vec::with_capacity(2 * front.len());
    for (index, point) in front.iter().enumerate() {
        line.push(*point);
        if let Some(next) = front.get(index + 1) {
            line.push((next.0, point.1));
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot() -> LogPlot {
        LogPlot {
            title: "error against run time".to_owned(),
            x_label: "run time [s]".to_owned(),
            y_label: "error [mm]".to_owned(),
            series: vec![
                LogSeries { label: "coarse".to_owned(), points: vec![(1e-6, 1e-2), (1e-5, 2e-2), (0.0, 1.0)] },
                LogSeries { label: "fine".to_owned(), points: vec![(1e-4, 1e-9), (1e-2, 1e-9), (1e-3, 1e-12)] },
            ],
        }
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        assert_eq!(plot().front(), [(1e-6, 1e-2), (1e-4, 1e-9), (1e-3, 1e-12)]);
    }

    #[test]
    fn svg_and_png_hold_the_picture() {
        let svg = plot().svg().unwrap();
        for part in ["error against run time", "run time [s]", "coarse", "fine", "1e-6"] {
            assert!(svg.contains(part), "{part}");
        }
        assert!(plot().png().unwrap().starts_with(b"\x89PNG"));
        assert!(matches!(LogPlot::default().svg(), Err(PlotError::NothingPositive)));
    }
}
