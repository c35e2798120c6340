//! An axis: what it spans, where its round numbers lie, and where a value lies in the picture.

/// The content of an axis.
#[derive(Debug, Clone, Default)]
pub struct Axis {
    /// Its name with the unit.
    pub label: String,
    /// How values are laid out along it.
    pub scale: Scale,
}

/// How values are laid out along an axis.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Scale {
    /// From the lowest to the highest value.
    Tight,
    /// With a margin around them; equal values lie in a window of 1 µm.
    #[default]
    Airy,
    /// As [`Scale::Tight`], with whole numbers at the ticks.
    Whole,
    /// Whole decades; values that are not positive are left out.
    Logarithmic,
    /// A name for each unit: the first from 0 to 1, the next from 1 to 2. Down a vertical axis.
    Names(Vec<String>),
}

/// A tick: where, and what is written there.
pub(super) struct Tick {
    /// In the picture.
    pub(super) at: f64,
    pub(super) text: String,
    /// The line of 0 stands out.
    pub(super) is_zero: bool,
}

/// An axis at its place in the picture.
pub(super) struct Ruler<'a> {
    scale: &'a Scale,
    /// Exponents of ten on a logarithmic axis.
    low: f64,
    high: f64,
    /// Where these two lie.
    pub(super) from: f64,
    pub(super) to: f64,
}

impl<'a> Ruler<'a> {
    /// The axis around `values`, from one place to another; `None` if they leave nothing to show.
    pub(super) fn new(axis: &'a Axis, values: impl Iterator<Item = f64>, from: f64, to: f64) -> Option<Self> {
        let scale = &axis.scale;
        let shown = values.filter_map(|value| on(scale, value));
        let extent = shown.map(|value| (value, value)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let (low, high) = match scale {
            Scale::Tight | Scale::Whole => extent?,
            Scale::Airy => {
                let (low, high) = extent?;
                let air = ((high - low) * 0.08).max(0.000_5);
                (low - air, high + air)
            }
            Scale::Logarithmic => {
                let (low, high) = extent?;
                let low = libm::floor(low);
                (low, libm::ceil(high).max(low + 1.0))
            }
            Scale::Names(names) => (names.len() as f64, 0.0),
        };
        (low != high && (high - low).is_finite()).then_some(Self { scale, low, high, from, to })
    }

    /// Where a value lies; `None` if it cannot be shown.
    pub(super) fn at(&self, value: f64) -> Option<f64> {
        on(self.scale, value).map(|value| self.place(value))
    }

    fn place(&self, value: f64) -> f64 {
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Names, or round numbers at least `apart` from each other in the picture.
    pub(super) fn ticks(&self, apart: f64) -> Vec<Tick> {
        if let Scale::Names(names) = self.scale {
            let middle = |index: usize| self.place(index as f64 + 0.5);
            let tick = |(index, name): (usize, &String)| Tick { at: middle(index), text: name.clone(), is_zero: false };
            return names.iter().enumerate().map(tick).collect();
        }
        let rough = (self.high - self.low) * apart / (self.to - self.from).abs();
        let decade = libm::exp10(libm::floor(libm::log10(rough)));
        let step = [1.0, 2.0, 5.0].into_iter().map(|n| n * decade).find(|step| *step >= rough).unwrap_or(10.0 * decade);
        let step = if matches!(self.scale, Scale::Whole | Scale::Logarithmic) { step.max(1.0) } else { step };
        let decimals = (-libm::floor(libm::log10(step) + 1e-9)).clamp(0.0, 12.0) as usize;
        let (first, last) = (libm::ceil(self.low / step - 1e-9), libm::floor(self.high / step + 1e-9));
        (0..=(last - first).clamp(0.0, 100.0) as u32)
            .map(|index| (first + f64::from(index)) * step)
            .map(|value| Tick {
                at: self.place(value),
                text: if *self.scale == Scale::Logarithmic { format!("1e{value}") } else { number(value, decimals) },
                is_zero: value == 0.0 && *self.scale != Scale::Logarithmic,
            })
            .collect()
    }
}

/// A value as it is laid out on a scale; `None` if it cannot be.
fn on(scale: &Scale, value: f64) -> Option<f64> {
    let value = if *scale == Scale::Logarithmic { libm::log10(value) } else { value };
    value.is_finite().then_some(value)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(scale: Scale, values: [f64; 2], apart: f64) -> Vec<String> {
        let axis = Axis { scale, ..Axis::default() };
        let ruler = Ruler::new(&axis, values.into_iter(), 0.0, 100.0).unwrap();
        ruler.ticks(apart).into_iter().map(|tick| tick.text).collect()
    }

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(texts(Scale::Tight, [-0.031, 0.052], 17.0), ["\u{2212}0.02", "0.00", "0.02", "0.04"]);
        assert_eq!(texts(Scale::Tight, [0.0, 0.06], 30.0), ["0.00", "0.02", "0.04", "0.06"]);
        assert_eq!(texts(Scale::Airy, [0.01, 0.01], 40.0), ["0.0095", "0.0100", "0.0105"]);
        assert_eq!(texts(Scale::Whole, [1.0, 3.0], 10.0), ["1", "2", "3"]);
        assert_eq!(texts(Scale::Logarithmic, [2e-4, 0.5], 20.0), ["1e-4", "1e-3", "1e-2", "1e-1", "1e0"]);
        assert_eq!(texts(Scale::Logarithmic, [0.0, 1.0], 20.0), ["1e0", "1e1"]);
        for values in [[0.0, 1e-12], [1e9, 1e9 + 3.0], [-7e20, 8e20]] {
            let ticks = texts(Scale::Tight, values, 11.0);
            assert!((2..=10).contains(&ticks.len()), "{ticks:?}");
        }
    }

    #[test]
    fn what_has_no_extent_is_not_shown() {
        for (scale, values) in [
            (Scale::Tight, [1.0, 1.0]),
            (Scale::Tight, [f64::NAN, 1.0]),
            (Scale::Tight, [-1e308, 1e308]),
            (Scale::Airy, [f64::INFINITY, f64::NAN]),
            (Scale::Logarithmic, [0.0, -1.0]),
            (Scale::Names(Vec::new()), [0.0, 1.0]),
        ] {
            let axis = Axis { scale, ..Axis::default() };
            assert!(Ruler::new(&axis, values.into_iter(), 0.0, 1.0).is_none(), "{axis:?}");
        }
    }
}
