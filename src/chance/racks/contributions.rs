//! Where the spread of ΔCD comes from: Sobol indices of each scatter, through the exact mesh. A scatter is a group of random
//! numbers, one or more for each tooth. Samples are pseudo-random, because there are too many numbers for low-discrepancy
//! sequences.

use std::sync::atomic::{AtomicBool, Ordering};

use super::{Draw, RackResult, RackSettings, Racks, RacksError, Random};
use crate::chance::sobol::{Estimate, PARTS, Sums, indices};
use crate::parallel;

/// The quantities of each rack: name and value.
type Quantity = (&'static str, fn(&RackResult) -> f64);

const QUANTITIES: [Quantity; 3] = [
    ("mean", |result| result.mean_mm),
    ("largest", |result| result.max_mm),
    ("peak_to_peak", RackResult::peak_to_peak_mm),
];

/// The contribution of a scatter to the variance of a quantity.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Contribution {
    /// The quantity of a rack's ΔCD: `mean`, `largest` or `peak_to_peak`.
    pub delta_cd: &'static str,
    /// The scatter.
    pub of: &'static str,
    /// Its share alone, by Saltelli's estimator; `None` where the quantity does not vary.
    pub first_order: Option<Estimate>,
    /// Its share alone and with others, by Jansen's estimator.
    pub total: Option<Estimate>,
}

/// The contributions of all scatters.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Contributions {
    /// Pairs of racks that were drawn.
    pub samples: u64,
    /// The number of pairs that was asked for.
    pub asked: u64,
    /// Racks that were solved: two of each sample, and one for each scatter.
    pub racks: u64,
    /// How many of the two independent racks of each sample stay within the limits along the whole stroke; `None` without limits.
    #[cfg_attr(feature = "report", serde(skip))]
    pub inside: Option<u64>,
    /// For each quantity, each scatter.
    pub indices: Vec<Contribution>,
}

impl Racks<'_> {
    /// The contribution of each scatter to the variance of the mean, the largest and the peak to peak value of ΔCD, by as many
    /// samples as racks are asked for. `each` gets the number of finished ones; once `stop` is set, the result has the first
    /// ones only.
    ///
    /// # Errors
    /// As of [`study`](Self::study).
    pub fn contributions(
        &self,
        settings: &RackSettings,
        stop: &AtomicBool,
        mut each: impl FnMut(u64),
    ) -> Result<Contributions, RacksError> {
        let spreads = self.scatter.spreads();
        let kinds: Vec<usize> = (0..spreads.len()).filter(|kind| spreads[*kind].1.is_some()).collect();
        if kinds.is_empty() {
            return Err(RacksError::NothingScatters);
        }
        // the figures of a yoke are no part of it
        let racks = Racks { yoke: None, ..*self };
        let draw = Draw::new(&racks, settings)?;
        let (first, asked) = (settings.range.first_rack, settings.range.racks);
        let part_size = asked.div_ceil(PARTS).max(1);
        let mut parts = QUANTITIES.map(|_| Vec::<Sums>::new());
        let (mut samples, mut inside) = (0, 0);
        let ended = parallel::in_order(
            settings.threads.unwrap_or_else(parallel::cores),
            asked,
            |sample| draw.sample(first.wrapping_add(sample), &kinds, stop),
            |solved: Option<Result<Vec<RackResult>, RacksError>>| {
                // a sample that the stop cuts short does not count
                let results = solved.ok_or(None)?.map_err(Some)?;
                for ((_, of), parts) in QUANTITIES.iter().zip(&mut parts) {
                    if samples % part_size == 0 {
                        parts.push(Sums::default());
                    }
                    if let ([a, b, mixed @ ..], Some(part)) = (&results[..], parts.last_mut()) {
                        part.add(of(a), of(b), mixed.iter().map(of));
                    }
                }
                let is_inside = |rack: &&RackResult| self.limit.is_some_and(|limit| rack.is_inside(limit));
                inside += results.iter().take(2).filter(is_inside).count() as u64;
                samples += 1;
                each(samples);
                Ok(())
            },
        );
        if let Err(Some(error)) = ended {
            return Err(error);
        }
        let of_quantity = |((delta_cd, _), parts): (&(&'static str, _), &Vec<Sums>)| {
            // the last part may be smaller than the others
            let whole = if samples % part_size == 0 { parts.len() } else { parts.len() - 1 };
            let found = indices(&parts[..whole], settings.seed);
            let of = |(index, kind): (usize, &usize)| {
                let own = found.as_ref().map(|found| found[index]);
                let (first_order, total) = (own.map(|own| own.first_order), own.map(|own| own.total));
                Contribution { delta_cd, of: spreads[*kind].0, first_order, total }
            };
            kinds.iter().enumerate().map(of).collect::<Vec<_>>()
        };
        let indices = QUANTITIES.iter().zip(&parts).flat_map(of_quantity).collect();
        let inside = self.limit.map(|_| inside);
        Ok(Contributions { samples, asked, racks: samples * (kinds.len() as u64 + 2), inside, indices })
    }
}

impl Draw<'_> {
    /// Two independent racks, and the first one with each scatter of the second; `None` once the run is to stop.
    fn sample(&self, sample: u64, kinds: &[usize], stop: &AtomicBool) -> Option<Result<Vec<RackResult>, RacksError>> {
        let count = self.racks.scatter.spreads().len();
        // each scatter has random numbers of its own, so that it can be exchanged
        let random = |is_second: bool, kind: usize| {
            let side = sample.wrapping_mul(2).wrapping_add(u64::from(is_second));
            Random::of_block(self.seed, side.wrapping_mul(count as u64).wrapping_add(kind as u64))
        };
        let solved = |exchanged: &dyn Fn(usize) -> bool| {
            let mut randoms: Vec<_> = (0..count).map(|kind| random(exchanged(kind), kind)).collect();
            (!stop.load(Ordering::Relaxed)).then(|| self.solved(&mut randoms, sample))
        };
        let ends = [solved(&|_| false), solved(&|_| true)].into_iter();
        ends.chain(kinds.iter().map(|own| solved(&|kind| kind == *own))).collect()
    }
}
