//! Pictures as SVG files. The name is checked before the run that the picture shows, so that no result is lost to a typing
//! mistake.

use std::io::Write as _;

use super::output::{Failure, Output};
use super::target::{self, Target};
use crate::diagnostic::{Code, Diagnostic};
use crate::report::chart::Chart;

#[derive(Debug, clap::Args)]
pub(super) struct PlotArgs {
    /// Draw the result to this file (.svg).
    #[arg(long, value_name = "FILE")]
    plot: Option<String>,
}

impl PlotArgs {
    /// The picture that is asked for, in a run that reads `inputs`.
    pub(super) fn picture(&self, inputs: Vec<String>) -> Result<Option<Picture>, Failure> {
        self.plot.as_deref().map(|path| Picture::new(path, inputs)).transpose()
    }
}

/// Draws a result to the picture that is asked for, and for a program that holds the answer. Of a run that has not come to its
/// end the picture is kept under another name.
pub(super) fn draw(
    picture: Option<&Picture>,
    chart: impl Fn() -> Chart,
    is_complete: bool,
    output: &mut Output,
) -> Result<(), Failure> {
    output.picture(&chart);
    let Some(picture) = picture else { return Ok(()) };
    let drawn = picture.drawn(&chart())?;
    if is_complete {
        return drawn.finish();
    }
    if let Some(partial) = drawn.keep_partial()? {
        output.remark(&format!("{partial} shows what was computed"));
    }
    Ok(())
}

/// A picture that is to be written.
pub(super) struct Picture {
    path: String,
    /// Files that are read, over which it is not written.
    inputs: Vec<String>,
}

impl Picture {
    /// The picture of that name, in a run that reads `inputs`.
    pub(super) fn new(path: &str, inputs: Vec<String>) -> Result<Self, Failure> {
        if target::ending(path) != "svg" {
            let message = format!("{path}: pictures are written as SVG, to a file");
            let help = "write a name that ends in .svg; a browser or an office program opens the file";
            return Err(Diagnostic::usage(message).help(help).into());
        }
        let picture = Self { path: path.to_owned(), inputs };
        target::refuse_inputs(path, &picture.inputs)?;
        Ok(picture)
    }

    /// Draws the picture and writes it.
    pub(super) fn write(&self, chart: &Chart) -> Result<(), Failure> {
        self.drawn(chart)?.finish()
    }

    fn drawn(&self, chart: &Chart) -> Result<Target, Failure> {
        let failed = |reason: String| Diagnostic::error(Code::FileAccess, reason);
        let nothing = || failed(format!("cannot draw {}: there are no two values to draw between", self.path));
        let svg = chart.svg().ok_or_else(nothing)?;
        let mut target = Target::create(&self.path, &self.inputs)?;
        target.write_all(svg.as_bytes()).map_err(|error| failed(format!("cannot write {}: {error}", self.path)))?;
        Ok(target)
    }
}
