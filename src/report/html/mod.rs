//! Reports as one page that needs nothing else: no network, no script, no font.
//!
//! The command line fills a [`Page`] with the blocks of other reports and with charts; [`Page::html`] writes it.
//! Colours follow the reader's light or dark setting, and print is always light. All text is escaped.

use std::fmt;

use sha2::{Digest as _, Sha256};

use super::chart::{self, Chart};
use super::table::verdict_word;
use super::{Align, Block, Column, Table, escape, noted};
use crate::evaluation::worse;
use crate::judge::Verdict;

/// A part of a page.
#[derive(Debug, Default)]
pub struct Section {
    /// Its heading.
    pub heading: String,
    /// Pictures at its start.
    pub charts: Vec<Chart>,
    /// Pictures below them, side by side where there is room.
    pub small_charts: Vec<Chart>,
    /// Tables, remarks, verdicts.
    pub blocks: Vec<Block>,
    /// Text as it stands in a file.
    pub source: Option<String>,
}

impl Section {
    /// A part of tables, remarks and verdicts.
    #[must_use]
    pub fn new(heading: impl Into<String>, blocks: Vec<Block>) -> Self {
        Self { heading: heading.into(), blocks, ..Self::default() }
    }
}

/// An input of the page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputFile {
    /// Its name on the command line.
    pub name: String,
    /// Its size.
    pub bytes: u64,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

impl InputFile {
    /// Counts and hashes all bytes of a reader.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn of(name: &str, mut bytes: impl std::io::Read) -> std::io::Result<Self> {
        let mut hash = Sha256::new();
        let mut buffer = vec![0; 1 << 16];
        let mut total = 0;
        loop {
            let count = bytes.read(&mut buffer)?;
            if count == 0 {
                break;
            }
            hash.update(&buffer[..count]);
            total += count as u64;
        }
        let sha256 = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().concat();
        Ok(Self { name: name.to_owned(), bytes: total, sha256 })
    }
}

/// A verdict at the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Headline {
    /// The verdict; `None` if it is open.
    pub verdict: Option<Verdict>,
    /// Of what, and why.
    pub sentence: String,
}

impl fmt::Display for Headline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", verdict_word(self.verdict), self.sentence)
    }
}

/// A page.
#[derive(Debug, Default)]
pub struct Page {
    /// Its title.
    pub title: String,
    /// The facts above the verdict: part, date, inspector.
    pub facts: Vec<(String, String)>,
    /// The verdict that counts, and below it each that it does not name.
    pub verdicts: Vec<Headline>,
    /// Its parts.
    pub sections: Vec<Section>,
    /// Its inputs.
    pub inputs: Vec<InputFile>,
}

impl Page {
    /// Moves the verdicts of all sections to the top: the worst ones as one, then the others. Several passes are one; where there is
    /// no verdict that is said.
    pub fn lift_verdicts(&mut self) {
        let mut all = std::mem::take(&mut self.verdicts);
        for section in &mut self.sections {
            section.blocks.retain(|block| {
                let Block::Verdict(verdict, sentence) = block else { return true };
                all.push(Headline { verdict: *verdict, sentence: sentence.clone() });
                false
            });
        }
        all.dedup();
        let worst = all.iter().map(|one| one.verdict).reduce(worse).flatten();
        let (said, others): (Vec<_>, Vec<_>) = all.into_iter().partition(|one| one.verdict == worst);
        let sentences: Vec<_> = said.iter().map(|one| one.sentence.as_str()).collect();
        self.verdicts = match sentences[..] {
            [] => vec![Headline { verdict: None, sentence: "there is no limit".to_owned() }],
            [_, _, ..] if worst == Some(Verdict::Pass) => {
                [vec![Headline { verdict: worst, sentence: "all limits are met".to_owned() }], said].concat()
            }
            _ => [vec![Headline { verdict: worst, sentence: sentences.join("; ") }], others].concat(),
        };
    }

    /// The page.
    #[must_use]
    pub fn html(&self) -> String {
        let title = escape(&self.title);
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"generator\" content=\"rackmesh {version}\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n\
             <title>{title}</title>\n<style>\n{style}{dark}\n</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n\
             <p class=\"soft\">Predicted movement of the operating centre distance (ΔCD) of a rack and pinion; rackmesh {version}</p>\n",
            version = env!("CARGO_PKG_VERSION"),
            style = include_str!("style.css"),
            dark = chart::dark_style(),
        );
        out += &self.facts_html();
        out.extend(self.verdicts.iter().map(|Headline { verdict, sentence }| verdict_html(*verdict, sentence)));
        if self.verdicts.first().is_some_and(|headline| headline.verdict.is_some()) {
            out += "<p class=\"sign\"><span>Date</span><span>Name</span><span>Signature</span></p>\n";
        }
        for (index, section) in self.sections.iter().enumerate() {
            out += &format!(
                "<section aria-labelledby=\"s{index}\">\n<h2 id=\"s{index}\">{}</h2>\n",
                escape(&section.heading)
            );
            for chart in &section.charts {
                out += &figure(chart);
            }
            if !section.small_charts.is_empty() {
                let charts: String = section.small_charts.iter().map(figure).collect();
                out += &format!("<div class=\"small\">\n{charts}</div>\n");
            }
            out += &blocks_html(&section.blocks);
            if let Some(source) = &section.source {
                out += &format!("<pre tabindex=\"0\">{}</pre>\n", escape(source));
            }
            out += "</section>\n";
        }
        out += &self.inputs_html();
        out += "</main>\n</body>\n</html>\n";
        out
    }

    fn facts_html(&self) -> String {
        let fact = |(name, text): &(String, String)| {
            format!("<div><dt>{}</dt><dd>{}</dd></div>\n", escape(name), escape(text))
        };
        let facts: String = self.facts.iter().map(fact).collect();
        if facts.is_empty() { facts } else { format!("<dl class=\"facts\">\n{facts}</dl>\n") }
    }

    fn inputs_html(&self) -> String {
        let rows = self.inputs.iter().map(|input| {
            format!(
                "<tr><th scope=\"row\">{}</th><td class=\"n\">{}</td><td><code>{}</code></td></tr>\n",
                escape(&input.name),
                input.bytes,
                escape(&input.sha256)
            )
        });
        format!(
            "<section aria-labelledby=\"inputs\">\n<h2 id=\"inputs\">Inputs</h2>\n<p class=\"note\">Made by rackmesh {} from:</p>\n\
             <div class=\"scroll\" role=\"region\" aria-label=\"inputs\" tabindex=\"0\"><table>\n<caption>Files and their hashes</caption>\n\
             <thead><tr><th scope=\"col\">file</th><th scope=\"col\" class=\"n\">bytes</th><th scope=\"col\">SHA-256</th></tr></thead>\n\
             <tbody>\n{}</tbody>\n</table></div>\n</section>\n",
            env!("CARGO_PKG_VERSION"),
            rows.collect::<String>()
        )
    }
}

/// A picture; nothing if it shows nothing.
fn figure(chart: &Chart) -> String {
    chart.inline().map_or_else(String::new, |svg| format!("<figure>{svg}</figure>\n"))
}

fn verdict_html(verdict: Option<Verdict>, sentence: &str) -> String {
    let class = verdict.map_or("open", Verdict::name);
    let word = verdict_word(verdict).to_uppercase();
    format!("<p class=\"verdict {class}\"><b>{word}</b>{}</p>\n", escape(sentence))
}

fn block_html(block: &Block) -> String {
    match block {
        // the section's heading says it
        Block::Title(_) => String::new(),
        Block::Table(table) => table_html(table),
        Block::Drawing(lines) => format!("<pre>{}</pre>\n", escape(lines)),
        Block::Remark(remark) => format!("<p class=\"note\">{}</p>\n", escape(&noted(remark))),
        Block::Note(note) => format!("<p class=\"note\">{}</p>\n", escape(note)),
        Block::Verdict(verdict, sentence) => verdict_html(*verdict, sentence),
    }
}

/// Whether a table may stand beside others.
fn is_small(block: &Block) -> bool {
    const MOST_ROWS: usize = 16;
    matches!(block, Block::Table(table) if table.rows.len() <= MOST_ROWS && !is_wide(table))
}

/// Whether a table takes the whole width, or more.
fn is_wide(table: &Table) -> bool {
    const MOST_COLUMNS: usize = 8;
    table.columns.len() > MOST_COLUMNS
}

/// Blocks one below the other, small tables side by side where there is room.
fn blocks_html(blocks: &[Block]) -> String {
    let mut out = String::new();
    for group in blocks.chunk_by(|one, next| is_small(one) && is_small(next)) {
        let html: String = group.iter().map(block_html).collect();
        out += &if group.len() > 1 { format!("<div class=\"tables\">\n{html}</div>\n") } else { html };
    }
    out
}

/// Text of a cell, whose lines break between words only: a word with a hyphen stays whole, up to a length.
fn cell_html(text: &str) -> String {
    const LONGEST: usize = 40;
    let may_break = |word: &str| word.chars().count() <= LONGEST && word.trim_matches('-').contains('-');
    let words = text.split(' ').map(|word| {
        let html = escape(word);
        if may_break(word) { format!("<span class=\"w\">{html}</span>") } else { html }
    });
    words.collect::<Vec<_>>().join(" ")
}

/// A table, named by the heading of its first column. Neighbouring columns whose headings begin with the same line have it above
/// them once.
fn table_html(table: &Table) -> String {
    let class = |align: Align| if align == Align::Right { " class=\"n\"" } else { "" };
    let name = table.columns.first().map_or_else(String::new, |column| escape(&column.heading.replace('\n', " ")));
    // many columns are small on paper
    let wide = if is_wide(table) { " wide" } else { "" };
    let mut out = format!(
        "<div class=\"scroll{wide}\" role=\"region\" aria-label=\"{name}\" tabindex=\"0\"><table>\n<caption>{name}</caption>\n<thead><tr>"
    );
    let lines = |text: &str| text.lines().map(cell_html).collect::<Vec<_>>().join("<br>");
    let above = |column: &Column| column.heading.split_once('\n').map(|(above, _)| above.to_owned());
    let groups: Vec<_> =
        table.columns.chunk_by(|one, next| above(one).is_some() && above(one) == above(next)).collect();
    let rows = if groups.iter().any(|group| group.len() > 1) { " rowspan=\"2\"" } else { "" };
    let mut below = String::new();
    for group in groups {
        if let [column] = group {
            out += &format!("<th scope=\"col\"{rows}{}>{}</th>", class(column.align), lines(&column.heading));
            continue;
        }
        let above = group.first().and_then(above).unwrap_or_default();
        out += &format!("<th scope=\"colgroup\" colspan=\"{}\">{}</th>", group.len(), cell_html(&above));
        for column in group {
            let own = column.heading.split_once('\n').map_or("", |(_, own)| own);
            below += &format!("<th scope=\"col\"{}>{}</th>", class(column.align), lines(own));
        }
    }
    out += &if below.is_empty() { String::new() } else { format!("</tr>\n<tr>{below}") };
    out += "</tr></thead>\n<tbody>\n";
    for row in &table.rows {
        out += "<tr>";
        for (index, (cell, column)) in row.iter().zip(&table.columns).enumerate() {
            let (class, cell) = (class(column.align), cell_html(cell));
            out += &if index == 0 {
                format!("<th scope=\"row\"{class}>{cell}</th>")
            } else {
                format!("<td{class}>{cell}</td>")
            };
        }
        out += "</tr>\n";
    }
    out + "</tbody>\n</table></div>\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::chart::{Axis, Layer, Shape};

    #[test]
    fn text_never_becomes_markup() {
        let evil = "<script>alert('x')</script> \" & ]]>";
        let table = Table {
            columns: vec![Column::text(evil), Column::number("n")],
            rows: vec![vec![evil.to_owned(), "1".to_owned()]],
        };
        let page = Page {
            title: evil.to_owned(),
            facts: vec![(evil.to_owned(), evil.to_owned())],
            verdicts: vec![Headline { verdict: Some(Verdict::Fail), sentence: evil.to_owned() }],
            sections: vec![Section {
                heading: evil.to_owned(),
                charts: vec![Chart {
                    title: evil.to_owned(),
                    x: Axis { label: evil.to_owned(), ..Axis::default() },
                    y: Axis { label: evil.to_owned(), ..Axis::default() },
                    layers: vec![Layer::new(evil, Shape::Line(vec![(0.0, 0.0), (1.0, 1.0)]))],
                    ..Chart::default()
                }],
                small_charts: Vec::new(),
                blocks: vec![Block::Table(table), Block::Note(evil.to_owned()), Block::Drawing(evil.to_owned())],
                source: Some(evil.to_owned()),
            }],
            inputs: vec![InputFile { name: evil.to_owned(), bytes: 1, sha256: evil.to_owned() }],
        };
        let html = page.html();
        assert!(!html.contains("<script") && !html.contains("alert('"), "{html}");
        assert_eq!(html.matches("<caption>").count(), html.matches("<table").count());
        assert!(html.contains("<th scope=\"col\" class=\"n\">n</th>"));
    }

    #[test]
    fn names_stay_whole_and_neighbours_share_a_heading() {
        let columns = vec![
            Column::text("part"),
            Column::number("rack over-roller\nmeasured"),
            Column::number("rack over-roller\nmargin [mm]"),
            Column::number("rack pitch\ndeviation [µm]"),
        ];
        let cells = ["LOT-2026-0417", "25.0012", "-0.0011", "+0.4"].map(str::to_owned);
        let table = Table { columns, rows: vec![cells.to_vec()] };
        let html = blocks_html(&[Block::Table(table.clone())]);
        for part in [
            "<th scope=\"colgroup\" colspan=\"2\">rack <span class=\"w\">over-roller</span></th>",
            "<th scope=\"col\" rowspan=\"2\" class=\"n\">rack pitch<br>deviation [µm]</th>",
            "</tr>\n<tr><th scope=\"col\" class=\"n\">measured</th><th scope=\"col\" class=\"n\">margin [mm]</th></tr>",
            "<th scope=\"row\"><span class=\"w\">LOT-2026-0417</span></th>",
            "<td class=\"n\">-0.0011</td>",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
        // small tables side by side, those of many rows one below the other
        let long = Table { rows: table.rows.iter().cycle().take(60).cloned().collect(), ..table.clone() };
        let [small, long] = [table, long].map(Block::Table);
        assert_eq!(blocks_html(&[long.clone(), small.clone()]).matches("class=\"tables\"").count(), 0);
        assert_eq!(blocks_html(&[long, small.clone(), small]).matches("class=\"tables\"").count(), 1);
    }

    #[test]
    fn hashes_are_those_of_the_standard() {
        // FIPS 180-4, the example of one block
        let input = InputFile::of("abc", b"abc".as_slice()).expect("memory is readable");
        assert_eq!(input.sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        assert_eq!(input.bytes, 3);
    }
}
