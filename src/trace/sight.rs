//! For a search: the weighted differences between measured and computed curve at some strokes, without the parts that an
//! offset and a stroke shift explain; and the effect of a tooth's error there, by its size.

use std::ops::Range;

use crate::linear::{LeastSquares, least_squares};

/// The differences between measured and computed curve at some strokes.
pub(super) struct Sight {
    /// The strokes on the mesh, mm.
    pub(super) strokes_mm: Vec<f64>,
    /// The computed curve there, mm.
    pub(super) model_mm: Vec<f64>,
    /// Measured less computed, mm.
    rest_mm: Vec<f64>,
    /// The weight 1/σ² of each, 1/mm².
    weights: Vec<f64>,
    /// The columns that are fitted beside an error: a constant, slopes of the curve, effects of other errors.
    beside: Vec<Vec<f64>>,
    inverse: Vec<Vec<f64>>,
    /// The coefficient of each column in the fit to the differences; 0 for a dependent column.
    steps: Vec<f64>,
}

impl Sight {
    /// `beside` are the columns that are fitted beside an error, the most important first; linearly dependent ones are left out.
    pub(super) fn new(
        (strokes_mm, model_mm): (Vec<f64>, Vec<f64>),
        measured_mm: &[f64],
        weights: Vec<f64>,
        beside: &[Vec<f64>],
    ) -> Self {
        let rest_mm = measured_mm.iter().zip(&model_mm).map(|(measured, model)| measured - model).collect();
        let steps = vec![0.0; beside.len()];
        let mut sight = Self { strokes_mm, model_mm, rest_mm, weights, beside: Vec::new(), inverse: Vec::new(), steps };
        let (kept, fit) = sight.fitted(beside);
        if let Some(fit) = fit {
            kept.iter().zip(&fit.coefficients).for_each(|(at, step)| sight.steps[*at] = *step);
            sight.inverse = fit.inverse;
        }
        sight.beside = kept.into_iter().map(|at| beside[at].clone()).collect();
        sight
    }

    /// The strokes and the computed curve there, mm.
    pub(super) fn curve(&self) -> (&[f64], &[f64]) {
        (&self.strokes_mm, &self.model_mm)
    }

    /// The number of columns, dependent ones included.
    pub(super) fn columns(&self) -> usize {
        self.steps.len()
    }

    /// The coefficient of a column in the fit to the differences.
    pub(super) fn step(&self, column: usize) -> f64 {
        self.steps.get(column).copied().unwrap_or(0.0)
    }

    /// The linearly independent columns, and their fit to the differences.
    fn fitted(&self, columns: &[Vec<f64>]) -> (Vec<usize>, Option<LeastSquares>) {
        let (mut kept, mut fit) = (Vec::new(), None);
        for at in 0..columns.len() {
            kept.push(at);
            let chosen: Vec<&[f64]> = kept.iter().map(|at: &usize| columns[*at].as_slice()).collect();
            match least_squares(&chosen, &self.weights, &self.rest_mm) {
                Some(found) => fit = Some(found),
                None => drop(kept.pop()),
            }
        }
        (kept, fit)
    }

    /// A curve that is 0 outside a span of strokes.
    fn curve_within<'c>(&self, mm: &'c [f64], span: &Range<usize>) -> Curve<'c> {
        let of_columns = self.beside.iter().map(|column| self.product(column, mm, span)).collect();
        Curve { mm, span: span.clone(), of_columns }
    }

    fn curve_of<'c>(&self, mm: &'c [f64]) -> Curve<'c> {
        self.curve_within(mm, &(0..mm.len()))
    }

    /// The weighted product of two curves over a span of strokes.
    fn product(&self, a: &[f64], b: &[f64], span: &Range<usize>) -> f64 {
        let [a, b, weights] = [a, b, &self.weights].map(|of| of.get(span.clone()).unwrap_or_default());
        let weighted = a.iter().zip(b).zip(weights);
        weighted.map(|((a, b), w)| w * a * b).sum()
    }

    /// The weighted product of two curves, without the parts that the columns beside explain.
    fn inner(&self, a: &Curve<'_>, b: &Curve<'_>) -> f64 {
        let span = a.span.start.max(b.span.start)..a.span.end.min(b.span.end);
        let by = |row: &[f64]| row.iter().zip(&b.of_columns).map(|(entry, b)| entry * b).sum::<f64>();
        let explained = self.inverse.iter().zip(&a.of_columns).map(|(row, a)| a * by(row)).sum::<f64>();
        self.product(a.mm, b.mm, &span) - explained
    }

    fn square(&self, mm: &[f64]) -> f64 {
        let curve = self.curve_of(mm);
        self.inner(&curve, &curve)
    }

    /// Largest less smallest difference, mm.
    pub(super) fn largest_mm(&self) -> f64 {
        let ends = self.rest_mm.iter().fold((0.0_f64, 0.0_f64), |(low, high), mm| (low.min(*mm), high.max(*mm)));
        ends.1 - ends.0
    }

    /// χ² of the differences.
    pub(super) fn chi_square(&self) -> f64 {
        self.square(&self.rest_mm)
    }

    /// χ² of an effect: how clearly it shows.
    pub(super) fn visible(&self, effect: &[f64]) -> f64 {
        self.square(effect)
    }
}

/// A curve in mm that is 0 outside a span of strokes, with its weighted product with each column of a sight.
struct Curve<'c> {
    mm: &'c [f64],
    span: Range<usize>,
    of_columns: Vec<f64>,
}

/// Sizes that differ by less than this are the same: 0.02 µm.
const SAME_MM: f64 = 2e-5;

/// The effect of a tooth's error at the strokes of a sight, for several sizes; linear between them, because the mesh is the
/// highest of several straight lines.
#[derive(Debug, Clone)]
pub(super) struct Effects(Vec<(f64, Vec<f64>)>);

/// A size of an error, and its gain: the amount by which it lowers χ².
#[derive(Debug, Clone, Copy)]
pub(super) struct Explains {
    pub(super) size_mm: f64,
    pub(super) gain: f64,
}

impl Effects {
    /// The effect of an error of size 0.
    pub(super) fn none(sight: &Sight) -> Self {
        Self(vec![(0.0, vec![0.0; sight.strokes_mm.len()])])
    }

    /// The strokes outside which every effect is 0.
    fn span(&self) -> Range<usize> {
        let acting = self.0.iter().filter_map(|(_, effect)| {
            let acts = |mm: &f64| *mm != 0.0;
            Some((effect.iter().position(acts)?, effect.iter().rposition(acts)? + 1))
        });
        let span = acting.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        span.map_or(0..0, |(from, to)| from..to)
    }

    pub(super) fn insert(&mut self, size_mm: f64, effect: Vec<f64>) {
        let at = self.0.partition_point(|(size, _)| *size < size_mm);
        self.0.insert(at, (size_mm, effect));
    }

    /// The effect of a size that was solved.
    pub(super) fn at(&self, size_mm: f64) -> Option<&[f64]> {
        self.0.iter().find(|(size, _)| (size - size_mm).abs() < 1e-12).map(|(_, effect)| effect.as_slice())
    }

    /// A size and the solved sizes next to it that have its sign.
    pub(super) fn around(&self, size_mm: f64) -> Vec<f64> {
        let at = self.0.partition_point(|(size, _)| *size < size_mm - 1e-12);
        let near = self.0[at.saturating_sub(1)..(at + 2).min(self.0.len())].iter().map(|(size, _)| *size);
        near.filter(|size| size * size_mm > 0.0).chain([size_mm]).collect()
    }

    /// The size half way from a solved one to the next solved one towards 0.
    pub(super) fn half_way_in(&self, size_mm: f64) -> Option<f64> {
        let at = self.0.iter().position(|(size, _)| (size - size_mm).abs() < SAME_MM)?;
        let next = if size_mm < 0.0 { at + 1 } else { at.checked_sub(1)? };
        Some(0.5 * (size_mm + self.0.get(next)?.0))
    }

    /// If a size is the outermost solved one: a size one step beyond it.
    pub(super) fn beyond(&self, size_mm: f64) -> Option<f64> {
        let size = |at: usize| self.0.get(at).map(|(size, _)| *size);
        let count = self.0.len();
        [(Some(0), Some(1)), (count.checked_sub(1), count.checked_sub(2))].into_iter().find_map(|(end, before)| {
            let (end, before) = (size(end?)?, size(before?)?);
            (end != 0.0 && (end - size_mm).abs() < 1e-12).then_some(end + (end - before))
        })
    }

    /// Whether a size is solved, or near a solved one.
    pub(super) fn has(&self, size_mm: f64) -> bool {
        self.0.iter().any(|(size, _)| (size - size_mm).abs() < SAME_MM)
    }

    /// The size that explains most.
    pub(super) fn best(&self, sight: &Sight) -> Explains {
        let [negative, positive] = self.best_of_each_sign(sight);
        if negative.gain > positive.gain { negative } else { positive }
    }

    /// The negative size that explains most, and the positive one.
    pub(super) fn best_of_each_sign(&self, sight: &Sight) -> [Explains; 2] {
        [true, false].map(|is_negative| {
            let is_of_sign = |size: f64| if is_negative { size <= 0.0 } else { size >= 0.0 };
            self.best_within(sight, is_of_sign)
        })
    }

    /// The size that explains most between neighbouring solved sizes for which `is_tried` holds.
    fn best_within<'s>(&'s self, sight: &Sight, is_tried: impl Fn(f64) -> bool) -> Explains {
        let mut best = Explains { size_mm: 0.0, gain: 0.0 };
        let (span, rest) = (self.span(), sight.curve_of(&sight.rest_mm));
        let tried = self.0.iter().filter(|(size, _)| is_tried(*size));
        let of = |(size, effect): &'s (f64, Vec<f64>)| {
            let curve = sight.curve_within(effect, &span);
            (*size, sight.inner(&rest, &curve), sight.inner(&curve, &curve), curve)
        };
        let tried: Vec<_> = tried.map(of).collect();
        for (from, to) in tried.iter().zip(tried.iter().skip(1)) {
            let both = sight.inner(&from.3, &to.3);
            let left = to.1 - from.1 - both + from.2;
            let square = to.2 - 2.0 * both + from.2;
            let share = if square > 0.0 { (left / square).clamp(0.0, 1.0) } else { 0.0 };
            let gain = 2.0 * from.1 - from.2 + share * (2.0 * left - share * square);
            if gain > best.gain {
                best = Explains { size_mm: from.0 + share * (to.0 - from.0), gain };
            }
        }
        best
    }

    /// The effect of a size; effects are linear between solved sizes.
    pub(super) fn of(&self, size_mm: f64) -> Vec<f64> {
        let at = self.0.partition_point(|(size, _)| *size < size_mm).clamp(1, self.0.len().max(2) - 1);
        let (Some((from, a)), Some((to, b))) = (self.0.get(at - 1), self.0.get(at)) else {
            return self.0.first().map_or_else(Vec::new, |(_, effect)| effect.clone());
        };
        let share = (size_mm - from) / (to - from);
        a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect()
    }

    /// The amount by which a size lowers χ².
    pub(super) fn gain(&self, sight: &Sight, size_mm: f64) -> f64 {
        let rest = sight.rest_mm.iter().zip(self.of(size_mm)).map(|(rest, effect)| rest - effect);
        let rest: Vec<f64> = rest.collect();
        sight.chi_square() - sight.square(&rest)
    }

    /// The effects at other strokes, where `moved` finds a curve that is known at those of the sight.
    pub(super) fn moved(&self, moved: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        Self(self.0.iter().map(|(size, effect)| (*size, moved(effect))).collect())
    }
}
