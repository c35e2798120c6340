//! Answers in short: of many rows some, with counts, sums and a digest of the others.

use super::compared::skeleton;
use super::*;

/// FNV-1a.
pub(super) fn digest(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// What is stored of a text.
pub(super) fn shortened(text: &str, arguments: &str) -> String {
    let is_table = arguments.contains("--format csv") || arguments.starts_with("batch");
    if text.starts_with("<!DOCTYPE") {
        page_text(text)
    } else if text.starts_with("<svg") {
        drawing(text)
    } else if text.starts_with("{\n") {
        in_blocks(&folded(text), |line| line.trim_start().starts_with('{') && line.ends_with(['}', ',']))
    } else if is_table && !arguments.contains("--decimals full") {
        let lines: Vec<_> = text.lines().map(str::to_owned).collect();
        in_blocks(&lines, |line| line.contains(|c: char| c.is_ascii_digit()) && !line.starts_with("error"))
    } else {
        text.to_owned()
    }
}

/// JSON with every innermost object and array on one line.
fn folded(json: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut innermost = None;
    for line in json.lines() {
        let closes = line.trim_start().starts_with(['}', ']']);
        if let Some(open) = innermost.take_if(|_| closes) {
            let within: Vec<_> = lines.drain(open + 1..).collect();
            for part in within.iter().map(String::as_str).chain([line]) {
                lines[open] += " ";
                lines[open] += part.trim_start();
            }
        } else {
            innermost = if line.ends_with(['{', '[']) { Some(lines.len()) } else { innermost };
            lines.push(line.to_owned());
        }
    }
    lines
}

/// The lines, with many rows as blocks: the first row, then counts, sums and a digest of all rows of the block.
fn in_blocks(lines: &[String], is_row: impl Fn(&str) -> bool) -> String {
    let mut text = String::new();
    for run in lines.chunk_by(|a, b| is_row(a) == is_row(b)) {
        if run.len() <= BLOCK || !is_row(&run[0]) {
            text += &(run.join("\n") + "\n");
        } else {
            for rows in run.chunks(BLOCK) {
                text += &format!("{}\n    {}\n", rows[0], summary(&rows.join("\n")));
            }
        }
    }
    text
}

/// How many rows and verdicts, the sums of the rows' first, second … numbers, and the digest.
fn summary(rows: &str) -> String {
    let mut sums: Vec<f64> = Vec::new();
    for row in rows.lines() {
        let (_, numbers) = skeleton(row);
        sums.resize(sums.len().max(numbers.len()), 0.0);
        sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
    }
    let mut text = format!("{} rows", rows.lines().count());
    for verdict in ["pass", "fail", "indeterminate"].iter().filter(|verdict| rows.contains(**verdict)) {
        text += &format!(", {} {verdict}", rows.matches(verdict).count());
    }
    text += ", sums";
    for sum in sums {
        text += &format!(" {}", format!("{sum:.9}").trim_end_matches('0').trim_end_matches('.'));
    }
    format!("{text}, fnv_{:016x}", digest(rows))
}

/// The texts of a page, and of each drawing a summary.
fn page_text(html: &str) -> String {
    let (mut text, mut rest) = (String::new(), html);
    while let Some(start) = ["<style", "<svg"].iter().filter_map(|tag| rest.find(tag)).min() {
        let end = start + ["</style>", "</svg>"].iter().filter_map(|tag| rest[start..].find(tag)).min().unwrap();
        text += &rest[..start];
        if rest[start..].starts_with("<svg") {
            text += &drawing(&rest[start..end]);
        }
        rest = &rest[end..];
    }
    let text = without_tags(&(text + rest));
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    format!("{}\npage fnv_{:016x}\n", lines.collect::<Vec<_>>().join("\n"), digest(html))
}

/// The texts of a drawing, how many numbers it has, and their sum.
fn drawing(svg: &str) -> String {
    let (_, numbers) = skeleton(&svg.replace(char::is_alphabetic, " "));
    let texts = without_tags(svg).split_whitespace().collect::<Vec<_>>().join(" ");
    let sum: f64 = numbers.iter().sum();
    format!("drawing: {texts}\n{} numbers, sum {sum:.3}, fnv_{:016x}\n", numbers.len(), digest(svg))
}

fn without_tags(html: &str) -> String {
    let texts = html.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text));
    texts.map(|text| if text.ends_with('\n') { text.to_owned() } else { format!("{text} ") }).collect()
}
