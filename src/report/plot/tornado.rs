//! Horizontal bars around zero, widest first: which error moves ΔCD how far.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Axis;
use super::canvas::{Drawing, FAMILY, Failure, GRID, INK, PlotError, SERIES};

/// A tornado plot.
#[derive(Debug, Clone, Default)]
pub struct TornadoPlot {
    /// Above the picture.
    pub title: String,
    /// The bars, widest first.
    pub bars: Vec<Bar>,
    /// Limits of ΔCD, mm.
    pub limits: Vec<f64>,
}

/// One bar.
#[derive(Debug, Clone)]
pub struct Bar {
    /// At its left.
    pub label: String,
    /// Where it begins, mm.
    pub from_mm: f64,
    /// Where it ends, mm.
    pub to_mm: f64,
    /// Whether it is drawn paler.
    pub pale: bool,
}

impl TornadoPlot {
    /// The picture as SVG.
    ///
    /// # Errors
    /// [`PlotError`] if there is no bar.
    pub fn svg(&self) -> Result<String, PlotError> {
        self.to_svg()
    }

    /// The picture as PNG.
    ///
    /// # Errors
    /// [`PlotError`] if there is no bar.
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        self.to_png()
    }
}

impl Drawing for TornadoPlot {
    const SIZE: (u32, u32) = (1000, 420);

    fn draw_on<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Result<(), Failure> {
        let ends = || self.bars.iter().flat_map(|bar| [bar.from_mm, bar.to_mm]).chain(self.limits.iter().copied());
        let (low, high) = ends().fold((0.0_f64, 0.0_f64), |(low, high), end| (low.min(end), high.max(end)));
        if !(high > low && (high - low).is_finite()) {
            return Err(Failure::Plot(PlotError::TooFewPoints));
        }
        let air = 0.06 * (high - low);
        let count = self.bars.len() as f64;
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, (FAMILY, 24).into_font().color(&INK))
            .margin(16)
            .margin_left(170)
            .margin_right(28)
            .x_label_area_size(52)
            .build_cartesian_2d(Axis::new((low - air, high + air), 4), Axis::new((0.0, count), 0))?;
        chart
            .configure_mesh()
            .disable_y_mesh()
            .disable_y_axis()
            .x_desc("ΔCD [mm]")
            .x_labels(9)
            .axis_desc_style((FAMILY, 20).into_font().color(&INK))
            .label_style((FAMILY, 17).into_font().color(&INK))
            .bold_line_style(GRID)
            .light_line_style(WHITE)
            .axis_style(INK)
            .draw()?;
        let label = (FAMILY, 18).into_font().color(&INK).pos(Pos::new(HPos::Right, VPos::Center));
        let value = (FAMILY, 15).into_font().color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
        let mut top = count;
        for bar in &self.bars {
            let middle = top - 0.5;
            let color = SERIES[0].mix(if bar.pale { 0.4 } else { 1.0 });
            chart.draw_series([Rectangle::new(
                [(bar.from_mm, middle - 0.34), (bar.to_mm, middle + 0.34)],
                color.filled(),
            )])?;
            let (_, y) = chart.backend_coord(&(0.0, middle));
            let (x, _) = chart.backend_coord(&(bar.to_mm, middle));
            area.draw(&Text::new(bar.label.clone(), (158, y), label.clone()))?;
            area.draw(&Text::new(format!("{:.4}", bar.to_mm), (x + 6, y), value.clone()))?;
            top -= 1.0;
        }
        chart.draw_series(LineSeries::new([(0.0, 0.0), (0.0, count)], INK))?;
        for limit in &self.limits {
            chart.draw_series(LineSeries::new([(*limit, 0.0), (*limit, count)], SERIES[1].stroke_width(2)))?;
        }
        area.present()?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_and_labels_are_drawn() {
        let bar = |label: &str, from_mm, to_mm| Bar { label: label.to_owned(), from_mm, to_mm, pale: false };
        let plot = TornadoPlot {
            title: "budget".to_owned(),
            bars: vec![bar("rack over-roller", -0.01, 0.01), bar("rack lead", 0.0, 0.012)],
            limits: vec![-0.03, 0.03],
        };
        let svg = plot.svg().unwrap();
        for part in ["budget", "rack over-roller", "rack lead", "0.0120", "ΔCD [mm]"] {
            assert!(svg.contains(part), "{part}");
        }
        assert!(plot.png().unwrap().starts_with(b"\x89PNG"));
        assert!(matches!(TornadoPlot::default().svg(), Err(PlotError::TooFewPoints)));
    }
}
