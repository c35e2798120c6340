//! Colours, and the elements of the picture in them.

use crate::report::escape;

/// A colour on white paper and on a dark screen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Paint {
    class: &'static str,
    light: &'static str,
    dark: &'static str,
}

const fn paint(class: &'static str, light: &'static str, dark: &'static str) -> Paint {
    Paint { class, light, dark }
}

pub(super) const PAPER: Paint = paint("paper", "#ffffff", "#12171e");
pub(super) const GRID: Paint = paint("grid", "#d5dbe3", "#384352");
pub(super) const SOFT: Paint = paint("soft", "#5b6675", "#9aa6b5");
pub(super) const INK: Paint = paint("ink", "#1d2530", "#e6eaf0");
pub(super) const BAND: Paint = paint("band", "#de9220", "#e6aa4e");
pub(super) const LIMIT: Paint = paint("limit", "#be2828", "#ff7b72");
/// Colours of curves, which differ in darkness for print without colour and for colour-blind readers.
pub(super) const SERIES: [Paint; 8] = [
    paint("s0", "#1254a0", "#6fb1ff"),
    paint("s1", "#c8501e", "#ff9a66"),
    paint("s2", "#1e825a", "#5cd6a4"),
    paint("s3", "#783c96", "#c792ea"),
    paint("s4", "#967814", "#e0c050"),
    paint("s5", "#5a5a5a", "#b0b0b0"),
    paint("s6", "#0a8ca0", "#4fd4e6"),
    paint("s7", "#c8328c", "#ff8fc7"),
];

/// The size of all text but the title, px.
pub(super) const TEXT: f64 = 14.0;

impl Paint {
    /// Areas and text in this colour.
    pub(super) fn fill(self, attributes: &str, content: &str) -> String {
        self.group(&format!("fill=\"currentColor\" {attributes}"), content)
    }

    /// Lines in this colour.
    pub(super) fn stroke(self, attributes: &str, content: &str) -> String {
        self.group(&format!("fill=\"none\" stroke=\"currentColor\" {attributes}"), content)
    }

    fn group(self, attributes: &str, content: &str) -> String {
        let Self { class, light, .. } = self;
        if content.is_empty() {
            return String::new();
        }
        format!("<g class=\"{class}\" color=\"{light}\" {}>{content}</g>\n", attributes.trim_end())
    }
}

/// The style that turns charts dark on a dark screen; print stays light.
pub(crate) fn dark_style() -> String {
    let paints = [PAPER, GRID, SOFT, INK, BAND, LIMIT].into_iter().chain(SERIES);
    let rules: Vec<_> = paints.map(|paint| format!(".chart .{}{{color:{}}}", paint.class, paint.dark)).collect();
    format!("@media screen and (prefers-color-scheme:dark){{{}}}", rules.concat())
}

/// A line of text that begins, has its middle or ends at x (`start`, `middle`, `end`).
pub(super) fn text(x: f64, y: f64, anchor: &str, text: &str) -> String {
    format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>", escape(text))
}

/// As much of a text as there is room for, px.
pub(super) fn fitted(text: &str, room: f64) -> String {
    if width(text) <= room {
        return text.to_owned();
    }
    let kept = (room / width("…")) as usize;
    text.chars().take(kept.saturating_sub(1)).chain(['…']).collect()
}

/// About how wide a text is in the wider of the usual fonts, px.
pub(super) fn width(text: &str) -> f64 {
    0.62 * TEXT * text.chars().count() as f64
}
