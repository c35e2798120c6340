use super::*;
use crate::chance::tests::Function;

/// A symmetric 95 % interval leaves 250 of 10 000 values below and above.
#[test]
fn the_ends_of_a_block() {
    let mut values: Vec<f64> = (0..10_000_u32).map(|i| f64::from((i * 3779) % 10_000)).collect();
    assert_eq!(ends(&mut values), (250.0, 9749.0));
}

/// Four blocks, of which one statistic is ±m about its mean: its standard error is m/√3, and twice that may be a fifth
/// of the tolerance of u = 2 to one digit, 0.5/5.
#[test]
fn blocks_have_settled_when_each_statistic_has() {
    let variables = Variables::default();
    let settings = Settings { digits: 1, ..Settings::default() };
    let model = Function(|_: &[f64]| 0.0);
    let run = SimulationRun {
        model: &model,
        variables: &variables,
        bands: &[],
        settings: &settings,
        ziggurat: Ziggurat::new(),
    };
    let pilot = [Pilot { center: 7.0, low: 0.0, high: 14.0 }];
    let n = 10_000.0;
    let block = |mean: f64, deviation: f64, ends: (f64, f64)| BlockSums {
        sum: n * mean,
        squares: (n - 1.0) * deviation * deviation + n * mean * mean,
        ends,
    };
    for which in 0..4 {
        for (factor, expected) in [(1.0 - 1e-6, true), (1.0 + 1e-6, false)] {
            let blocks: Vec<Vec<BlockSums>> = [1.0, -1.0, 1.0, -1.0]
                .map(|sign| {
                    let mut of = [0.5, 2.0, -3.5, 4.5];
                    of[which] += sign * factor * 0.05 * 3.0_f64.sqrt();
                    vec![block(of[0], of[1], (of[2], of[3]))]
                })
                .to_vec();
            assert_eq!(run.excess(&blocks, &pilot) <= 1.0, expected, "{which} {factor}");
        }
    }
    // what does not vary has settled
    assert!(run.excess(&[vec![block(0.0, 0.0, (1.0, 1.0))], vec![block(0.0, 0.0, (2.0, 2.0))]], &pilot) <= 1.0);
}
