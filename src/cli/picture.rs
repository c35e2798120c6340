//! Pictures: SVG or PNG as the file's name says. The name is checked before the run that the picture shows, so that no
//! result is lost to a typing mistake.

use std::io::Write as _;

use super::output::Failure;
use super::target::{self, Target};
use crate::diagnostic::{Code, Diagnostic};
use crate::report::plot::PlotError;

/// A picture that is to be written.
pub(super) struct Picture {
    path: String,
    /// Files that are read, over which it is not written.
    inputs: Vec<String>,
    is_png: bool,
}

impl Picture {
    /// The picture of that name, in a run that reads `inputs`.
    pub(super) fn new(path: &str, inputs: Vec<String>) -> Result<Self, Failure> {
        let Some(ending) = target::known_ending(path, &["svg", "png"])? else {
            let message = format!("{path}: a picture is written to a file");
            return Err(Diagnostic::error(Code::Usage, message).help("its name ends in .svg or .png").into());
        };
        let picture = Self { path: path.to_owned(), inputs, is_png: ending == "png" };
        target::refuse_inputs(path, &picture.inputs())?;
        Ok(picture)
    }

    /// Draws the picture and writes it.
    pub(super) fn write(
        &self,
        svg: impl FnOnce() -> Result<String, PlotError>,
        png: impl FnOnce() -> Result<Vec<u8>, PlotError>,
    ) -> Result<(), Failure> {
        self.drawn(svg, png)?.finish()
    }

    /// Draws the picture of a run that did not come to its end; gives the name that it is kept under.
    pub(super) fn write_partial(
        &self,
        svg: impl FnOnce() -> Result<String, PlotError>,
        png: impl FnOnce() -> Result<Vec<u8>, PlotError>,
    ) -> Result<Option<String>, Failure> {
        self.drawn(svg, png)?.keep_partial()
    }

    fn drawn(
        &self,
        svg: impl FnOnce() -> Result<String, PlotError>,
        png: impl FnOnce() -> Result<Vec<u8>, PlotError>,
    ) -> Result<Target, Failure> {
        let failed = |reason: &dyn std::fmt::Display, what: &str| {
            Diagnostic::error(Code::FileAccess, format!("cannot {what} {}: {reason}", self.path))
        };
        let bytes = if self.is_png { png() } else { svg().map(String::into_bytes) };
        let bytes = bytes.map_err(|error| failed(&error, "draw"))?;
        let mut target = Target::create(&self.path, &self.inputs())?;
        target.write_all(&bytes).map_err(|error| failed(&error, "write"))?;
        Ok(target)
    }

    fn inputs(&self) -> Vec<&str> {
        self.inputs.iter().map(String::as_str).collect()
    }
}
