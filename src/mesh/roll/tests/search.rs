//! The search among rolls by itself: what it keeps, bounds, divides and gives.

use super::*;
use crate::mesh::roll::valleys::{APART, SMALLEST_GAP, lower_bound, smooth_bound};

/// A roll at which the centre distance would have this value and slope.
fn rolled(angle: f64, value: f64, slope: f64) -> Rolled {
    let mesh = spur(0.35, 20.0, 0.0);
    let at = Sampler::new(&mesh).at_roll(0.0, 0.0, 8.0).expect("contact");
    Rolled { angle, value, slope, ..at }
}

fn node(angle: f64, value: f64, slope: f64) -> Node {
    Node { angle, solution: Some(rolled(angle, value, slope)) }
}

fn off_mesh(angle: f64) -> Node {
    Node { angle, solution: None }
}

/// A roll at which no rotation balances both sides.
fn unbalanced(angle: f64, residual: f64) -> Rolled {
    let mut at = rolled(angle, -100.0, 0.0);
    (at.point.ending, at.point.residual_mm) = (Ending::Unbalanced, residual);
    at
}

/// Two parabolas that bend down meet where both are as high; ends that bend down by more than that bound nothing.
#[test]
fn a_bound_is_where_the_parabolas_of_both_ends_meet() {
    for (apart, width, curvature) in [(0.0, 0.5, 6.0), (0.05, 0.5, 6.0), (-0.1, 0.25, 40.0)] {
        let (low, high) = (rolled(0.1, 2.0, 0.3), rolled(0.1 + width, 2.0 + apart, -0.2));
        let (meet, bound) = lower_bound(&low, &high, curvature);
        assert!(meet > low.angle && meet < high.angle);
        for end in [low, high] {
            let by = meet - end.angle;
            let expected = end.value + end.slope * by - 0.5 * curvature * by * by;
            assert!((bound - expected).abs() < 1e-14, "{apart}: {bound} {expected}");
        }
    }
    for (low, high) in [((0.0, 0.0), (-10.0, 0.0)), ((0.0, 0.0), (10.0, 0.0)), ((0.0, 9.0), (10.0, -9.0))] {
        let (low, high) = (rolled(0.1, low.0, low.1), rolled(0.5, high.0, high.1));
        let (meet, bound) = lower_bound(&low, &high, 1.0);
        assert!((meet - 0.3).abs() < 1e-15 && bound == f64::NEG_INFINITY, "{meet} {bound}");
        // next to a jump, what the steeper end and the curvature allow below the lower one
        for which in 0..2 {
            let mut ends = [low, high];
            ends[which].point.residual_mm = -2.0 * APART;
            let (meet, bound) = lower_bound(&ends[0], &ends[1], 0.7);
            let steepest = low.slope.abs().max(high.slope.abs());
            let expected = low.value.min(high.value) - 0.4 * steepest - 0.5 * 0.7 * 0.4 * 0.4;
            assert!((meet - 0.3).abs() < 1e-15 && (bound - expected).abs() < 1e-14, "{bound} {expected}");
        }
    }
}

/// Where the same points touch at both ends, what lies between is bounded closely, and from below.
#[test]
fn one_contact_is_bounded_by_the_cubic_through_both_ends() {
    let curvature = 300.0;
    for (slope, bend, third, fourth) in [(0.0, 15.0, 0.0, 0.0), (-0.05, 15.0, 40.0, 1e4), (-0.1, 30.0, -200.0, -1e4)] {
        let f = |x: f64| 2.0 + x * (slope + x * (bend / 2.0 + x * (third / 6.0 + x * fourth / 24.0)));
        let rate = |x: f64| slope + x * (bend + x * (third / 2.0 + x * fourth / 6.0));
        let [low, high] = [1e-5, 0.01].map(|x| rolled(x, f(x), rate(x)));
        let bound = smooth_bound(&low, &high, curvature);
        let least = (1..1000).map(|i| f(1e-5 + 0.009_99 * f64::from(i) / 1000.0)).fold(f64::INFINITY, f64::min);
        let parabolas = lower_bound(&low, &high, curvature).1;
        assert!(bound <= f(0.005).max(least) && bound > parabolas, "{bound} {least} {parabolas}");
        if slope < 0.0 {
            assert!(bound <= least && bound > least - 1e-3, "{bound} {least}");
        }
    }
}

/// Divided where both bounds meet but not next to an end; not at all where it is short.
#[test]
fn an_interval_is_divided_away_from_its_ends() {
    let curvature = 10.0;
    let opened = |low, high| {
        let mut search = Search { curvature, ..Search::default() };
        search.open(low, high);
        search.intervals.pop().map(|interval| (interval.low.angle, interval.high.angle, interval.meet))
    };
    let (low, high) = (0.03, 0.05);
    assert_eq!(opened(node(low, 1.0, 0.0), node(high, 1.0, 0.0)).map(|(.., meet)| (meet * 1e9).round()), Some(4e7));
    for (value, share) in [(1.0 + 1.9e-3, 0.1), (1.0 - 1.9e-3, 0.9), (1.0 + 1e-3, 0.25), (1.0 - 1e-3, 0.75)] {
        let (from, to, meet) = opened(node(low, 1.0, 0.0), node(high, value, 0.0)).expect("it is long");
        assert_eq!((from, to), (low, high));
        assert!((meet - (low + share * (high - low))).abs() < 1e-15, "{share} {meet}");
    }
    assert!(opened(node(low, 1.0, 0.0), node(low + 0.99 * SHORT, 1.0, 0.0)).is_none());
    assert!(opened(node(low, 1.0, 0.0), node(low + 1.01 * SHORT, 1.0, 0.0)).is_some());
}

/// Where the mesh ends nothing is known of what lies between: that is halved until it is small.
#[test]
fn the_end_of_the_mesh_is_looked_for() {
    let opened = |low: Node, high: Node| {
        let mut search = Search { curvature: 10.0, ..Search::default() };
        search.open(low, high);
        search.intervals.pop().map(|interval| (interval.meet, interval.bound))
    };
    let (low, high) = (-0.03, 0.05);
    for ends in [(off_mesh(low), node(high, 1.0, 0.0)), (node(low, 1.0, 0.0), off_mesh(high))] {
        let (meet, bound) = opened(ends.0, ends.1).expect("it is long");
        // what the one end and the curvature allow
        assert!((meet - 0.01).abs() < 1e-15 && (bound - (1.0 - 0.5 * 10.0 * 0.08 * 0.08)).abs() < 1e-15, "{bound}");
    }
    assert!(opened(off_mesh(low), off_mesh(high)).is_none(), "no mesh at either end");
    assert!(opened(off_mesh(low), node(low + 0.99 * SMALLEST_GAP, 1.0, 0.0)).is_none());
    assert!(opened(off_mesh(low), node(low + 1.01 * SMALLEST_GAP, 1.0, 0.0)).is_some());
}

/// The roll does not flicker between positions as low within rounding.
#[test]
fn of_positions_as_low_the_first_roll_counts() {
    let mut search = Search::default();
    for (angle, value) in [(0.02, 1.5), (0.01, 1.0), (-0.01, 1.0 + 0.5 * TIE), (-0.02, 1.0 + 3.0 * TIE)] {
        search.found(rolled(angle, value, 0.0));
    }
    assert_eq!(search.best, Some(1.0));
    let lowest = search.lowest().expect("found");
    assert_eq!(lowest.angle, -0.01);
}

/// The interval with the lowest bound comes next, unless nothing in it could count.
#[test]
fn intervals_that_may_count_are_divided() {
    for (above, counts) in [(-1.0, true), (0.5 * TIE, true), (2.0 * TIE, false), (1.0, false)] {
        let mut search = Search::default();
        search.found(rolled(0.0, 1.0, 0.0));
        for bound in [1.5 + above, 1.0 + above, 2.0 + above] {
            let (low, high) = (node(0.0, 1.0, 0.0), node(0.05, 1.0, 0.0));
            search.intervals.push(Interval { low, high, meet: 0.025, bound });
        }
        assert_eq!(search.lowest_interval().map(|interval| interval.bound), counts.then_some(1.0 + above));
    }
}

/// A search that is given up says so of all that it found.
#[test]
fn what_an_unfinished_search_found_is_not_converged() {
    let mut search = Search::default();
    search.found(rolled(0.01, 1.0, 0.0));
    search.found(rolled(-0.01, 1.0, 0.0));
    search.unfinished();
    assert_eq!(search.lowest().expect("found").point.ending, Ending::RollNotFound);
}

/// The rack that is not rolled is taken where it is as low as what was found next to it, and balanced.
#[test]
fn the_level_rack_counts_where_it_is_as_low() {
    let found = rolled(1e-9, 1.0, 0.0);
    for (value, angle) in [(1.0 - TIE, 0.0), (1.0 + 0.5 * TIE, 0.0), (1.0 + 2.0 * TIE, 1e-9), (2.0, 1e-9)] {
        assert_eq!(found.or_level(rolled(0.0, value, 0.0)).angle, angle, "{value}");
    }
    assert_eq!(found.or_level(unbalanced(0.0, 0.1)).angle, 1e-9);
}

/// What is nearest to balance is given where nothing balances, why there is no mesh before it, and what balances before both.
#[test]
fn what_nothing_balances_is_given_last() {
    let mut search = Search::default();
    for (angle, residual) in [(0.01, -0.3), (0.02, 0.2), (0.03, -0.2), (0.04, 0.25)] {
        assert!(!search.node(angle, Ok(unbalanced(angle, residual))).is_balanced());
    }
    let with = |node: Option<Result<Rolled, MeshError>>| {
        let mut search = Search { unbalanced: search.unbalanced, ..Search::default() };
        node.map(|node| search.node(0.0, node));
        search.lowest().map(|found| found.angle)
    };
    assert_eq!(with(None), Ok(0.02));
    let failure = MeshError::TipOnTip { stroke_mm: 1.0, right: 0, left: 0 };
    assert_eq!(with(Some(Err(failure))), Err(failure));
    assert_eq!(with(Some(Ok(rolled(0.05, 1.0, 0.0)))), Ok(0.05));
}
