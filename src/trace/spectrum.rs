//! Orders of a curve: the amplitudes of sines with a whole number of periods in a turn of the pinion.

use std::f64::consts::TAU;

use crate::linear::least_squares;
use crate::trig;

/// An order with its amplitudes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Order {
    /// Periods in a turn of the pinion: z for the tooth mesh.
    pub order: u32,
    /// Amplitudes in the measured and in the computed curve, mm.
    pub amplitudes_mm: [f64; 2],
}

/// The orders of two curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// All orders, which are fitted together, rising.
    pub orders: Vec<Order>,
    /// Turns of the pinion that the points cover.
    pub turns: f64,
}

/// The highest harmonic of the tooth mesh, and the most orders.
const HARMONICS: u32 = 3;
const MOST_ORDERS: u32 = 120;
/// The fewest points in a period.
const POINTS: f64 = 2.5;

impl Spectrum {
    /// Fits a constant and the sines of all orders together, by least squares; strokes may be irregular. Points over a turn or
    /// more give every order up to three times the tooth mesh; points over less than a turn give the tooth mesh and its
    /// harmonics. `None` if the points determine no order.
    pub(super) fn of(strokes_mm: &[f64], curves: [&[f64]; 2], pitch_mm: f64, teeth: u32) -> Option<Self> {
        let length_mm = strokes_mm.last()? - strokes_mm.first()?;
        let turn_mm = pitch_mm * f64::from(teeth);
        let turns = length_mm / turn_mm;
        let spacing_mm = length_mm / strokes_mm.len().checked_sub(1)? as f64;
        let is_whole = turns >= 1.0 - spacing_mm / turn_mm;
        let is_told = |order: &u32| turn_mm / f64::from(*order) >= POINTS * spacing_mm;
        let highest = (HARMONICS * teeth).min(MOST_ORDERS);
        let orders: Vec<u32> = if is_whole {
            (1..=highest).filter(is_told).collect()
        } else {
            let meshes = (1..=HARMONICS).map(|harmonic| harmonic * teeth);
            meshes.filter(is_told).filter(|_| length_mm >= pitch_mm).collect()
        };
        if orders.is_empty() || 2 * orders.len() + 1 >= strokes_mm.len() {
            return None;
        }
        let mut columns = vec![vec![1.0; strokes_mm.len()]];
        for order in &orders {
            let angle = |stroke: &f64| TAU * f64::from(*order) * stroke / turn_mm;
            let (sines, cosines) = strokes_mm.iter().map(|stroke| trig::sin_cos(angle(stroke))).unzip();
            columns.extend([cosines, sines]);
        }
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let weights = vec![1.0; strokes_mm.len()];
        let [measured, computed] = curves.map(|curve| least_squares(&columns, &weights, curve));
        let (measured, computed) = (measured?.coefficients, computed?.coefficients);
        let amplitude =
            |of: &[f64], at: usize| (of[2 * at + 1] * of[2 * at + 1] + of[2 * at + 2] * of[2 * at + 2]).sqrt();
        let orders = orders.iter().enumerate();
        let orders = orders.map(|(at, order)| Order {
            order: *order,
            amplitudes_mm: [amplitude(&measured, at), amplitude(&computed, at)],
        });
        Some(Self { orders: orders.collect(), turns })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sines of known amplitudes at irregular strokes are found again; less than a turn determines the tooth mesh only.
    #[test]
    fn orders_of_irregular_strokes() {
        let strokes: Vec<f64> = (0..400).map(|at| 0.25 * f64::from(at) + 0.1 * f64::from(at * 7 % 11) / 11.0).collect();
        let at = |stroke: &f64| {
            let angle = TAU * stroke / 48.0;
            0.3 + 0.02 * trig::sin_cos(angle + 0.4).0 + 0.004 * trig::sin_cos(8.0 * angle - 1.0).0
        };
        let curve: Vec<f64> = strokes.iter().map(at).collect();
        let level = vec![0.1; strokes.len()];
        let spectrum = Spectrum::of(&strokes, [&curve, &level], 6.0, 8).unwrap();
        assert_eq!(spectrum.orders.len(), 24);
        for Order { order, amplitudes_mm } in &spectrum.orders {
            let expected = match order {
                1 => 0.02,
                8 => 0.004,
                _ => 0.0,
            };
            assert!(
                (amplitudes_mm[0] - expected).abs() < 1e-12 && amplitudes_mm[1] < 1e-12,
                "{order}: {amplitudes_mm:?}"
            );
        }
        let part = Spectrum::of(&strokes[..100], [&curve[..100], &level[..100]], 6.0, 8).unwrap();
        assert_eq!(part.orders.iter().map(|order| order.order).collect::<Vec<_>>(), [8, 16, 24]);
        assert_eq!(Spectrum::of(&strokes[..8], [&curve[..8], &level[..8]], 6.0, 8), None);
    }
}
