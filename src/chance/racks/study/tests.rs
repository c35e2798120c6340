use std::sync::OnceLock;

use proptest::prelude::*;

use super::super::counts::MOST_BINS;
use super::super::{RackYoke, RacksSummary};
use super::*;
use crate::function::Setting;
use crate::judge::Verdict;
use crate::trig;

fn study_of(seed: u64) -> StudyOf {
    let (version, fingerprint) = ("1".to_owned(), "teeth".to_owned());
    StudyOf { version, fingerprint, seed, from_mm: 0.0, to_mm: 50.0 }
}

/// Lengths that no two racks share, spread over a twentieth of a millimetre.
fn result(rack: u64) -> RackResult {
    let place = 0.02 * trig::sin((rack as f64) * 0.618_033_9);
    let setting = Setting { from_mm: 0.03 + place, to_mm: (!rack.is_multiple_of(3)).then_some(0.06 + 0.7 * place) };
    let yoke = RackYoke {
        settings: (!rack.is_multiple_of(5)).then(|| (!rack.is_multiple_of(7)).then_some(setting)),
        fluctuation_n_m: Some(0.5 + place),
        lift_off_n: Some(2000.0 + 1000.0 * place),
        verdicts: [None; 4],
    };
    RackResult { mean_mm: place, min_mm: place - 0.01, max_mm: 1.3 * place + 0.015, yoke: Some(yoke) }
}

fn limit() -> Limit {
    Limit { lower: None, upper: Some("0.04".parse().unwrap()) }
}

fn range(first_rack: u64, end: u64) -> RacksStudy {
    let results: Vec<_> = (first_rack..end).map(result).collect();
    RacksStudy::of(study_of(1), first_rack, &results, Some(&limit())).unwrap()
}

/// One run of 70,000 racks.
static ONE: OnceLock<RacksStudy> = OnceLock::new();

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2))]

    /// Any cuts, merged in any order and grouping: also where lengths need wider bins than those of a part.
    #[test]
    fn ranges_merge_to_what_one_run_has(
        cuts in proptest::collection::vec(0..70_000_u64, 0..6),
        order in any::<u64>(),
        is_grouped in any::<bool>(),
    ) {
        let mut cuts = cuts;
        cuts.extend([0, 70_000]);
        cuts.sort_unstable();
        let mut parts: Vec<_> = cuts.windows(2).filter(|two| two[0] < two[1]).map(|two| range(two[0], two[1])).collect();
        parts.sort_by_key(|part| part.asked().first_rack.wrapping_add(order).wrapping_mul(order | 1));
        let tail = parts.split_off(if is_grouped { parts.len() / 2 } else { parts.len() - 1 });
        let merged = |parts: &[RacksStudy]| {
            parts.split_first().map(|(first, others)| {
                others.iter().fold(first.clone(), |mut all, part| {
                    all.merge(part).unwrap();
                    all
                })
            })
        };
        let mut all = merged(&tail).unwrap();
        if let Some(head) = merged(&parts) {
            all.merge(&head).unwrap();
        }
        let one = ONE.get_or_init(|| range(0, 70_000));
        prop_assert!(one.mean.quantile_error_mm() > 0.0);
        prop_assert_eq!(RacksSummary::of(&all), RacksSummary::of(one));
        prop_assert!(&all == one);
    }
}

#[test]
fn quantiles_are_as_exact_as_they_say() {
    for racks in [1, 2, 1000, MOST_BINS as u64, 70_000] {
        let study = range(0, racks);
        let mut sorted: Vec<f64> = (0..racks).map(|rack| tidy(result(rack).mean_mm)).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let summary = RacksSummary::of(&study).unwrap();
        let error = summary.mean.quantile_error_mm;
        assert_eq!(error > 0.0, racks > MOST_BINS as u64, "{racks}: {error}");
        // 0.04 mm in 2^15 bins at the least
        assert!(error <= 0.5 * 0.04 / 32_768.0, "{error}");
        for quantile in &summary.mean.quantiles {
            let rank = ((racks as f64 * quantile.share).ceil() as usize).max(1);
            let away = (quantile.value_mm - sorted[rank - 1]).abs();
            assert!(away <= error * (1.0 + 1e-9), "{racks}: {quantile:?} {away}");
        }
        let mean = sorted.iter().sum::<f64>() / racks as f64;
        let squares = sorted.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        assert!((summary.mean.mean_mm - mean).abs() < 2e-12);
        match summary.mean.standard_deviation_mm {
            Some(found) => assert!((found - (squares / (racks as f64 - 1.0)).sqrt()).abs() < 2e-12),
            None => assert_eq!(racks, 1),
        }
        assert_eq!(summary.mean.histogram.iter().map(|bin| bin.racks).sum::<u64>(), racks);
        assert_eq!(summary.mean.histogram[0].from_mm, sorted[0]);
    }
}

/// More results than there are bins, each of its own length: what is held is that of so many bins.
#[test]
fn memory_does_not_grow_with_the_racks() {
    let mut study = RacksStudy::new(study_of(1), RackRange { first_rack: 0, racks: 140_000 }, true, true);
    for first in (0..140_000).step_by(20_000) {
        study.merge(&range(first, first + 20_000)).unwrap();
        for counts in [&study.mean, &study.peak_to_peak, &study.smallest, &study.largest] {
            assert!(counts.bins_held() <= MOST_BINS);
        }
    }
    assert_eq!((study.racks(), study.missing()), (140_000, Vec::new()));
    assert_eq!(study.ranges.len(), 1);
}

#[test]
fn what_does_not_belong_together_is_refused_and_changes_nothing() {
    let mut study = range(0, 100);
    let before = study.clone();
    let refused = study.merge(&range(50, 150)).unwrap_err();
    assert_eq!(refused, StudyError::Overlap { both: RackRange { first_rack: 50, racks: 50 } });
    assert!(refused.to_string().contains("racks 50 … 99"), "{refused}");
    let other = RacksStudy::of(study_of(2), 100, &[result(100)], Some(&limit())).unwrap();
    let refused = study.merge(&other).unwrap_err().to_string();
    assert!(refused.contains("the seed is 1 in one and 2 in the other"), "{refused}");
    let fingerprint = "other teeth".to_owned();
    let other = RacksStudy::of(StudyOf { fingerprint, ..study_of(1) }, 100, &[result(100)], None).unwrap();
    assert!(study.merge(&other).unwrap_err().to_string().contains("fingerprint is teeth"));
    assert!(study == before);
    let without_count = RacksStudy { inside: None, ..range(100, 150) };
    assert!(matches!(study.merge(&without_count), Err(StudyError::Damaged { .. })));
    assert!(study == before);
    let far = RackResult { mean_mm: 1e300, ..result(0) };
    let refused = RacksStudy::of(study_of(1), 0, &[far], None).unwrap_err();
    assert_eq!(refused, StudyError::NoLength { length_mm: 1e300 });
    let far = RackResult { mean_mm: 1e5, ..result(0) };
    let refused = RacksStudy::of(study_of(1), 0, &vec![far; 20_000], None).unwrap_err();
    assert_eq!(refused, StudyError::TooMany);
}

#[test]
fn a_gap_leaves_the_verdict_open_and_a_rack_outside_fails_all_the_same() {
    let mut study = range(0, 10);
    study.merge(&range(30, 40)).unwrap();
    let summary = RacksSummary::of(&study).unwrap();
    let gap = RackRange { first_rack: 10, racks: 20 };
    let is_inside = |rack| tidy(result(rack).max_mm) <= 0.04;
    assert!((0..10).chain(30..40).any(|rack| !is_inside(rack)));
    assert_eq!((summary.missing, summary.verdict), (vec![gap], Some(Verdict::Fail)));
    let calm = |first, count| {
        let calm = RackResult { max_mm: 0.03, ..result(0) };
        RacksStudy::of(study_of(1), first, &vec![calm; count], Some(&limit())).unwrap()
    };
    let mut study = calm(0, 10);
    assert_eq!(RacksSummary::of(&study).unwrap().verdict, Some(Verdict::Pass));
    study.merge(&calm(30, 10)).unwrap();
    assert_eq!(RacksSummary::of(&study).unwrap().verdict, None);
    study.merge(&calm(10, 20)).unwrap();
    assert_eq!(RacksSummary::of(&study).unwrap().verdict, Some(Verdict::Pass));
    study.ask(RackRange { first_rack: 0, racks: 50 }).unwrap();
    assert_eq!(RacksSummary::of(&study).unwrap().verdict, None);
    assert!(study.ask(RackRange { first_rack: 1, racks: 50 }).is_err());
}
