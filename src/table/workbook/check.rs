//! Unpacks every part of a workbook once, before anything is parsed, to count its bytes and to find what its XML says.

use std::collections::{HashMap, HashSet};
use std::io::{self, Read, Seek};
use std::sync::Arc;

use super::comments::{Comment, comments, conditional, odd_runs, odd_styles};
use super::parts::{SheetPart, sheet_parts};
use super::sheet::{Known, SheetReader, SheetXml};
use super::xml::{ODD, each_tag, is_odd};
use crate::diagnostic::Diagnostic;

/// Bytes of a sheet at most: enough for a million rows of twenty columns.
const LARGEST_SHEET: u64 = 768 << 20;
/// Bytes at most of what is kept in memory as a whole: texts, styles, names.
const LARGEST_OTHER: u64 = 96 << 20;
/// Sheets at most. Each is looked into, unless one is chosen.
pub(super) const MOST_SHEETS: usize = 1000;

/// What is found while a workbook is unpacked.
pub(super) struct Checked {
    /// What the XML of each sheet says, by its name.
    pub(super) sheets: HashMap<String, Arc<SheetXml>>,
    /// A digest of what each sheet stores.
    pub(super) digests: HashMap<String, u32>,
    /// The comments on cells of any sheet.
    pub(super) comments: Vec<Comment>,
}

/// Unpacks every part that is read later, to count its bytes. Hardly any are kept.
pub(super) fn check<S: Read + Seek + ?Sized>(file: &str, source: &mut S) -> Result<Checked, Diagnostic> {
    let broken = |error: &dyn std::fmt::Display| no_workbook(file, error);
    let mut archive = zip::ZipArchive::new(source).map_err(|error| broken(&error))?;
    let (mut workbook, mut relations, mut texts, mut styles) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut parts = Vec::new();
    for index in 0..archive.len() {
        let stored = archive.by_index(index).map_err(|error| broken(&error))?;
        let part = stored.name().map_err(|error| broken(&error))?.to_ascii_lowercase();
        if [".xml", ".rels", ".vml"].into_iter().any(|suffix| part.ends_with(suffix)) {
            parts.push((part.starts_with("xl/worksheets/") && part.strip_suffix(".xml").is_some(), part, index));
        }
    }
    // shared texts and styles come before the sheets, which refer to them
    parts.sort();
    if let Some([(_, part, _), _]) = parts.array_windows().find(|[(_, one, _), (_, other, _)]| one == other) {
        return Err(Diagnostic::unreadable(file, &format!("it has two parts {part}")));
    }
    let (mut sheets, mut digests): (HashMap<String, SheetXml>, HashMap<String, u32>) = (HashMap::new(), HashMap::new());
    let (mut known, mut other, mut found) = (Known::default(), 0, Vec::new());
    let mut is_known = false;
    for (is_sheet, part, index) in parts {
        if is_sheet && !is_known {
            known = Known { odd_runs: odd_runs(&texts), conditional: conditional(&styles) };
            is_known = true;
        }
        let stored = archive.by_index(index).map_err(|error| broken(&error))?;
        digests.insert(part.clone(), stored.crc32());
        let most = if is_sheet { LARGEST_SHEET } else { LARGEST_OTHER - other };
        let (mut sheet, mut xml) = (SheetReader::new(&known), Vec::new());
        let into: &mut dyn io::Write = match part.as_str() {
            _ if is_sheet => &mut sheet,
            // pivot tables hold copies of cells
            _ if part.starts_with("xl/") && !part.starts_with("xl/pivot") => &mut xml,
            _ => &mut io::sink(),
        };
        let size = io::copy(&mut stored.take(most + 1), into).map_err(|error| broken(&error))?;
        if size > most {
            return Err(Diagnostic::unreadable(
                file,
                &format!("its part {part} unpacks to more than {} MiB", most >> 20),
            ));
        }
        if is_sheet {
            sheets.insert(part, sheet.sheet);
            continue;
        }
        other += size;
        let mut has_odd = false;
        each_tag(&xml, |tag, _| has_odd |= is_odd(tag));
        if has_odd {
            return Err(Diagnostic::unreadable(file, &format!("its part {part} has {ODD}")));
        }
        match part.as_str() {
            "xl/workbook.xml" => workbook = xml,
            "xl/_rels/workbook.xml.rels" => relations = xml,
            "xl/sharedstrings.xml" => texts = xml,
            "xl/styles.xml" => styles = xml,
            _ => found.extend(comments(&xml)),
        }
    }
    if let Some(odd) = odd_styles(&styles) {
        return Err(Diagnostic::unreadable(file, &format!("it has {odd}")));
    }
    let mut checked = Checked { sheets: HashMap::new(), digests, comments: found };
    checked
        .name_sheets(sheet_parts(&workbook, &relations), sheets)
        .map_err(|problem| Diagnostic::unreadable(file, &problem))?;
    Ok(checked)
}

impl Checked {
    /// Gives the name of its sheet to what is known of each part.
    ///
    /// # Errors
    /// If there are too many sheets, or two of one name or in one part.
    fn name_sheets(&mut self, listed: Vec<SheetPart>, mut sheets: HashMap<String, SheetXml>) -> Result<(), String> {
        if listed.len() > MOST_SHEETS {
            let help = "save the sheet with the measured values as a workbook of its own, or as .csv";
            return Err(format!("it has {} sheets, and at most {MOST_SHEETS} are read: {help}", listed.len()));
        }
        let digests = std::mem::take(&mut self.digests);
        // the texts of a sheet are stored elsewhere, and belong to its digest
        let of_texts = digests.get("xl/sharedstrings.xml").copied().unwrap_or_default();
        let mut parts = HashSet::new();
        for SheetPart { part, name, is_hidden } in listed {
            let digest = digests.get(&part).copied().unwrap_or_default();
            if self.digests.insert(name.clone(), digest.wrapping_mul(31).wrapping_add(of_texts)).is_some() {
                return Err(format!("it has two sheets `{name}`"));
            }
            // each part is read once
            if digests.contains_key(&part) && !parts.insert(part.clone()) {
                return Err(format!("its sheet `{name}` is stored in {part}, like a sheet before it"));
            }
            if let Some(mut sheet) = sheets.remove(&part) {
                sheet.is_hidden = is_hidden;
                self.sheets.insert(name, sheet.into());
            }
        }
        Ok(())
    }
}

pub(super) fn no_workbook(name: &str, error: &dyn std::fmt::Display) -> Diagnostic {
    Diagnostic::unreadable(name, &format!("it is no Excel workbook ({error})"))
}
