//! The report of `monte-carlo`: how ΔCD of randomly deviating racks is distributed.

use serde_json::{Value, json};

use super::number::{millimetres, plain, tidy};
use super::{Block, Column, Report, Table};
use crate::chance::racks::{Quantile, RackResult, RackSettings, STEPS_PER_PITCH, Scatter, quantiles, share};
use crate::judge::class::ErrorClass;
use crate::judge::{Limit, Verdict};
use crate::quantity::Length;
use crate::uncertainty::{Distribution, Uncertainty};

/// The shares whose quantiles are printed.
const SHARES: [f64; 7] = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99];
/// Bins of a histogram.
const BINS: usize = 20;

/// Randomly deviating racks, solved.
#[derive(Debug)]
pub struct RacksReport<'a> {
    /// The spec's title.
    pub title: Option<&'a str>,
    /// How the teeth scatter.
    pub scatter: &'a Scatter,
    /// What classes came to.
    pub classes: &'a [ErrorClass],
    /// Seed, number and stroke.
    pub settings: &'a RackSettings,
    /// One per rack; fewer than asked for if the run was interrupted.
    pub results: &'a [RackResult],
    /// Limits of ΔCD along the stroke.
    pub limit: Option<&'a Limit>,
    /// Remarks.
    pub notes: Vec<String>,
}

/// A bin of a histogram: from, to, count.
type Bin = (f64, f64, usize);

type Quantity = (&'static str, &'static str, fn(&RackResult) -> f64);

const QUANTITIES: [Quantity; 4] = [
    ("mean", "mean", |result| result.mean_mm),
    ("peak_to_peak", "peak to peak", RackResult::peak_to_peak_mm),
    ("smallest", "smallest", |result| result.min_mm),
    ("largest", "largest", |result| result.max_mm),
];

fn histogram(values: &[f64]) -> Vec<Bin> {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let width = (high - low) / BINS as f64;
    if width.is_nan() || width <= 0.0 {
        return vec![(low, high, values.len())];
    }
    let mut counts = [0_usize; BINS];
    for value in values {
        let bin = ((value - low) / width) as usize;
        counts[bin.min(BINS - 1)] += 1;
    }
    let edge = |bin: usize| low + width * bin as f64;
    counts.iter().enumerate().map(|(bin, &count)| (edge(bin), edge(bin + 1), count)).collect()
}

fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    (mean, (squares / (n - 1.0).max(1.0)).sqrt())
}

impl RacksReport<'_> {
    fn values(&self, of: fn(&RackResult) -> f64) -> Vec<f64> {
        self.results.iter().map(of).collect()
    }

    /// How many racks stay within the limits along the whole stroke.
    fn inside(&self) -> Option<usize> {
        let limit = self.limit?;
        let (lower, upper) = (limit.lower.map(Length::mm), limit.upper.map(Length::mm));
        let inside = |result: &&RackResult| {
            lower.is_none_or(|lower| lower <= tidy(result.min_mm))
                && upper.is_none_or(|upper| tidy(result.max_mm) <= upper)
        };
        Some(self.results.iter().filter(inside).count())
    }

    /// Whether the run ended before the last rack.
    #[must_use]
    pub fn is_interrupted(&self) -> bool {
        self.results.len() < self.settings.racks
    }

    /// Fail if any rack leaves the limits, `None` without limits, and where racks are missing and none of the others
    /// fails.
    #[must_use]
    pub fn verdict(&self) -> Option<Verdict> {
        match self.inside()? {
            inside if inside < self.results.len() => Some(Verdict::Fail),
            _ if self.is_interrupted() => None,
            _ => Some(Verdict::Pass),
        }
    }

    fn spreads(&self) -> Vec<(&'static str, Uncertainty, bool)> {
        let Scatter {
            rack_pitch,
            rack_thickness,
            rack_lead,
            rack_over_roller,
            pinion_pitch,
            pinion_thickness,
            pinion_lead,
            pinion_runout,
        } = *self.scatter;
        [
            ("rack_pitch", rack_pitch, false),
            ("rack_thickness", rack_thickness, false),
            ("rack_lead", rack_lead, true),
            ("rack_over_roller", rack_over_roller, false),
            ("pinion_pitch", pinion_pitch, false),
            ("pinion_thickness", pinion_thickness, false),
            ("pinion_lead", pinion_lead, false),
            ("pinion_runout", pinion_runout, false),
        ]
        .into_iter()
        .filter_map(|(key, spread, is_angle)| Some((key, spread?, is_angle)))
        .collect()
    }

    fn scatter_table(&self) -> Table {
        let rows = self.spreads().into_iter().map(|(key, spread, is_angle)| {
            let amount = |value: f64| {
                if is_angle {
                    format!("{:.3}′", value * 180.0 * 60.0 / std::f64::consts::PI)
                } else {
                    format!("{:.2} µm", 1000.0 * value)
                }
            };
            let text = match spread.distribution {
                Distribution::Normal => format!("normal, σ = {}", amount(spread.standard)),
                other => format!("{}, ± {}", other.name(), amount(spread.standard * other.half_width())),
            };
            vec![key.replace('_', " "), text]
        });
        Table { rows: rows.collect(), columns: vec![Column::text("scatter per tooth"), Column::text("drawn")] }
    }

    fn quantile_table(&self) -> Table {
        let rows = QUANTITIES.iter().flat_map(|(_, name, of)| {
            let values = self.values(*of);
            let (mean, deviation) = moments(&values);
            let mut rows =
                vec![vec![format!("{name}: mean, σ"), millimetres(mean), format!("{:.4}", deviation), String::new()]];
            let chosen: &[f64] = if *name == "mean" || *name == "peak to peak" { &SHARES } else { &[0.01, 0.5, 0.99] };
            rows.extend(quantiles(&values, chosen).into_iter().map(|quantile| {
                let end = |end: Option<f64>| end.map_or_else(|| "?".to_owned(), millimetres);
                vec![
                    format!("  {:.0} %", 100.0 * quantile.share),
                    millimetres(quantile.value),
                    end(quantile.lower),
                    end(quantile.upper),
                ]
            }));
            rows
        });
        Table {
            rows: rows.collect(),
            columns: vec![
                Column::text("ΔCD along the stroke"),
                Column::number("value\n[mm]"),
                Column::number("95 % from\n[mm]"),
                Column::number("to\n[mm]"),
            ],
        }
    }

    fn histograms(&self) -> Vec<Block> {
        const WIDTH: usize = 40;
        QUANTITIES[..2]
            .iter()
            .map(|(_, name, of)| {
                let bins = histogram(&self.values(*of));
                let most = bins.iter().map(|(_, _, count)| *count).max().unwrap_or(1).max(1);
                let mut text = format!("{name} of ΔCD [mm], racks\n");
                for (from, _, count) in bins {
                    let bar = "█".repeat((count * WIDTH).div_ceil(most));
                    text.push_str(&format!("{} {bar} {count}\n", millimetres(from)));
                }
                Block::Drawing(text.trim_end().to_owned())
            })
            .collect()
    }

    fn all_notes(&self) -> Vec<String> {
        let RackSettings { seed, from_mm, to_mm, .. } = self.settings;
        let mut notes = vec![format!(
            "{} racks by the exact mesh, stroke {} … {} mm, {STEPS_PER_PITCH:.0} strokes per pitch, seed {seed}; quantiles with distribution-free 95 % confidence intervals (order statistics)",
            self.results.len(),
            plain(*from_mm),
            plain(*to_mm)
        )];
        if self.is_interrupted() {
            let (solved, asked) = (self.results.len(), self.settings.racks);
            notes.push(format!(
                "interrupted: {solved} of the {asked} racks asked for were solved, and the result is of these"
            ));
        }
        notes.extend(self.classes.iter().map(|class| {
            format!(
                "{} {} of {}: every value within it is taken to be as probable as any other",
                class.kind,
                class.permissible.length(),
                class.permissible.standard
            )
        }));
        notes.extend(self.notes.iter().cloned());
        notes
    }
}

fn quantile_json(quantile: &Quantile) -> Value {
    json!({
        "share": quantile.share,
        "value_mm": tidy(quantile.value),
        "lower_mm": quantile.lower.map(tidy),
        "upper_mm": quantile.upper.map(tidy),
    })
}

impl Report for RacksReport<'_> {
    fn json(&self) -> Value {
        let of: serde_json::Map<_, _> = QUANTITIES
            .iter()
            .map(|(key, _, of)| {
                let values = self.values(*of);
                let (mean, deviation) = moments(&values);
                let histogram: Vec<_> = histogram(&values)
                    .into_iter()
                    .map(|(from, to, count)| json!({ "from_mm": tidy(from), "to_mm": tidy(to), "racks": count }))
                    .collect();
                let value = json!({
                    "mean_mm": mean,
                    "standard_deviation_mm": deviation,
                    "quantiles": quantiles(&values, &SHARES).iter().map(quantile_json).collect::<Vec<_>>(),
                    "histogram": histogram,
                });
                ((*key).to_owned(), value)
            })
            .collect();
        let inside = self.inside().map(|inside| {
            let (value, lower, upper) = share(inside, self.results.len());
            json!({ "racks": inside, "share": value, "lower": lower, "upper": upper })
        });
        json!({
            "title": self.title,
            "seed": self.settings.seed,
            "racks": self.results.len(),
            "interrupted": self.is_interrupted(),
            "from_mm": self.settings.from_mm,
            "to_mm": self.settings.to_mm,
            "confidence": 0.95,
            "scatter": self.spreads().iter().map(|(key, spread, is_angle)| json!({
                "of": key,
                "distribution": spread.distribution.name(),
                "standard_deviation_mm": (!is_angle).then_some(spread.standard),
                "standard_deviation_rad": is_angle.then_some(spread.standard),
            })).collect::<Vec<_>>(),
            "delta_cd": of,
            "inside_limits": inside,
            "verdict": self.verdict().map(Verdict::name),
            "notes": self.all_notes(),
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let header = ["rack", "mean_mm", "peak_to_peak_mm", "min_mm", "max_mm"].map(str::to_owned).to_vec();
        let rows = self.results.iter().enumerate().map(|(rack, result)| {
            let RackResult { mean_mm, min_mm, max_mm } = *result;
            let mut row = vec![rack.to_string()];
            row.extend([mean_mm, result.peak_to_peak_mm(), min_mm, max_mm].map(|value| plain(tidy(value))));
            row
        });
        std::iter::once(header).chain(rows).collect()
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = Vec::new();
        if let Some(title) = self.title {
            blocks.push(Block::Title(title.to_owned()));
        }
        blocks.push(Block::Table(self.scatter_table()));
        blocks.push(Block::Table(self.quantile_table()));
        blocks.extend(self.histograms());
        blocks.extend(self.all_notes().into_iter().map(|note| Block::Note(format!("note: {note}"))));
        if let Some(inside) = self.inside() {
            let (value, lower, upper) = share(inside, self.results.len());
            let sentence = format!(
                "{inside} of {} racks stay within the limits along the stroke: {:.2} %, 95 % confidence {:.2} … {:.2} %",
                self.results.len(),
                100.0 * value,
                100.0 * lower,
                100.0 * upper
            );
            blocks.push(match self.verdict() {
                Some(verdict) => Block::Verdict(verdict, sentence),
                None => Block::Open(sentence),
            });
        }
        blocks
    }
}
