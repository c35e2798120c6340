//! Results as pictures: SVG and PNG from the same drawing.
//!
//! The reports build a [`CurvePlot`] or a [`LogPlot`]; the command line writes what its `svg` and `png`
//! return. Text in a PNG is set in a font that comes with the crate (see `FONT-LICENSE`), so that a
//! picture looks the same everywhere. Nothing here computes a result.

mod axis;
mod canvas;
mod curve;
mod log;
mod tornado;

pub use canvas::PlotError;
pub use curve::{CurvePlot, Mark, Series};
pub use log::{LogPlot, LogSeries};
pub use tornado::{Bar, TornadoPlot};
