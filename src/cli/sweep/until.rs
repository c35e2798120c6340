//! `--until NAME=VALUE`: where along the values of a key a result is reached.

use super::Tally;
use crate::design::Axis;
use crate::diagnostic::{Code, Diagnostic};

/// A result and its target value.
#[derive(Debug, Clone)]
pub(super) struct Until {
    pub(super) name: String,
    pub(super) value: f64,
}

/// Reads `NAME=VALUE`.
pub(super) fn parse(text: &str) -> Result<Until, String> {
    let parsed = text.split_once('=').and_then(|(name, value)| {
        let value: f64 = value.trim().parse().ok().filter(|value: &f64| value.is_finite())?;
        Some(Until { name: name.trim().to_owned(), value })
    });
    parsed.ok_or_else(|| "write NAME=VALUE, such as range_upper_mm=0.05".to_owned())
}

impl Until {
    /// The remark on where the result is reached.
    pub(super) fn in_words(&self, axis: &Axis, crossing: &Crossing) -> String {
        let Self { name, value } = self;
        let (key, at) = (&axis.key, axis.at(crossing.at).text);
        match crossing.jump {
            None => format!("{name} is {value} at {key} = {at}"),
            Some((before, after)) => {
                format!("{name} jumps over {value} at {key} = {at}: from {:.6} to {:.6}", value + before, value + after)
            }
        }
    }

    /// The message that the result is not reached by these designs, with its values and why designs have none.
    pub(super) fn never_reached(&self, over: &str, Tally { values, impossible, why, .. }: &Tally) -> Diagnostic {
        let message = format!("{} does not come to {} over {over}", self.name, self.value);
        let ends = values.iter().flatten().map(|value| (*value, *value));
        let mut help = match ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) {
            Some((low, high)) if low < high => format!("it is from {low} to {high} there"),
            Some((value, _)) => format!("it is {value} there"),
            None => "no design has that result".to_owned(),
        };
        if let Some(why) = why {
            let designs = if values.len() == 1 { "design has" } else { "designs have" };
            help.push_str(&format!("; {impossible} of {} {designs} no answer; the first: {why}", values.len()));
        }
        Diagnostic::warning(Code::NoResult, message).help(help)
    }
}

/// A value of the key at which the result is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    pub(super) at: f64,
    /// The differences from the target on both sides, where the result jumps over it.
    pub(super) jump: Option<(f64, f64)>,
}

/// A value of the key, and the difference of the result from the target.
type Point = (f64, f64);

/// Every crossing between neighbours with results on either side of the target. `off_at` gives the difference between them; it is
/// `None` for keys with whole numbers, for which the first value behind the crossing is returned.
pub(super) fn crossings(points: &[(f64, Option<f64>)], off_at: Option<&dyn Fn(f64) -> Option<f64>>) -> Vec<Crossing> {
    let mut found = Vec::new();
    for (index, (at, off)) in points.iter().enumerate() {
        if *off == Some(0.0) {
            found.push(Crossing { at: *at, jump: None });
        }
        let next = points.get(index + 1).and_then(|(at, off)| Some((*at, (*off)?)));
        let (Some(off), Some(next)) = (*off, next) else { continue };
        if off * next.1 < 0.0 {
            found.extend(match off_at {
                Some(off_at) => between((*at, off), next, off_at),
                None => Some(Crossing { at: next.0, jump: Some((off, next.1)) }),
            });
        }
    }
    found
}

/// The crossing between two values, by secant and halving in turn, so that a jump is found as fast; `None` where the result ends
/// between them.
fn between(mut a: Point, mut b: Point, off_at: &dyn Fn(f64) -> Option<f64>) -> Option<Crossing> {
    const MOST_STEPS: usize = 90;
    /// Of the range between the first two values, and of the larger difference there.
    const CLOSE: f64 = 1e-9;
    const MET: f64 = 1e-6;
    let (width, scale) = (b.0 - a.0, a.1.abs().max(b.1.abs()));
    let nearer = |a: Point, b: Point| if a.1.abs() <= b.1.abs() { a } else { b };
    for step in 0..MOST_STEPS {
        if b.0 - a.0 <= CLOSE * width || nearer(a, b).1.abs() <= CLOSE * scale {
            break;
        }
        let secant = a.0 - a.1 * (b.0 - a.0) / (b.1 - a.1);
        let middle = if step % 2 == 0 { secant } else { 0.5 * (a.0 + b.0) };
        let point = (middle, off_at(middle)?);
        if point.1 * a.1 > 0.0 { a = point } else { b = point }
    }
    let best = nearer(a, b);
    Some(Crossing { at: best.0, jump: (best.1.abs() > MET * scale).then_some((a.1, b.1)) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(of: impl Fn(f64) -> Option<f64>, steps: usize) -> Vec<Crossing> {
        let points: Vec<_> = (0..=steps).map(|step| step as f64 / steps as f64).map(|at| (at, of(at))).collect();
        crossings(&points, Some(&of))
    }

    #[test]
    fn every_crossing_is_found_and_a_jump_is_called_one() {
        let of = |at: f64| Some(crate::trig::sin(3.0 * std::f64::consts::PI * at) - 0.5);
        let at: Vec<f64> = found(of, 16).iter().map(|crossing| crossing.at).collect();
        assert_eq!(at.len(), 4);
        for (at, expected) in at.iter().zip([1.0, 5.0, 13.0, 17.0]) {
            assert!((at - expected / 18.0).abs() < 1e-7, "{at}");
        }
        let [step] = found(|at| Some(if at < 0.3 { -1.0 } else { 2.0 }), 4)[..] else { panic!() };
        assert!((step.at - 0.3).abs() < 1e-8 && step.jump == Some((-1.0, 2.0)), "{step:?}");
        let [exact] = found(|at| Some(at - 0.5), 4)[..] else { panic!() };
        assert_eq!(exact, Crossing { at: 0.5, jump: None });
        // no result between the neighbours, or on one side
        assert!(found(|at| (at != 0.5 && (at - 0.5).abs() > 0.1).then_some(at - 0.51), 4).is_empty());
        assert!(found(|at| Some(at + 1.0), 4).is_empty());
        let whole = crossings(&[(6.0, Some(-1.0)), (7.0, Some(3.0))], None);
        assert_eq!(whole, [Crossing { at: 7.0, jump: Some((-1.0, 3.0)) }]);
        assert!(parse("a").is_err() && parse("a=NaN").is_err() && parse("a = 0.5").is_ok());
    }
}
