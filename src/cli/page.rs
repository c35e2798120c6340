//! Pages: the frame of a result in `report` and `paste -o page.html`.

use std::fs::File;
use std::path::{Path, PathBuf};

use super::output::Failure;
use super::target::{is_dash, shown};
use crate::diagnostic::Diagnostic;
use crate::report::html::{InputFile, Page, Section};
use crate::report::{Report, reading_blocks};
use crate::spec::Spec;
use crate::table::Reading;

/// A page of one report: the result, how its table was read, the spec, and the hashes of the inputs.
pub(super) fn of_report(
    title: &str,
    spec: &Spec,
    report: &dyn Report,
    readings: &[Reading],
    notes: &[String],
    inputs: &[PathBuf],
) -> Result<String, Failure> {
    let mut page = Page { title: title.to_owned(), ..Page::default() };
    for input in inputs.iter().filter(|input| !is_dash(input)) {
        page.inputs.push(hashed(input)?);
    }
    page.sections.push(Section::new("Result", report.blocks()));
    page.sections.push(reading_section(readings, notes));
    page.sections.extend(spec_sections(spec));
    page.lift_verdicts();
    Ok(page.html())
}

/// How tables were read.
pub(super) fn reading_section(readings: &[Reading], notes: &[String]) -> Section {
    Section::new("How the tables were read", reading_blocks(readings, notes))
}

/// The spec as it stands in its file, and the keys set on the command line.
pub(super) fn spec_sections(spec: &Spec) -> impl Iterator<Item = Section> {
    let file = Some(("Spec", &spec.source));
    let set = spec.source.next.as_ref().map(|options| ("Set on the command line", options));
    file.into_iter()
        .chain(set)
        .map(|(heading, source)| Section { source: Some(source.text.clone()), ..Section::new(heading, Vec::new()) })
}

pub(super) fn hashed(path: &Path) -> Result<InputFile, Failure> {
    let name = &shown(path);
    let file = File::open(path).and_then(|file| InputFile::of(name, file));
    Ok(file.map_err(|error| Diagnostic::unreadable(name, &error))?)
}
