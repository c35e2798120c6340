//! Curves of ΔCD over the stroke, with what they are held against.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Axis;
use super::canvas::{Drawing, FAMILY, Failure, Frame, INK, PlotError, SERIES, legend};

/// A curve with what it is held against.
#[derive(Debug, Clone)]
pub struct CurvePlot {
    /// Above the picture.
    pub title: String,
    /// What the curves show, with its unit; `ΔCD [mm]` by default.
    pub y_label: &'static str,
    /// The curves; marks are drawn on the first.
    pub curves: Vec<Series>,
    /// What the formulas predict, from lowest to highest, mm.
    pub band: Option<(f64, f64)>,
    /// Limits of ΔCD, mm.
    pub limits: Vec<f64>,
    /// Where contact changes teeth.
    pub marks: Vec<Mark>,
}

/// One curve.
#[derive(Debug, Clone, Default)]
pub struct Series {
    /// What it is, for the legend.
    pub label: String,
    /// Stroke and what the plot shows over it, in the order of the stroke.
    pub points: Vec<(f64, f64)>,
}

/// A marked point of the curve.
#[derive(Debug, Clone)]
pub struct Mark {
    /// Stroke, mm.
    pub stroke_mm: f64,
    /// ΔCD, mm.
    pub delta_cd_mm: f64,
    /// A few characters.
    pub label: String,
}

const BAND: RGBColor = RGBColor(222, 146, 32);
const LIMIT: RGBColor = RGBColor(190, 40, 40);

impl Default for CurvePlot {
    fn default() -> Self {
        Self {
            title: String::new(),
            y_label: "ΔCD [mm]",
            curves: Vec::new(),
            band: None,
            limits: Vec::new(),
            marks: Vec::new(),
        }
    }
}

impl CurvePlot {
    /// The picture as SVG.
    ///
    /// # Errors
    /// [`PlotError`] if there is no curve.
    pub fn svg(&self) -> Result<String, PlotError> {
        self.to_svg()
    }

    /// The picture as PNG.
    ///
    /// # Errors
    /// [`PlotError`] if there is no curve.
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        self.to_png()
    }

    /// The lowest and highest stroke and ΔCD shown, with some air around the curve.
    fn ranges(&self) -> Result<[(f64, f64); 2], PlotError> {
        let span = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
        };
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let x = span(&mut points().map(|point| point.0));
        let band = self.band.into_iter().flat_map(|(low, high)| [low, high]);
        let y = span(&mut points().map(|point| point.1).chain(band).chain(self.limits.iter().copied()));
        if x.1.partial_cmp(&x.0) != Some(std::cmp::Ordering::Greater) {
            return Err(PlotError::TooFewPoints);
        }
        // a level curve is shown in a window of 2 µm
        let air = ((y.1 - y.0) * 0.08).max(0.001);
        Ok([x, (y.0 - air, y.1 + air)])
    }

    /// The corner where the legend hides least of the curves; of equals the first.
    fn legend_corner(&self, [x, y]: [(f64, f64); 2], labels: usize) -> SeriesLabelPosition {
        /// What the legend takes of the width, and a label of the height, with some room.
        const WIDTH: f64 = 0.16;
        const HEIGHT: f64 = 0.06;
        // no plot has many labels
        let (width, height) = (WIDTH * (x.1 - x.0), HEIGHT * (labels as f64 + 0.5) * (y.1 - y.0));
        let (left, right) = ((x.0, x.0 + width), (x.1 - width, x.1));
        let (lower, upper) = ((y.0, y.0 + height), (y.1 - height, y.1));
        // the length along the stroke for which a segment is behind the legend, drawn as high as it goes there
        let hidden = |two: &[(f64, f64)], across: (f64, f64), up: (f64, f64)| {
            let [(a, b), (c, d)] = [two[0], two[1]];
            let (from, to) = (a.min(c).max(across.0), a.max(c).min(across.1));
            let at = |v: f64| if c == a { b } else { b + (d - b) * (v - a) / (c - a) };
            let (low, high) = (at(from).min(at(to)), at(from).max(at(to)));
            if to > from && high >= up.0 && low <= up.1 { to - from } else { 0.0 }
        };
        let corners = [
            (SeriesLabelPosition::UpperRight, right, upper),
            (SeriesLabelPosition::LowerRight, right, lower),
            (SeriesLabelPosition::UpperLeft, left, upper),
            (SeriesLabelPosition::LowerLeft, left, lower),
        ];
        let covered = corners.map(|(corner, across, up)| {
            let curves = self.curves.iter().flat_map(|curve| curve.points.windows(2));
            (corner, curves.map(|two| hidden(two, across, up)).sum::<f64>())
        });
        let least = covered.into_iter().reduce(|best, other| if other.1 < best.1 { other } else { best });
        least.map_or(SeriesLabelPosition::UpperRight, |(corner, _)| corner)
    }

    /// A dot at each mark, and its label where there is room for it.
    fn draw_marks<DB: DrawingBackend>(
        &self,
        chart: &mut ChartContext<'_, DB, Cartesian2d<Axis, Axis>>,
    ) -> Result<(), Failure> {
        const ROOM: i32 = 34;
        let style = (FAMILY, 14).into_font().color(&INK).pos(Pos::new(HPos::Center, VPos::Bottom));
        let mut last: Option<i32> = None;
        for mark in &self.marks {
            let point = (mark.stroke_mm, mark.delta_cd_mm);
            chart.draw_series([Circle::new(point, 3, SERIES[0].filled())])?;
            let (x, _) = chart.backend_coord(&point);
            if last.is_none_or(|last| x - last >= ROOM) {
                last = Some(x);
                let label = EmptyElement::at(point) + Text::new(mark.label.clone(), (0, -6), style.clone());
                chart.draw_series([label])?;
            }
        }
        Ok(())
    }
}

impl Drawing for CurvePlot {
    const SIZE: (u32, u32) = (1200, 560);

    fn draw_on<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Result<(), Failure> {
        let [x, y] = self.ranges().map_err(Failure::Plot)?;
        let frame = Frame { title: &self.title, labels: ("stroke [mm]", self.y_label), room: (52, 84), ticks: (12, 9) };
        let mut chart = frame.draw(area, Axis::new(x, 1), Axis::new(y, 4))?;
        if let Some((low, high)) = self.band {
            chart
                .draw_series([Rectangle::new([(x.0, low), (x.1, high)], BAND.mix(0.18).filled())])?
                .label("formulas")
                .legend(|(x, y)| Rectangle::new([(x, y - 6), (x + 22, y + 6)], BAND.mix(0.35).filled()));
            // a band without height is still to be seen
            for edge in [low, high] {
                chart.draw_series(LineSeries::new([(x.0, edge), (x.1, edge)], BAND.mix(0.7)))?;
            }
        }
        for (index, limit) in self.limits.iter().enumerate() {
            let line = LineSeries::new([(x.0, *limit), (x.1, *limit)], LIMIT.stroke_width(2));
            let drawn = chart.draw_series(line)?;
            if index == 0 {
                drawn.label("limits").legend(|(x, y)| PathElement::new([(x, y), (x + 22, y)], LIMIT.stroke_width(2)));
            }
        }
        for (curve, color) in self.curves.iter().zip(SERIES.iter().cycle()) {
            let style = color.stroke_width(2);
            chart
                .draw_series(LineSeries::new(curve.points.iter().copied(), style))?
                .label(&curve.label)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 22, y)], style));
        }
        self.draw_marks(&mut chart)?;
        let labels = self.curves.len() + usize::from(self.band.is_some()) + usize::from(!self.limits.is_empty());
        legend(chart, area, self.legend_corner([x, y], labels))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot() -> CurvePlot {
        CurvePlot {
            title: "lot 7: α_n = 20°".to_owned(),
            curves: vec![Series {
                label: "exact mesh".to_owned(),
                points: vec![(0.0, 0.0), (10.0, 0.0), (10.5, 0.027), (50.0, 0.027)],
            }],
            band: Some((0.0, 0.0275)),
            limits: vec![-0.03, 0.03],
            y_label: "ΔCD [mm]",
            marks: vec![Mark { stroke_mm: 10.5, delta_cd_mm: 0.027, label: "r4".to_owned() }],
        }
    }

    #[test]
    fn the_legend_stands_where_no_curve_is() {
        let corner = |points: Vec<(f64, f64)>| {
            let plot = CurvePlot { curves: vec![Series { label: String::new(), points }], ..CurvePlot::default() };
            plot.legend_corner(plot.ranges().unwrap(), 2)
        };
        let name = |position: SeriesLabelPosition| match position {
            SeriesLabelPosition::UpperRight => "upper right",
            SeriesLabelPosition::LowerRight => "lower right",
            SeriesLabelPosition::UpperLeft => "upper left",
            _ => "another",
        };
        assert_eq!(name(corner(vec![(0.0, 0.0), (50.0, 0.0)])), "upper right");
        assert_eq!(name(corner(vec![(0.0, 0.0), (20.0, 0.0), (25.0, 0.1), (50.0, 0.1)])), "lower right");
        assert_eq!(name(corner(vec![(0.0, 0.0), (44.0, 0.0), (50.0, 1.0)])), "upper left");
    }

    #[test]
    fn svg_and_png_hold_the_picture() {
        let svg = plot().svg().unwrap();
        for part in ["lot 7: α_n = 20°", "stroke [mm]", "ΔCD [mm]", "formulas", "limits", "exact mesh", "r4"] {
            assert!(svg.contains(part), "{part}");
        }
        let png = plot().png().unwrap();
        assert!(png.starts_with(b"\x89PNG"));
    }

    #[test]
    fn no_curve_is_an_error_and_a_level_one_is_none() {
        assert!(matches!(CurvePlot::default().svg(), Err(PlotError::TooFewPoints)));
        let plot = |points| CurvePlot { curves: vec![Series { points, ..Series::default() }], ..CurvePlot::default() };
        assert!(plot(vec![(0.0, 0.0), (1.0, 0.0)]).svg().is_ok());
        assert!(plot(vec![(1.0, 0.0), (1.0, 0.0)]).png().is_err());
    }
}
