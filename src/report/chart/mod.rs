//! Results as a picture: lines, bands, bars and limits over two axes, written as SVG.
//!
//! The command line and the examples fill a [`Chart`]; [`Chart::svg`] writes it as a file, and pages have it in their
//! text. Nothing here computes a result. Every colour stands in the elements themselves, so that programs without style
//! sheets show the picture as it is on white paper; browsers turn it dark where the reader's screen is.

mod axis;
mod layer;
mod paint;

pub use axis::{Axis, Scale};
pub use layer::{Bar, Layer, Mark, Shape, Span};
#[cfg(feature = "html")]
pub(super) use paint::dark_style;

use super::escape;
use axis::{Ruler, Tick};
use layer::BESIDE;
use paint::{GRID, INK, PAPER, Paint, SERIES, SOFT, text};

/// A picture over two axes.
#[derive(Debug, Clone)]
pub struct Chart {
    /// The title above the picture, also its name for screen readers.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The layers, the hindmost first.
    pub layers: Vec<Layer>,
    /// Width in pixels of a screen.
    pub width: f64,
    /// Height in these.
    pub height: f64,
    /// Another picture below this one.
    pub below: Option<Box<Self>>,
}

impl Default for Chart {
    fn default() -> Self {
        let (x, y) = (Axis::default(), Axis::default());
        Self { title: String::new(), x, y, layers: Vec::new(), width: 800.0, height: 400.0, below: None }
    }
}

/// Between the picture's edge and what it shows.
const MARGIN: f64 = 12.0;
/// Half a number at the end of the horizontal axis.
const RIGHT: f64 = 32.0;
/// Numbers and name of the horizontal axis.
const BOTTOM: f64 = 50.0;
/// Between numbers, at least.
const X_APART: f64 = 64.0;
const Y_APART: f64 = 36.0;
/// The size of the title.
const HEADING: f64 = 17.0;
/// A line of text.
const LINE: f64 = 22.0;

/// The axes at their places.
struct Plane<'a> {
    x: Ruler<'a>,
    y: Ruler<'a>,
}

/// The legend of the layers, above the axes.
struct Legend {
    svg: String,
    height: f64,
}

impl Chart {
    /// ΔCD along the stroke.
    #[must_use]
    pub fn along_the_stroke(title: &str, layers: Vec<Layer>) -> Self {
        let x = Axis { label: "stroke [mm]".to_owned(), scale: Scale::Tight };
        let y = Axis { label: "ΔCD [mm]".to_owned(), scale: Scale::Airy };
        Self { title: title.to_owned(), x, y, layers, ..Self::default() }
    }

    /// The picture as a file; `None` if nothing extends along both axes.
    #[must_use]
    pub fn svg(&self) -> Option<String> {
        self.drawing("xmlns=\"http://www.w3.org/2000/svg\" ", &format!("<style>{}</style>\n", paint::dark_style()))
    }

    /// The picture within a page that has the style of [`dark_style`](paint::dark_style).
    #[cfg(feature = "html")]
    pub(super) fn inline(&self) -> Option<String> {
        self.drawing("", "")
    }

    /// This picture, and the one below it.
    fn drawing(&self, namespace: &str, style: &str) -> Option<String> {
        let Some(below) = &self.below else { return self.single(namespace, style) };
        let (width, height) = (self.width.max(below.width), self.height + below.height);
        let lower = below.single("", "")?.replacen("<svg ", &format!("<svg y=\"{}\" ", self.height), 1);
        Some(format!(
            "<svg {namespace}class=\"chart\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n{}{lower}</svg>\n",
            self.single("", style)?
        ))
    }

    fn single(&self, namespace: &str, style: &str) -> Option<String> {
        let Self { width, height, .. } = self;
        let legend = self.legend();
        let top = MARGIN + LINE + legend.height + LINE;
        let corners: Vec<_> = self.layers.iter().flat_map(|layer| layer.shape.corners()).collect();
        let y = Ruler::new(&self.y, corners.iter().map(|corner| corner.1), height - BOTTOM, top)?;
        let widest = y.ticks(Y_APART).iter().map(|tick| paint::width(&tick.text)).fold(0.0, f64::max);
        let texts = self.layers.iter().flat_map(|layer| layer.shape.texts()).map(paint::width).fold(0.0, f64::max);
        let right = if texts > 0.0 { f64::max(RIGHT, MARGIN + BESIDE + texts) } else { RIGHT };
        let x = Ruler::new(&self.x, corners.iter().map(|corner| corner.0), MARGIN + widest + 8.0, width - right)?;
        let plane = Plane { x, y };
        let title = paint::fitted(&self.title, (width - 2.0 * MARGIN) * paint::TEXT / HEADING);
        let layers: String = self.painted().map(|(layer, paint)| layer.shape.drawn(paint, &plane)).collect();
        Some(format!(
            "<svg {namespace}class=\"chart\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" role=\"img\" font-family=\"system-ui, 'DejaVu Sans', sans-serif\" \
             font-size=\"{size}\"><title>{whole}</title><desc>{desc}</desc>\n\
             {style}{paper}{heading}{legend}{axes}{layers}</svg>\n",
            size = paint::TEXT,
            whole = escape(&self.title),
            desc = escape(&self.description()),
            paper = PAPER.fill("", &format!("<rect width=\"{width}\" height=\"{height}\"/>")),
            heading = INK.fill(&format!("font-size=\"{HEADING}\""), &text(MARGIN, MARGIN + 15.0, "start", &title)),
            legend = legend.svg,
            axes = self.axes(&plane),
        ))
    }

    /// The picture in words, for screen readers.
    fn description(&self) -> String {
        let shown = self.layers.iter().filter(|layer| layer.is_named()).map(|layer| layer.label.as_str());
        let shown: Vec<_> = shown.collect();
        let shown = if shown.is_empty() { String::new() } else { format!(": {}", shown.join(", ")) };
        format!("{} against {}{shown}", self.y.label, self.x.label)
    }

    /// The layers with the colours that they have if they are curves.
    fn painted(&self) -> impl Iterator<Item = (&Layer, Paint)> {
        let mut colours = SERIES.into_iter().cycle();
        let mut next = SERIES[0];
        self.layers.iter().map(move |layer| {
            if layer.shape.is_series() {
                next = colours.next().unwrap_or(next);
            }
            (layer, next)
        })
    }

    /// The layers that have a name, in as many lines as they take.
    fn legend(&self) -> Legend {
        const SAMPLE: f64 = 30.0;
        let (mut x, mut y, mut svg) = (MARGIN, MARGIN + LINE, String::new());
        for (layer, paint) in self.painted().filter(|(layer, _)| layer.is_named()) {
            let label = paint::fitted(&layer.label, self.width - 2.0 * MARGIN - SAMPLE);
            let width = SAMPLE + paint::width(&label);
            if x > MARGIN && x + width > self.width - MARGIN {
                (x, y) = (MARGIN, y + LINE);
            }
            svg += &layer.shape.sample(paint, x, y + 0.5 * LINE);
            svg += &INK.fill("", &text(x + SAMPLE, y + 16.0, "start", &label));
            x += width + 20.0;
        }
        let height = if svg.is_empty() { 0.0 } else { y - MARGIN };
        Legend { svg, height }
    }

    /// Grid, numbers and names of the axes.
    fn axes(&self, plane: &Plane<'_>) -> String {
        let Plane { x, y } = plane;
        let line = |tick: &Tick, d: &str| {
            let paint = if tick.is_zero { SOFT } else { GRID };
            paint.stroke("", &format!("<path d=\"{d}\"/>"))
        };
        let (mut lines, mut numbers) = (String::new(), String::new());
        for tick in y.ticks(Y_APART) {
            if !matches!(self.y.scale, Scale::Names(_)) {
                lines += &line(&tick, &format!("M{:.1} {:.1}H{:.1}", x.from, tick.at, x.to));
            }
            numbers += &text(x.from - 8.0, tick.at + 5.0, "end", &tick.text);
        }
        for tick in x.ticks(X_APART) {
            lines += &line(&tick, &format!("M{:.1} {:.1}V{:.1}", tick.at, y.from, y.to));
            numbers += &text(tick.at, y.from + 18.0, "middle", &tick.text);
        }
        let names = [
            text(MARGIN, y.to - 9.0, "start", &self.y.label),
            text(0.5 * (x.from + x.to), y.from + 40.0, "middle", &self.x.label),
        ];
        [lines, SOFT.fill("", &numbers), INK.fill("", &names.concat())].concat()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: Vec<(f64, f64)>) -> Chart {
        let ends = [points[0].0, points[points.len() - 1].0];
        let band = ends.map(|x| Span { x, low: 0.0, high: 0.0275 });
        let mark = Mark { x: ends[1], y: 0.027, text: "r4".to_owned() };
        Chart::along_the_stroke(
            "lot 7: α_n <= 20°",
            vec![
                Layer::new("formulas", Shape::Band(band.to_vec())),
                Layer::new("no limits", Shape::Limits(Vec::new())),
                Layer::new("limits", Shape::Limits(vec![-0.03, 0.03])),
                Layer::new("exact mesh", Shape::Line(points)),
                Layer::new("", Shape::Marks(vec![mark])),
            ],
        )
    }

    #[test]
    fn a_curve_stands_among_what_it_is_held_against() {
        let svg = curve(vec![(0.0, 0.0), (10.0, 0.0), (10.5, 0.027), (50.0, 0.027)]).svg().unwrap();
        for part in [
            "<title>lot 7: α_n &lt;= 20°</title>",
            "<desc>ΔCD [mm] against stroke [mm]: formulas, limits, exact mesh</desc>",
            ">stroke [mm]</text>",
            ">limits</text>",
            ">\u{2212}0.02</text>",
            ">r4</text>",
            "prefers-color-scheme:dark",
        ] {
            assert!(svg.contains(part), "{part}: {svg}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("no limits"), "{svg}");
        // the legend, and the two limits
        assert_eq!(svg.matches("class=\"limit\"").count(), 2);
    }

    #[test]
    fn what_has_no_extent_is_no_picture_and_a_level_curve_is_one() {
        assert_eq!(Chart::default().svg(), None);
        assert_eq!(curve(vec![(1.0, 0.0), (1.0, 0.01)]).svg(), None);
        assert!(curve(vec![(0.0, 0.0), (1.0, 0.0)]).svg().is_some());
        let gap = curve(vec![(0.0, f64::NAN), (1.0, 1.0), (2.0, 1.0)]).svg().unwrap();
        assert!(!gap.contains("NaN"), "{gap}");
    }

    #[test]
    fn bars_stand_beside_their_names() {
        let bar =
            |row: f64, left, right, text: &str| Bar { left, right, low: row, high: row + 1.0, text: text.to_owned() };
        let names = vec!["rack over-roller".to_owned(), "rack lead".to_owned()];
        let chart = Chart {
            y: Axis { label: "error".to_owned(), scale: Scale::Names(names) },
            layers: vec![
                Layer::new("free", Shape::Bars(vec![bar(0.0, -0.01, 0.01, "0.01"), bar(1.0, 0.0, 0.012, "0.012")])),
                Layer::new("limits", Shape::LimitsOnX(vec![0.03])),
            ],
            ..Chart::default()
        };
        let svg = chart.svg().unwrap();
        let place = |text: &str| svg.find(&format!(">{text}</text>")).unwrap_or_else(|| panic!("{text}: {svg}"));
        assert!(place("rack over-roller") < place("rack lead") && place("0.01") < place("0.012"));
    }

    #[test]
    fn a_long_title_ends_in_the_picture() {
        let chart = Chart { title: "α".repeat(300), ..curve(vec![(0.0, 0.0), (1.0, 0.0)]) };
        let svg = chart.svg().unwrap();
        assert!(svg.contains("α…</text>") && svg.contains(&format!("<title>{}</title>", "α".repeat(300))));
    }
}
