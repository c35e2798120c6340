//! Where the spread of ΔCD comes from: a part of the report of `monte-carlo`, and of a page.

use serde_json::{Value, json};

use super::chart::{Axis, Bar, Chart, Layer, Scale, Shape};
use super::{Block, Table, fact};
use crate::chance::racks::{Contribution, Contributions};
use crate::chance::{Estimate, PROBABILITY, RESAMPLES};
use crate::deviation::key_in_words;

const FIRST_ORDER: &str = "Saltelli et al. 2010";
const TOTAL: &str = "Jansen 1999";

/// A share in whole percent, without a sign of zero.
fn percent(share: f64) -> f64 {
    (100.0 * share).round() + 0.0
}

/// From one share to another.
fn interval(estimate: Option<Estimate>) -> Option<String> {
    estimate.map(|Estimate { lower, upper, .. }| format!("{} … {} %", percent(lower), percent(upper)))
}

fn value(estimate: Option<Estimate>) -> Option<String> {
    estimate.map(|estimate| format!("{} %", percent(estimate.value)))
}

/// A share of the variance as a bar: alone, and behind that with others.
fn bar(of: &Contribution) -> String {
    const WIDTH: f64 = 25.0;
    let cells = |of: Option<Estimate>| of.map_or(0, |of| (WIDTH * of.value.clamp(0.0, 1.0)).round() as usize);
    let alone = cells(of.first_order);
    "█".repeat(alone) + &"░".repeat(cells(of.total).saturating_sub(alone))
}

pub(super) fn json(of: &Contributions, seed: u64) -> Value {
    let mut fact = json!(of);
    fact["estimators"] = json!({ "first_order": FIRST_ORDER, "total": TOTAL });
    fact["sampling"] = "pseudo-random, xoshiro256++".into();
    fact["intervals"] = format!("bootstrap, {RESAMPLES} resamples, percentiles").into();
    fact["confidence"] = PROBABILITY.into();
    fact["seed"] = seed.into();
    fact["interrupted"] = (of.samples < of.asked).into();
    // one record for each, so that each number is a column
    let record = |of: &Contribution| {
        let ends = |of: Option<Estimate>| [of.map(|of| of.value), of.map(|of| of.lower), of.map(|of| of.upper)];
        let ([first, first_lower, first_upper], [total, total_lower, total_upper]) =
            (ends(of.first_order), ends(of.total));
        json!({
            "delta_cd": of.delta_cd, "of": of.of,
            "first_order": first, "first_order_lower": first_lower, "first_order_upper": first_upper,
            "total": total, "total_lower": total_lower, "total_upper": total_upper,
        })
    };
    fact["indices"] = of.indices.iter().map(record).collect();
    fact
}

pub(super) fn rows(of: &Contributions, seed: u64) -> Vec<Vec<String>> {
    let names = "delta_cd of first_order first_order_lower first_order_upper total total_lower total_upper";
    fact::rows(&json(of, seed), "indices", names)
}

/// The table with its remarks.
#[must_use]
pub fn blocks(of: &Contributions) -> Vec<Block> {
    let mut last = "";
    // a value equal to the one above is left out
    let quantities = of
        .indices
        .iter()
        .map(|of| if std::mem::replace(&mut last, of.delta_cd) == of.delta_cd { "" } else { of.delta_cd });
    let table = Table::of(quantities.zip(&of.indices))
        .text("variance of", |(quantity, _)| key_in_words(quantity))
        .text("comes from", |(_, of)| key_in_words(of.of))
        .number("alone", |(_, of)| value(of.first_order))
        .number("95 %", |(_, of)| interval(of.first_order))
        .number("with others", |(_, of)| value(of.total))
        .number("95 %", |(_, of)| interval(of.total))
        .column_if(true, super::Column::text("█ alone, ░ with others").unless_narrow(), |(_, of)| bar(of))
        .block();
    vec![table, Block::Remark(note(of))]
}

/// How many of the independent racks are inside the limits, for people; `None` without limits.
#[must_use]
pub fn inside(of: &Contributions) -> Option<Block> {
    let (inside, all) = (of.inside?, 2 * of.samples);
    let share = 100.0 * inside as f64 / all.max(1) as f64;
    let said = format!(
        "{inside} of {all} random racks stay within the limits along the stroke: {share:.2} %; the verdict here is not theirs"
    );
    Some(Block::Remark(said))
}

/// The definition of the shares, and how they were computed.
fn note(of: &Contributions) -> String {
    let Contributions { samples, asked, racks, .. } = of;
    let early =
        if samples < asked { format!("interrupted after {samples} of {asked} samples: ") } else { String::new() };
    let of = format!("{samples} samples of pseudo-random numbers, {racks} racks by the exact mesh");
    format!(
        "{early}shares of the variance are Sobol indices: alone of first order ({FIRST_ORDER}), with others total ({TOTAL}); {of}; \
         intervals by bootstrap ({RESAMPLES} resamples, percentiles)"
    )
}

/// Bars of all shares with their intervals.
#[must_use]
pub fn chart(of: &Contributions, title: &str) -> Chart {
    let rows = || of.indices.iter().enumerate();
    let bars = |which: fn(&Contribution) -> Option<Estimate>, from: f64| {
        let bar = |(row, of): (usize, &Contribution)| {
            let Estimate { value, .. } = which(of)?;
            let (low, high) = (row as f64 + from, row as f64 + from + 0.36);
            Some(Bar { left: value.min(0.0), right: value.max(0.0), low, high, text: String::new() })
        };
        Shape::Bars(rows().filter_map(bar).collect())
    };
    let intervals = |(row, of): (usize, &Contribution)| {
        let both = [(of.first_order, 0.3), (of.total, 0.66)].map(|(of, at)| (of, row as f64 + at));
        let bar = |(of, at): (Option<Estimate>, f64)| {
            let Estimate { value, lower, upper } = of?;
            Some(Bar { left: lower, right: upper, low: at, high: at + 0.04, text: format!("{} %", percent(value)) })
        };
        both.into_iter().filter_map(bar).collect::<Vec<_>>()
    };
    let name = |of: &Contribution| format!("{}: {}", key_in_words(of.delta_cd), key_in_words(of.of));
    Chart {
        title: title.to_owned(),
        x: Axis { label: "share of the variance of ΔCD along the stroke".to_owned(), scale: Scale::Airy },
        y: Axis { label: "variance of: from".to_owned(), scale: Scale::Names(of.indices.iter().map(name).collect()) },
        layers: vec![
            Layer::new("alone", bars(|of| of.first_order, 0.14)),
            Layer::new("with others", bars(|of| of.total, 0.5)),
            Layer::new("95 % interval", Shape::Bars(rows().flat_map(intervals).collect())),
        ],
        height: 150.0 + 40.0 * of.indices.len() as f64,
        ..Chart::default()
    }
}
