//! Pictures of a page: inline SVG whose colours are the page's own, so that they follow light, dark and print.

use super::escape;

/// A picture with numbers on both axes.
#[derive(Debug, Clone, Default)]
pub struct Chart {
    /// What it shows, in a sentence: for the caption, and for those who do not see it.
    pub caption: String,
    /// The name of each axis with its unit.
    pub axes: (String, String),
    /// Lines: x and y in the order of x.
    pub lines: Vec<Vec<(f64, f64)>>,
    /// A band from one y to another.
    pub band: Option<(f64, f64)>,
    /// Areas between a lowest and a highest y: x, low, high.
    pub range: Vec<(f64, f64, f64)>,
    /// Bars that stand on 0: from x, to x, height.
    pub bars: Vec<(f64, f64, f64)>,
    /// Limits: on y, or on x where there are bars.
    pub limits: Vec<f64>,
    /// Whether the x axis counts.
    pub counts: bool,
}

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 364.0;
/// Left, right, top, bottom: room for the largest letters, those of a phone.
const MARGIN: (f64, f64, f64, f64) = (76.0, 16.0, 30.0, 64.0);
/// Points of a line at most: more than the picture has pixels.
const MOST_POINTS: usize = 2000;

struct Scale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Scale {
    fn at(&self, value: f64) -> f64 {
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Round numbers in the range, about `count` of them, and their decimals.
    fn ticks(&self, count: f64) -> (Vec<f64>, usize) {
        let rough = (self.high - self.low) / count;
        let power = libm::floor(libm::log10(rough));
        let unit = libm::exp10(power);
        let step = unit * [1.0, 2.0, 5.0, 10.0].into_iter().find(|step| step * unit >= rough).unwrap_or(10.0);
        let first = libm::ceil(self.low / step);
        // a handful: the range over a step of its size
        let total = (libm::floor(self.high / step) - first).clamp(0.0, 100.0) as u32;
        let ticks = (0..=total).map(|index| (first + f64::from(index)) * step).collect();
        let decimals = -libm::floor(libm::log10(step) + 1e-9);
        (ticks, decimals.clamp(0.0, 12.0) as usize)
    }
}

fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.filter(|value| value.is_finite()).map(|value| (value, value)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

impl Chart {
    /// The picture with its caption; nothing if there is nothing to draw.
    pub(super) fn html(&self) -> String {
        let Some((x, y)) = self.scales() else { return String::new() };
        let (left, right, top, bottom) = (MARGIN.0, WIDTH - MARGIN.1, MARGIN.2, HEIGHT - MARGIN.3);
        let mut svg =
            format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">", escape(&self.caption));
        let (ticks, decimals) = y.ticks(6.0);
        // parts are counted in whole numbers
        let decimals = if self.bars.is_empty() { decimals } else { 0 };
        for tick in ticks.into_iter().filter(|tick| self.bars.is_empty() || tick.fract() == 0.0) {
            let at = y.at(tick);
            svg += &format!("<path class=\"g\" d=\"M{left} {at:.1}H{right}\"/>");
            svg += &format!(
                "<text class=\"t\" x=\"{:.1}\" y=\"{at:.1}\" dy=\".35em\" text-anchor=\"end\">{}</text>",
                left - 8.0,
                number(tick, decimals)
            );
        }
        let (ticks, decimals) = x.ticks(9.0);
        for tick in ticks.into_iter().filter(|tick| !self.counts || *tick >= 1.0) {
            // a number at the edge stays in the picture
            let anchor = if x.at(tick) > right - 24.0 { "end" } else { "middle" };
            // below the axis by its own height, however large the letters are
            svg += &format!(
                "<text class=\"t\" x=\"{:.1}\" y=\"{:.1}\" dy=\".8em\" text-anchor=\"{anchor}\">{}</text>",
                x.at(tick),
                bottom + 8.0,
                number(tick, decimals)
            );
        }
        svg += &format!("<path class=\"g\" d=\"M{left} {top}V{bottom}H{right}\"/>");
        svg += &format!("<text x=\"{left}\" y=\"{:.1}\">{}</text>", top - 8.0, escape(&self.axes.1));
        svg += &format!(
            "<text x=\"{right}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            HEIGHT - 8.0,
            escape(&self.axes.0)
        );
        if let Some((low, high)) = self.band {
            let (above, below) = (y.at(high), y.at(low));
            svg += &format!(
                "<rect class=\"b\" x=\"{left}\" y=\"{above:.2}\" width=\"{}\" height=\"{:.2}\"/>",
                right - left,
                (below - above).max(1.0)
            );
        }
        for (from, to, height) in &self.bars {
            let (a, b, above) = (x.at(*from), x.at(*to), y.at(*height));
            svg += &format!(
                "<rect class=\"h\" x=\"{:.2}\" y=\"{above:.2}\" width=\"{:.2}\" height=\"{:.2}\"/>",
                a + 0.5,
                (b - a - 1.0).max(0.5),
                (bottom - above).max(0.0)
            );
        }
        if !self.range.is_empty() {
            let upper = self.range.iter().map(|(at, _, high)| format!("{:.1} {:.1}", x.at(*at), y.at(*high)));
            let lower = self.range.iter().rev().map(|(at, low, _)| format!("{:.1} {:.1}", x.at(*at), y.at(*low)));
            svg += &format!("<path class=\"b\" d=\"M{}Z\"/>", upper.chain(lower).collect::<Vec<_>>().join("L"));
        }
        for line in &self.lines {
            let points = thinned(line).into_iter().map(|(a, b)| format!("{:.1} {:.1}", x.at(a), y.at(b)));
            svg += &format!("<path class=\"c\" d=\"M{}\"/>", points.collect::<Vec<_>>().join("L"));
        }
        for limit in &self.limits {
            svg += &if self.bars.is_empty() {
                format!("<path class=\"l\" d=\"M{left} {:.1}H{right}\"/>", y.at(*limit))
            } else {
                format!("<path class=\"l\" d=\"M{:.1} {top}V{bottom}\"/>", x.at(*limit))
            };
        }
        format!("<figure>{svg}</svg><figcaption>{}</figcaption></figure>\n", escape(&self.caption))
    }

    fn scales(&self) -> Option<(Scale, Scale)> {
        let line = || self.lines.iter().flatten();
        let xs = line().map(|point| point.0).chain(self.bars.iter().flat_map(|bar| [bar.0, bar.1]));
        let xs = xs.chain(self.range.iter().map(|range| range.0));
        let on_x = |limit: &&f64| !self.bars.is_empty() && limit.is_finite();
        let (x_low, x_high) = extent(xs.chain(self.limits.iter().filter(on_x).copied()))?;
        let ys = line().map(|point| point.1).chain(self.band.into_iter().flat_map(|(low, high)| [low, high]));
        let ys = ys.chain(self.range.iter().flat_map(|range| [range.1, range.2]));
        let ys = ys.chain(self.bars.iter().flat_map(|bar| [0.0, bar.2]));
        let (y_low, y_high) = extent(ys.chain(self.limits.iter().filter(|limit| !on_x(limit)).copied()))?;
        let air = if self.bars.is_empty() { ((y_high - y_low) * 0.08).max(0.000_5) } else { 0.0 };
        let wide = if x_high > x_low { (x_low, x_high) } else { (x_low - 0.5, x_high + 0.5) };
        // a limit at the edge is seen, too
        let side = if self.bars.is_empty() { 0.0 } else { (wide.1 - wide.0) * 0.02 };
        let high = if y_high > y_low || air > 0.0 { y_high + air } else { y_low + 1.0 };
        Some((
            Scale { low: wide.0 - side, high: wide.1 + side, from: MARGIN.0, to: WIDTH - MARGIN.1 },
            Scale { low: y_low - air, high, from: HEIGHT - MARGIN.3, to: MARGIN.2 },
        ))
    }
}

fn number(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    // -0 says nothing
    if text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.')) {
        text.trim_start_matches('-').to_owned()
    } else {
        text.replace('-', "\u{2212}")
    }
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
    fn nothing_to_draw_is_nothing_and_a_point_is_no_failure() {
        assert_eq!(Chart::default().html(), "");
        let level = Chart { lines: vec![vec![(1.0, 0.0)]], ..Chart::default() };
        assert!(!level.html().contains("NaN") && level.html().contains("<svg"));
        let wild = Chart { lines: vec![vec![(0.0, f64::NAN), (1.0, 1.0)]], limits: vec![-0.5], ..Chart::default() };
        assert!(wild.html().contains("class=\"l\""));
    }

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

    #[test]
    fn ticks_are_round() {
        let scale = Scale { low: -0.031, high: 0.052, from: 0.0, to: 1.0 };
        let (ticks, decimals) = scale.ticks(6.0);
        assert_eq!(
            ticks.iter().map(|tick| number(*tick, decimals)).collect::<Vec<_>>(),
            ["\u{2212}0.02", "0.00", "0.02", "0.04"]
        );
    }
}
