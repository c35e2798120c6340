//! From a drawing to a picture: SVG and PNG of the same drawing, in the same font.

use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;
use thiserror::Error;

/// Why there is no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlotError {
    /// There are no two points to draw a line between.
    #[error("a plot needs at least two points with different strokes")]
    TooFewPoints,
    /// A logarithmic plot shows positive numbers only, and there is none.
    #[error("a logarithmic plot needs at least one point with positive coordinates")]
    NothingPositive,
    /// The drawing failed.
    #[error("the picture cannot be drawn: {0}")]
    Drawing(String),
}

const FONT: &[u8] = include_bytes!("plot-sans.ttf");
pub(super) const FAMILY: &str = "sans-serif";
pub(super) const INK: RGBColor = RGBColor(34, 40, 49);
pub(super) const GRID: RGBColor = RGBColor(222, 226, 232);
/// Told apart in print without colour by their order of darkness, and by people who see few colours.
pub(super) const SERIES: [RGBColor; 6] = [
    RGBColor(18, 84, 160),
    RGBColor(200, 80, 30),
    RGBColor(30, 130, 90),
    RGBColor(120, 60, 150),
    RGBColor(150, 120, 20),
    RGBColor(90, 90, 90),
];

/// What can be drawn.
pub(super) trait Drawing {
    /// Width and height in pixels.
    const SIZE: (u32, u32);

    /// Draws it on `area`.
    fn draw_on<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Result<(), Failure>;

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Result<(), PlotError> {
        // registering the same font again is harmless
        let _ = plotters::style::register_font(FAMILY, FontStyle::Normal, FONT);
        self.draw_on(area).map_err(|error| match error {
            Failure::Plot(error) => error,
            Failure::Drawing(text) => PlotError::Drawing(text),
        })
    }

    fn to_svg(&self) -> Result<String, PlotError> {
        let mut text = String::new();
        self.draw(&SVGBackend::with_string(&mut text, Self::SIZE).into_drawing_area())?;
        Ok(text)
    }

    fn to_png(&self) -> Result<Vec<u8>, PlotError> {
        let (width, height) = Self::SIZE;
        let mut pixels = vec![0; width as usize * height as usize * 3];
        self.draw(&BitMapBackend::with_buffer(&mut pixels, Self::SIZE).into_drawing_area())?;
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let failed = |error: png::EncodingError| PlotError::Drawing(error.to_string());
        let mut writer = encoder.write_header().map_err(failed)?;
        writer.write_image_data(&pixels).map_err(failed)?;
        writer.finish().map_err(failed)?;
        Ok(file)
    }
}

/// The frame of a picture: title, axes with what they show, and a grid.
pub(super) struct Frame<'a> {
    pub(super) title: &'a str,
    /// What the horizontal and the vertical axis show.
    pub(super) labels: (&'a str, &'a str),
    /// Room for these labels and their numbers, in pixels.
    pub(super) room: (u32, u32),
    /// At most so many numbers on each axis.
    pub(super) ticks: (usize, usize),
}

/// An axis of numbers that writes its own labels.
pub(super) trait Scale:
    Ranged<ValueType = f64> + ValueFormatter<f64> + AsRangedCoord<CoordDescType = Self, Value = f64>
{
}

impl<T> Scale for T where
    T: Ranged<ValueType = f64> + ValueFormatter<f64> + AsRangedCoord<CoordDescType = Self, Value = f64>
{
}

/// A chart within its frame.
pub(super) type Framed<'a, DB, X, Y> = ChartContext<'a, DB, Cartesian2d<X, Y>>;

impl Frame<'_> {
    pub(super) fn draw<'a, DB: DrawingBackend, X: Scale, Y: Scale>(
        &self,
        area: &'a DrawingArea<DB, Shift>,
        x: X,
        y: Y,
    ) -> Result<Framed<'a, DB, X, Y>, Failure> {
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(area)
            .caption(self.title, (FAMILY, 24).into_font().color(&INK))
            .margin(16)
            .margin_right(28)
            .x_label_area_size(self.room.0)
            .y_label_area_size(self.room.1)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .x_desc(self.labels.0)
            .y_desc(self.labels.1)
            .x_labels(self.ticks.0)
            .y_labels(self.ticks.1)
            .axis_desc_style((FAMILY, 20).into_font().color(&INK))
            .label_style((FAMILY, 17).into_font().color(&INK))
            .bold_line_style(GRID)
            .light_line_style(WHITE)
            .axis_style(INK)
            .draw()?;
        Ok(chart)
    }
}

/// Draws what the series are, in a corner, and shows the picture.
pub(super) fn legend<'a, DB: DrawingBackend + 'a, X: Scale, Y: Scale>(
    mut chart: Framed<'a, DB, X, Y>,
    area: &DrawingArea<DB, Shift>,
    corner: SeriesLabelPosition,
) -> Result<(), Failure> {
    chart
        .configure_series_labels()
        .position(corner)
        .background_style(WHITE.mix(0.85))
        .border_style(GRID)
        .label_font((FAMILY, 17).into_font().color(&INK))
        .draw()?;
    area.present()?;
    Ok(())
}

/// What can go wrong while drawing, without the backend's type.
pub(super) enum Failure {
    Plot(PlotError),
    Drawing(String),
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for Failure {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self::Drawing(error.to_string())
    }
}
