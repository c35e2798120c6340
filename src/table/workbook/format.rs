//! How styles show what cells hold: `0.000" mm"` shows millimetres, whatever the heading says, `;;;` shows nothing, and a font may
//! strike a text through. Read from the styles of a workbook; asked for each cell.

use calamine::{Font, Style as CellStyle};

use crate::table::cell::{Cell, Content};
use crate::table::grid::unit_of;

/// A style that does not show the content of every cell plainly.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Style {
    /// For numbers above zero, below zero, zero, and for texts.
    sections: [Section; 4],
    is_struck_through: bool,
}

/// How a format shows some numbers, or texts.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct Section {
    /// What is shown before the number or text, and behind it.
    before: String,
    behind: String,
    /// Whether the number or text is shown at all.
    is_shown: bool,
    /// Whether another number is shown: a part of the number, a fraction, a percentage.
    is_other: bool,
    /// How many digits of a whole number are shown at least; 0 if it is shown with decimals.
    digits: usize,
    /// What it is for.
    holds: Holds,
}

/// What a section of a format is for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Holds {
    #[default]
    Numbers,
    NumbersOfCondition,
    Texts,
}

/// The mark before and behind a text that is struck through.
const STRUCK: &str = "~~";

impl Style {
    /// How a style shows the content of a cell; `None` if it shows all of it plainly.
    pub(super) fn of(style: &CellStyle) -> Option<Self> {
        let code = style.number_format.as_ref().map_or("", |format| &format.format_code);
        let is_struck_through = style.font.as_ref().is_some_and(Font::has_strikethrough);
        Self::of_code(code, is_struck_through)
    }

    /// The same from the code of a number format.
    pub(super) fn of_code(code: &str, is_struck_through: bool) -> Option<Self> {
        let plain = || Section { is_shown: true, ..Section::default() };
        let mut all: Vec<Section> = if code.is_empty() { Vec::new() } else { sections(code) };
        let text =
            all.pop_if(|last| last.holds == Holds::Texts).or_else(|| if all.len() > 3 { all.pop() } else { None });
        let text = text.unwrap_or_else(plain);
        let positive = all.first().cloned().unwrap_or_else(plain);
        let negative = all.get(1).cloned().map_or_else(|| positive.clone(), without_minus);
        let zero = all.get(2).cloned().unwrap_or_else(|| positive.clone());
        let mut sections = [positive, negative, zero, text];
        if all.iter().any(|section| section.holds == Holds::NumbersOfCondition) {
            // conditions are not computed: nothing tells which section applies
            let is_plain = |section: &Section| section.is_plain() || without_minus(section.clone()).is_plain();
            let one = Section { is_other: !all.iter().all(is_plain), ..plain() };
            sections[..3].fill(one);
        }
        (is_struck_through || !sections.iter().all(Section::is_plain)).then_some(Self { sections, is_struck_through })
    }

    /// The content of a cell as a person sees it.
    pub(super) fn seen(&self, content: Content) -> Content {
        if self.is_struck_through {
            return struck(content);
        }
        let [positive, negative, zero, text] = &self.sections;
        match &content {
            Content::Number(number) if number.digits == 0 => zero.seen(content),
            Content::Number(number) if number.negative => negative.seen(content),
            Content::Number(_) => positive.seen(content),
            Content::Text(_) => text.seen(content),
            _ => content,
        }
    }
}

/// The content of a cell that is struck through.
pub(super) fn struck(content: Content) -> Content {
    match content {
        Content::Empty => Content::Empty,
        content => unlike(format!("{STRUCK}{content}{STRUCK}")),
    }
}

/// What a cell holds of which a run is raised or lowered: a digit there is none of a number.
pub(super) fn raised(content: Content) -> Content {
    let cell = Cell::from(content);
    if !cell.is_number() {
        return cell.content;
    }
    unlike(format!("{}, of which a part is raised or lowered", cell.text()))
}

fn unlike(seen: String) -> Content {
    Content::Unlike(seen.into())
}

impl Section {
    fn is_plain(&self) -> bool {
        let Self { before, behind, is_shown, is_other, digits, .. } = self;
        before.trim().is_empty() && behind.trim().is_empty() && *is_shown && !is_other && *digits < 2
    }

    fn seen(&self, content: Content) -> Content {
        if self.is_plain() {
            return content;
        }
        let (before, behind) = (self.before.trim_start(), self.behind.trim_end());
        match &content {
            held if !self.is_shown && before.is_empty() => unlike(format!("{held}, which is not shown")),
            held if !self.is_shown => unlike(format!("{held}, shown as `{before}`")),
            held if self.is_other => unlike(format!("{held}, shown as another number")),
            Content::Number(number) => {
                let sign = if number.negative { "-" } else { "" };
                let held = content.to_string();
                let whole = held.strip_prefix('-').unwrap_or(&held);
                let width = if whole.bytes().all(|digit| digit.is_ascii_digit()) { self.digits } else { 0 };
                let seen = format!("{before}{sign}{whole:0>width$}{behind}");
                match behind.trim() {
                    "" if before.is_empty() => Content::Text(seen.as_str().into()),
                    unit if before.is_empty() && unit_of(unit, true).is_some() => {
                        Content::Measured(Box::new((*number, unit.to_owned())))
                    }
                    _ => unlike(format!("{held}, shown as `{seen}`")),
                }
            }
            held => unlike(format!("{held}, shown as `{before}{held}{behind}`")),
        }
    }
}

/// A section for negative numbers without its minus or its brackets. If it has neither, the number looks like another one.
fn without_minus(mut section: Section) -> Section {
    let (before, behind) = (section.before.trim(), section.behind.trim());
    let bare = before.strip_prefix('-').map(|before| (before, behind));
    let bare = bare.or_else(|| Some((before.strip_prefix('(')?, behind.strip_suffix(')')?)));
    match bare.map(|(before, behind)| (before.to_owned(), behind.to_owned())) {
        Some(bare) => (section.before, section.behind) = bare,
        None => section.is_other |= section.is_shown,
    }
    section
}

/// The sections of the code of a number format.
fn sections(code: &str) -> Vec<Section> {
    let (mut all, mut characters) = (vec![Section::default()], code.chars());
    while let Some(c) = characters.next() {
        let rest = characters.as_str();
        let behind = |end: usize| rest.get(..end).unwrap_or(rest);
        let Some(section) = all.last_mut() else { break };
        let mut skipped = 0;
        match c {
            ';' => all.push(Section::default()),
            '"' => {
                let end = rest.find('"').unwrap_or(rest.len());
                section.show(behind(end));
                skipped = behind(end).chars().count() + 1;
            }
            '[' => {
                let end = rest.find(']').unwrap_or(rest.len());
                section.bracket(behind(end));
                skipped = behind(end).chars().count() + 1;
            }
            // a blank as wide as the next character
            '_' => skipped = 1,
            // the next character as it is, or one that fills the cell
            '\\' | '*' => {
                section.show(&rest.chars().take(1).collect::<String>());
                skipped = 1;
            }
            '0' | '#' | '?' => {
                section.digits += usize::from(c == '0' && !section.is_other);
                section.is_shown = true;
            }
            '.' => {}
            '@' => (section.holds, section.is_shown) = (Holds::Texts, true),
            // groups thousands if digits follow, otherwise divides by 1000
            ',' if section.is_shown => {
                let next = rest.trim_start_matches(',').chars().next();
                section.is_other |= !next.is_some_and(|next| "0#?".contains(next));
            }
            '%' | '/' if section.is_shown => {
                section.is_other = true;
                section.show(&c.to_string());
            }
            'G' | 'g' if rest.get(..6).is_some_and(|rest| rest.eq_ignore_ascii_case("eneral")) => {
                section.is_shown = true;
                skipped = 6;
            }
            // an exponent
            'E' | 'e' if section.is_shown && rest.starts_with(['+', '-']) => {
                skipped = 1 + rest[1..].chars().take_while(|c| "0#?".contains(*c)).count();
            }
            '+' | ',' if !section.is_shown => {}
            c => section.show(&c.to_string()),
        }
        characters.by_ref().take(skipped).for_each(drop);
    }
    for section in &mut all {
        // a format with decimals shows no whole numbers
        section.digits = if code.contains('.') { 0 } else { section.digits };
    }
    all
}

impl Section {
    fn show(&mut self, text: &str) {
        if self.is_shown { self.behind += text } else { self.before += text }
    }

    /// Reads what stands in square brackets: a colour, a condition, a currency or a language.
    fn bracket(&mut self, inside: &str) {
        if let Some(currency) = inside.strip_prefix('$') {
            self.show(currency.split('-').next().unwrap_or_default());
        }
        if inside.starts_with(['<', '>', '=']) {
            self.holds = Holds::NumbersOfCondition;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(code: &str, content: Content) -> Content {
        Style::of_code(code, false).map_or(content.clone(), |style| style.seen(content))
    }

    #[test]
    fn what_a_format_shows() {
        for code in [
            "",
            "General",
            "@",
            "#,##0.00_ ",
            "_-* #,##0.00_-;-* #,##0.00_-",
            "+0.000;-0.000",
            "0.00_);(0.00)",
            "0.00;[Red]-0.00",
            "[Red][>0.03]0.000;0.000",
            "0.0E-00",
            "[$-407]0.00",
            "0.000;-0.000;0;@",
        ] {
            assert_eq!(Style::of_code(code, false), None, "{code}");
        }
        for (code, number, text) in [
            ("0.000\" mm\"", 25.011, "25.011 mm"),
            ("0.000\\ \\µ\\m;-0.000", 3.1, "3.1 µm"),
            ("0.000\\ \\µ\\m;-0.000", -3.1, "-3.1"),
            ("0.0[$mm]", 3.0, "3 mm"),
            ("0.00%", 0.5, "0.5, shown as another number"),
            ("\"<\"0.0", 0.5, "0.5, shown as `<0.5`"),
            ("-0.000", 0.5, "0.5, shown as `-0.5`"),
            ("0.000;0.000", 0.5, "0.5"),
            ("0.000;[Red]0.000", -0.5, "-0.5, shown as another number"),
            ("0.0;\"n.i.O.\"", -1.0, "-1, shown as `n.i.O.`"),
            ("0.0;-0.0;\"-\"", 0.0, "0, shown as `-`"),
            ("#,##0.0,", 12500.0, "12500, shown as another number"),
            ("0.000/1000", 1.5, "1.5, shown as another number"),
            ("0.0\" i.O.\"", 1.5, "1.5, shown as `1.5 i.O.`"),
            ("0.0\"@\"", 1.5, "1.5, shown as `1.5@`"),
            ("[>1]0.0;\"x\"", 1.5, "1.5, shown as another number"),
            (";;;", 1.5, "1.5, which is not shown"),
            ("0.000;;", -1.5, "-1.5, which is not shown"),
            ("\"\"", 1.5, "1.5, which is not shown"),
            ("00000", 123.0, "00123"),
            ("\"P\"000", 7.0, "7, shown as `P007`"),
            ("*-0", 7.0, "7, shown as `-7`"),
        ] {
            assert_eq!(seen(code, Content::of_f64(number)).to_string(), text, "{code}");
        }
        for (code, text) in [
            (";;;", "P1, which is not shown"),
            ("0;-0;0;\"X\"", "P1, shown as `X`"),
            ("@\" n.i.O.\"", "P1, shown as `P1 n.i.O.`"),
            ("0.00%", "P1"),
        ] {
            assert_eq!(seen(code, Content::of_text("P1")).to_string(), text, "{code}");
        }
        let struck = Style::of_code("General", true).unwrap();
        assert_eq!(struck.seen(Content::of_text("P1")), Content::Unlike("~~P1~~".into()));
        assert_eq!(struck.seen(Content::Other("2026-03-01".into())).to_string(), "~~2026-03-01~~");
        let measured = Content::Measured(Box::new((crate::quantity::Decimal::of_i128(3, 0), "mm".to_owned())));
        assert_eq!(seen("0.0 \"mm\"", Content::of_f64(3.0)), measured);
    }
}
