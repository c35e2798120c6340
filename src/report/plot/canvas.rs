//! From a drawing to a picture: SVG and PNG of the same drawing, in the same font.

use plotters::coord::Shift;
use plotters::prelude::*;
use thiserror::Error;

/// Why there is no picture.
#[derive(Debug, Error)]
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
