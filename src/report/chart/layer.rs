//! What a picture shows, and how it is drawn.

use super::Plane;
use super::paint::{BAND, GRID, INK, LIMIT, Paint, SOFT, text};

/// A layer of the picture.
#[derive(Debug, Clone)]
pub struct Layer {
    /// Its name in the legend; empty for none.
    pub label: String,
    /// How it is drawn.
    pub shape: Shape,
}

/// The shape of a layer. Points are x and y; points outside the axes are left out.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A line through points in the order of x.
    Line(Vec<(f64, f64)>),
    /// Single points.
    Dots(Vec<(f64, f64)>),
    /// A line through a few points in any order, and the points.
    Track(Vec<(f64, f64)>),
    /// A wide pale line behind the others.
    Trail(Vec<(f64, f64)>),
    /// The area between a lowest and a highest y.
    Band(Vec<Span>),
    /// Rectangles.
    Bars(Vec<Bar>),
    /// Rectangles side by side, from pale for a share of 0 to strong for one of 1, with their texts in the middle.
    Map(Vec<(Bar, f64)>),
    /// Limits on y.
    Limits(Vec<f64>),
    /// Limits on x.
    LimitsOnX(Vec<f64>),
    /// Points of a line with a few characters each, which stand above the horizontal axis where there is room.
    Marks(Vec<Mark>),
}

/// From a lowest to a highest y.
#[derive(Debug, Clone, Copy)]
pub struct Span {
    /// Where.
    pub x: f64,
    /// The lowest y.
    pub low: f64,
    /// The highest y.
    pub high: f64,
}

/// A rectangle.
#[derive(Debug, Clone)]
pub struct Bar {
    /// Its lowest x.
    pub left: f64,
    /// Its highest x.
    pub right: f64,
    /// Its lowest y.
    pub low: f64,
    /// Its highest y.
    pub high: f64,
    /// At the right of the axes, or in the middle of a cell of a map.
    pub text: String,
}

/// A marked point.
#[derive(Debug, Clone)]
pub struct Mark {
    /// Where.
    pub x: f64,
    /// How high.
    pub y: f64,
    /// A few characters.
    pub text: String,
}

impl Layer {
    /// A shape with what the legend calls it.
    #[must_use]
    pub fn new(label: &str, shape: Shape) -> Self {
        Self { label: label.to_owned(), shape }
    }

    /// Whether it is in the legend.
    pub(super) fn is_named(&self) -> bool {
        !self.label.is_empty() && !self.shape.corners().is_empty()
    }
}

/// Between the axes and the texts at their right.
pub(super) const BESIDE: f64 = 6.0;

/// Points of a line at most: more than the picture has pixels.
const MOST_POINTS: usize = 2000;

impl Shape {
    /// The points that have to lie within the axes; a limit has only one coordinate.
    pub(super) fn corners(&self) -> Vec<(f64, f64)> {
        match self {
            Self::Line(points) | Self::Dots(points) | Self::Track(points) | Self::Trail(points) => points.clone(),
            Self::Band(spans) => spans.iter().flat_map(|span| [(span.x, span.low), (span.x, span.high)]).collect(),
            Self::Bars(bars) => bars.iter().flat_map(|bar| [(bar.left, bar.low), (bar.right, bar.high)]).collect(),
            Self::Map(cells) => {
                cells.iter().flat_map(|(bar, _)| [(bar.left, bar.low), (bar.right, bar.high)]).collect()
            }
            Self::Limits(limits) => limits.iter().map(|limit| (f64::NAN, *limit)).collect(),
            Self::LimitsOnX(limits) => limits.iter().map(|limit| (*limit, f64::NAN)).collect(),
            Self::Marks(marks) => marks.iter().map(|mark| (mark.x, mark.y)).collect(),
        }
    }

    /// The texts at the right of the axes.
    pub(super) fn texts(&self) -> impl Iterator<Item = &str> {
        let bars: &[Bar] = if let Self::Bars(bars) = self { bars } else { &[] };
        bars.iter().map(|bar| bar.text.as_str())
    }

    /// Whether it has a colour of its own among the curves.
    pub(super) const fn is_series(&self) -> bool {
        matches!(self, Self::Line(_) | Self::Dots(_) | Self::Track(_) | Self::Bars(_) | Self::Map(_))
    }

    /// The shape on its axes.
    pub(super) fn drawn(&self, series: Paint, plane: &Plane<'_>) -> String {
        let Plane { x, y } = plane;
        let content = match self {
            Self::Line(points) => path(&plane.places(&thinned(points)), ""),
            Self::Trail(points) => path(&plane.places(points), ""),
            Self::Dots(points) => dots(&plane.places(points)),
            Self::Track(points) => path(&plane.places(points), "") + &dots(&plane.places(points)),
            Self::Band(spans) => {
                let upper = spans.iter().map(|span| (span.x, span.high));
                let lower = spans.iter().rev().map(|span| (span.x, span.low));
                path(&plane.places(&upper.chain(lower).collect::<Vec<_>>()), "Z")
            }
            Self::Bars(bars) => bars.iter().filter_map(|bar| plane.bar(bar)).collect(),
            Self::Map(cells) => cells.iter().filter_map(|(bar, share)| plane.cell(bar, *share)).collect(),
            Self::Limits(limits) => {
                limits.iter().filter_map(|limit| y.at(*limit)).map(|at| line([x.from, at], [x.to, at])).collect()
            }
            Self::LimitsOnX(limits) => {
                limits.iter().filter_map(|limit| x.at(*limit)).map(|at| line([at, y.from], [at, y.to])).collect()
            }
            Self::Marks(marks) => plane.marks(marks),
        };
        self.painted(series, &content)
    }

    /// A sample for the legend, 22 px wide from `x` on.
    pub(super) fn sample(&self, series: Paint, x: f64, y: f64) -> String {
        let middle = [(x + 11.0, y)];
        let content = match self {
            Self::Band(_) | Self::Bars(_) | Self::Map(_) => rectangle([x, y - 6.0], [x + 22.0, y + 6.0]),
            Self::Dots(_) | Self::Marks(_) => dots(&middle),
            Self::Track(_) => line([x, y], [x + 22.0, y]) + &dots(&middle),
            _ => line([x, y], [x + 22.0, y]),
        };
        self.painted(series, &content)
    }

    fn painted(&self, series: Paint, content: &str) -> String {
        match self {
            Self::Line(_) | Self::Track(_) => series.stroke("stroke-width=\"2\" stroke-linejoin=\"round\"", content),
            Self::Trail(_) => GRID.stroke("stroke-width=\"8\"", content),
            Self::Dots(_) | Self::Bars(_) | Self::Map(_) => series.fill("", content),
            Self::Band(_) => BAND.fill("fill-opacity=\".2\" stroke=\"currentColor\" stroke-opacity=\".7\"", content),
            Self::Limits(_) | Self::LimitsOnX(_) => {
                LIMIT.stroke("stroke-width=\"2\" stroke-dasharray=\"7 4\"", content)
            }
            Self::Marks(_) => SOFT.fill("font-size=\"11\"", content),
        }
    }
}

impl Plane<'_> {
    /// Where points lie in the picture, without those that have no place.
    fn places(&self, points: &[(f64, f64)]) -> Vec<(f64, f64)> {
        points.iter().filter_map(|(x, y)| Some((self.x.at(*x)?, self.y.at(*y)?))).collect()
    }

    fn bar(&self, bar: &Bar) -> Option<String> {
        let [left, right] = [self.x.at(bar.left)?, self.x.at(bar.right)?];
        let [low, high] = [self.y.at(bar.low)?, self.y.at(bar.high)?];
        let [top, bottom] = [low.min(high), low.max(high)];
        let words = text(self.x.to + BESIDE, 0.5 * (top + bottom) + 5.0, "start", &bar.text);
        let words = if bar.text.is_empty() { String::new() } else { SOFT.fill("", &words) };
        // neighbours have a line of paper between them
        Some(rectangle([left + 0.5, top], [(right - 0.5).max(left + 1.0), bottom]) + &words)
    }

    fn cell(&self, bar: &Bar, share: f64) -> Option<String> {
        let [left, right] = [self.x.at(bar.left)?, self.x.at(bar.right)?];
        let [bottom, top] = [self.y.at(bar.low)?, self.y.at(bar.high)?];
        // the strongest is still pale enough to be written on
        let opacity = 0.05 + 0.6 * share;
        let cell = rectangle([left, top], [right, bottom]).replacen(
            "<rect",
            &format!("<rect fill-opacity=\"{opacity:.3}\""),
            1,
        );
        let words = text(0.5 * (left + right), 0.5 * (top + bottom) + 5.0, "middle", &bar.text);
        Some(if bar.text.is_empty() { cell } else { cell + &INK.fill("", &words) })
    }

    fn marks(&self, marks: &[Mark]) -> String {
        const ROOM: f64 = 26.0;
        let (mut svg, mut free) = (String::new(), 0.0);
        for mark in marks {
            let [place] = self.places(&[(mark.x, mark.y)])[..] else { continue };
            svg += &dots(&[place]);
            if place.0 >= free {
                free = place.0 + ROOM;
                svg += &text(place.0, self.y.from - 3.0, "middle", &mark.text);
            }
        }
        svg
    }
}

fn path(points: &[(f64, f64)], end: &str) -> String {
    let points: Vec<_> = points.iter().map(|(x, y)| format!("{x:.1} {y:.1}")).collect();
    if points.is_empty() { String::new() } else { format!("<path d=\"M{}{end}\"/>", points.join("L")) }
}

fn line(from: [f64; 2], to: [f64; 2]) -> String {
    path(&[from.into(), to.into()], "")
}

fn dots(points: &[(f64, f64)]) -> String {
    let dot = |(x, y): &(f64, f64)| format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"currentColor\"/>");
    points.iter().map(dot).collect::<Vec<_>>().concat()
}

fn rectangle([left, top]: [f64; 2], [right, bottom]: [f64; 2]) -> String {
    let (width, height) = (right - left, bottom - top);
    format!("<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\"/>")
}

/// A line of no more points than can be seen, its extremes kept.
fn thinned(line: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if line.len() <= MOST_POINTS {
        return line.to_vec();
    }
    let size = line.len().div_ceil(MOST_POINTS / 2);
    let mut points = Vec::with_capacity(MOST_POINTS);
    for group in line.chunks(size) {
        let lowest = group.iter().copied().reduce(|a, b| if b.1 < a.1 { b } else { a });
        let highest = group.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a });
        if let (Some(lowest), Some(highest)) = (lowest, highest) {
            if lowest.0 <= highest.0 { points.extend([lowest, highest]) } else { points.extend([highest, lowest]) }
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_extremes() {
        let mut line: Vec<(f64, f64)> = (0..100_000).map(|x| (f64::from(x), 0.0)).collect();
        line[77_777].1 = 3.0;
        line[5].1 = -2.0;
        let thin = thinned(&line);
        assert!(thin.len() <= MOST_POINTS + 2);
        assert!(thin.contains(&(77_777.0, 3.0)) && thin.contains(&(5.0, -2.0)));
        assert!(thin.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    }
}
