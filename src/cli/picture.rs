//! Pictures as SVG files. The file is begun before the run, so that no result is lost to a wrong file name.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::output::{Failure, Output};
use super::target::{self, Target, shown};
use crate::diagnostic::{Code, Diagnostic};
use crate::report::chart::Chart;

#[derive(Debug, clap::Args)]
pub(super) struct PlotArgs {
    /// Draw the result to this file (.svg).
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

impl PlotArgs {
    /// The file asked for.
    pub(super) fn path(&self) -> Option<&Path> {
        self.plot.as_deref()
    }

    /// The picture asked for, in a run that reads `inputs`.
    pub(super) fn picture(&self, inputs: &[PathBuf]) -> Result<Option<Picture>, Failure> {
        self.plot.as_deref().map(|path| Picture::begin(path, inputs)).transpose()
    }
}

/// Draws a result to the picture asked for, and for a program that holds the answer. The picture of an incomplete run is kept under
/// another name.
pub(super) fn draw(
    picture: Option<Picture>,
    chart: impl Fn() -> Chart,
    is_complete: bool,
    output: &mut Output,
) -> Result<(), Failure> {
    output.picture(&chart);
    match picture {
        Some(picture) if !is_complete && chart().svg().is_none() => picture.discard(output),
        Some(picture) => picture.draw(&chart())?.end(is_complete, output)?,
        None => {}
    }
    Ok(())
}

/// A picture that is to be written.
pub(super) struct Picture {
    path: PathBuf,
    target: Target,
}

impl Picture {
    /// Begins the picture of that name, in a run that reads `inputs`.
    pub(super) fn begin(path: &Path, inputs: &[PathBuf]) -> Result<Self, Failure> {
        if target::ending(path) != "svg" {
            let message = format!("{}: pictures are written as SVG, to a file", shown(path));
            let help = "write a name that ends in .svg; a browser or an office program opens the file";
            return Err(Diagnostic::usage(message).help(help).into());
        }
        Ok(Self { path: path.to_owned(), target: Target::create(path, inputs)? })
    }

    /// Reports that an interrupted run has nothing to draw.
    pub(super) fn discard(self, output: &mut Output) {
        self.target.discard(output);
    }

    /// Draws the picture; the file is still to be put in its place.
    pub(super) fn draw(mut self, chart: &Chart) -> Result<Target, Failure> {
        let svg = chart.svg().ok_or_else(|| {
            let message = format!("cannot draw {}: there are no two values to draw between", shown(&self.path));
            Diagnostic::error(Code::FileAccess, message)
        })?;
        self.target.write_all(svg.as_bytes())?;
        Ok(self.target)
    }
}
