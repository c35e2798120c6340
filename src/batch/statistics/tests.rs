use super::*;
use crate::statistics::normal_quantile;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng as _, SeedableRng as _};

fn of(values: impl IntoIterator<Item = i64>) -> Statistics {
    let mut statistics = Statistics::default();
    let values: Vec<_> = values.into_iter().map(Length::from_fm).collect();
    statistics.add(&values);
    statistics
}

#[test]
fn a_small_spread_on_a_large_mean_loses_nothing() {
    // 100 mm ± 1 nm: in doubles, the sum of squares would have no digit left for it
    let (mm, nm) = (1_000_000_000_000, 1_000_000);
    let statistics = of([-1, 0, 1].map(|n| 100 * mm + n * nm));
    assert_eq!(statistics.mean_mm(), Some(100.0));
    assert_eq!(statistics.standard_deviation_mm(), Some(1e-6));
    assert_eq!((statistics.min_mm(), statistics.max_mm()), (Some(99.999_999), Some(100.000_001)));
}

#[test]
fn order_and_parts_do_not_matter() {
    let values: Vec<i64> = (0..5000i64).map(|n| (n * 7_919_777_777) % 400_000_000_000 - 150_000_000_000).collect();
    let whole = of(values.iter().copied());
    let mut parts = of(values[3000..].iter().rev().copied());
    parts.merge(&of(values[..3000].iter().copied()));
    for q in QUANTILES {
        assert_eq!(whole.quantile_mm(q), parts.quantile_mm(q));
    }
    assert_eq!(whole.mean_mm(), parts.mean_mm());
    assert_eq!(whole.standard_deviation_mm(), parts.standard_deviation_mm());
    assert_eq!((whole.min_mm(), whole.max_mm()), (parts.min_mm(), parts.max_mm()));
}

#[test]
fn quantiles_are_within_their_bound() {
    let mut values: Vec<i64> = (0..10_000i64).map(|n| (n * n * 13_131) % 200_000_000_000 - 50_000_000_000).collect();
    let statistics = of(values.iter().copied());
    values.sort_unstable();
    for (q, place) in
        QUANTILES.into_iter().zip([13.498_65, 99.99, 499.95, 2499.75, 4999.5, 7499.25, 9499.05, 9899.01, 9_985.501_35])
    {
        let below = place as usize;
        let [low, high] = [below, below + 1].map(|index| millimetres(values[index]));
        let exact = low + (place - below as f64) * (high - low);
        let found = statistics.quantile_mm(q).unwrap();
        assert!((found - exact).abs() <= 0.0005 * low.abs().max(high.abs()), "{q}: {found} {exact}");
    }
    let counts = statistics.histogram(-0.06, 0.16, 4);
    assert_eq!(counts.iter().sum::<u64>(), 10_000);
}

/// Between the two values in the middle of an even number; ends and values on a rank are those themselves.
#[test]
fn quantiles_lie_between_neighbours() {
    let um = |values: &[i64]| of(values.iter().map(|value| value * 1_000_000_000));
    let near =
        |found: Option<f64>, exact: f64| assert!((found.unwrap() / exact - 1.0).abs() < 5e-4, "{found:?} {exact}");
    let four = um(&[100, 0, 20, 10]);
    near(four.quantile_mm(0.5), 0.015);
    near(four.quantile_mm(0.75), 0.04);
    near(four.quantile_mm(1.0 / 3.0), 0.01);
    assert_eq!((four.quantile_mm(0.0), four.quantile_mm(1.0)), (Some(0.0), Some(0.1)));
    near(um(&[10, 20]).quantile_mm(0.5), 0.015);
    near(um(&[10, 20, 60]).quantile_mm(0.5), 0.02);
    near(um(&[-30, -10, -10, -10]).quantile_mm(0.25), -0.015);
}

#[test]
fn nothing_and_one_value() {
    let nothing = of([]);
    assert_eq!((nothing.mean_mm(), nothing.standard_deviation_mm(), nothing.quantile_mm(0.5)), (None, None, None));
    let one = of([-7]);
    assert_eq!((one.mean_mm(), one.standard_deviation_mm()), (Some(-7e-12), None));
}

#[test]
fn a_histogram_from_the_least_to_the_largest_value_loses_none() {
    for values in [[54_912_612_345, 3_000_000_001, 41_000_000_007], [-54_912_612_345, -1, -3]] {
        let statistics = of(values);
        let (low, high) = (statistics.min_mm().unwrap(), statistics.max_mm().unwrap().next_up());
        assert_eq!(statistics.histogram(low, high, 40).iter().sum::<u64>(), 3, "{values:?}");
    }
}

/// A thousand draws from a normal distribution that A*² of the values does not contradict: bins of a thousandth of the
/// value, an eighth of the spread, did.
#[test]
fn normality_of_a_lot_far_from_zero() {
    let lot = include_str!("../../../tests/specs/normal-lot.csv").lines().skip(1);
    let fm = |line: &str| line.split_once(',')?.1.parse::<Length>().ok().map(|um| um.fm() / 1000);
    let values: Vec<_> = lot.map(|line| Length::from_fm(fm(line).expect(line))).collect();
    let (mut whole, mut rest) = (Statistics::of_kept_values(), Statistics::of_kept_values());
    whole.add(&values[..300]);
    rest.add(&values[300..]);
    whole.merge(&rest);
    let found = whole.normality().unwrap();
    assert_eq!(format!("{:.4} {:.3}", found.anderson_darling, found.p_value), "0.4031 0.356");
    assert!(of([1, 2, 3].repeat(10)).normality().is_none());
}

#[test]
fn more_values_than_are_kept_are_not_tested() {
    let most: Vec<_> = (0..MOST_TESTED as i64).map(Length::from_fm).collect();
    let mut statistics = Statistics::of_kept_values();
    statistics.add(&most);
    assert!(statistics.normality().unwrap().rejected());
    let mut merged = statistics.clone();
    statistics.add(&most[..1]);
    assert_eq!((statistics.normality(), statistics.values.as_ref()), (None, None));
    merged.merge(&of([5]));
    assert_eq!(merged.normality(), None);
    statistics.merge(&Statistics::of_kept_values());
    assert_eq!(statistics.normality(), None);
}

/// Of 400 normal lots of each size, whatever mean and spread, 2 to 8 % are contradicted at 5 %.
#[test]
fn normal_lots_are_contradicted_as_often_as_they_should() {
    let mut generator = Xoshiro256PlusPlus::seed_from_u64(45);
    // in the middle of 2³² cells
    let mut uniform = || (f64::from(generator.next_u32()) + 0.5) / 4_294_967_296.0;
    for parts in [30, 300, 3000] {
        let contradicted = (0..400).filter(|lot| {
            // means of −0.1 to 0.1 mm, standard deviations of 0.01 µm to 0.1 mm
            let mean = 0.2 * uniform() - 0.1;
            let deviation = libm::pow(10.0, -5.0 + f64::from(lot % 5));
            let mut statistics = Statistics::of_kept_values();
            let values: Vec<_> =
                (0..parts).map(|_| Length::from_mm(mean + deviation * normal_quantile(uniform())).unwrap()).collect();
            statistics.add(&values);
            statistics.normality().unwrap().rejected()
        });
        let contradicted = contradicted.count();
        assert!((8..=32).contains(&contradicted), "{parts}: {contradicted} of 400");
    }
}

#[test]
fn moving_ranges_do_not_depend_on_where_chunks_end() {
    let values: Vec<i64> = (0..100).map(|n: i64| (n * 7_919) % 1_000 - 500).collect();
    let mut whole = MovingRange::default();
    for value in &values {
        whole.add(Length::from_fm(*value));
    }
    for end in [0, 1, 50, 99, 100] {
        let (mut joined, mut next) = (MovingRange::default(), MovingRange::default());
        for value in &values[..end] {
            joined.add(Length::from_fm(*value));
        }
        for value in &values[end..] {
            next.add(Length::from_fm(*value));
        }
        joined.join(&next);
        assert_eq!((joined.sum, joined.count, joined.ends), (whole.sum, whole.count, whole.ends), "{end}");
    }
    let mut statistics = of(values.iter().copied());
    assert_eq!(statistics.moving_range_mm(), None);
    statistics.moving = whole;
    let expected: u64 = values.windows(2).map(|pair| pair[0].abs_diff(pair[1])).sum();
    let mean = f64::from(u32::try_from(expected).unwrap()) / 99.0 * 1e-12;
    assert!((statistics.moving_range_mm().unwrap() / mean - 1.0).abs() < 1e-12);
}

#[test]
fn squares_too_large_for_a_sum_have_no_standard_deviation() {
    // ten values of a kilometre: a sum of squares of 10³⁷
    let kilometre = 1_000_000_000_000_000_000;
    let (few, many) = (of([-kilometre, kilometre].repeat(5)), of([-kilometre, kilometre].repeat(100)));
    assert!((few.standard_deviation_mm().unwrap() / 1e6 - (10.0_f64 / 9.0).sqrt()).abs() < 1e-12);
    assert_eq!((many.count(), many.standard_deviation_mm(), many.mean_mm()), (200, None, Some(0.0)));
    assert_eq!((many.min_mm(), many.quantile_mm(0.25), many.max_mm()), (Some(-1e6), Some(-1e6), Some(1e6)));
}
