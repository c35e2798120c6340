//! A yoke on random racks: distributions, shares, and one plug for all of them.

use serde_json::{Map, Value, json};

use super::super::number::{grouped, percent, tidy};
use super::super::{Block, Table};
use super::{setting_json, settings_in_words};
use crate::chance::racks::{Inside, RackStatistics, RackYoke, RacksSummary, SharedPlug, YokeSummary};
use crate::function::{Bounds, Setting, Target, YokeJudge};
use crate::judge::Verdict;

/// A yoke on random racks.
#[derive(Debug, Clone, Copy)]
pub(in crate::report) struct RacksYokePart<'a> {
    pub(in crate::report) judge: &'a YokeJudge,
    pub(in crate::report) racks: &'a RacksSummary,
    pub(in crate::report) yoke: &'a YokeSummary,
}

/// The columns that a yoke adds to a list of racks.
pub(in crate::report) const RACK_YOKE_COLUMNS: &str =
    ",setting_from_mm,setting_to_mm,torque_fluctuation_n_m,lift_off_force_n";

/// The values of these columns.
pub(in crate::report) fn rack_values(yoke: &RackYoke) -> [Option<f64>; 4] {
    let setting = yoke.settings.flatten();
    let to_mm = setting.and_then(|setting| setting.to_mm);
    [setting.map(|setting| setting.from_mm), to_mm, yoke.fluctuation_n_m, yoke.lift_off_n]
}

/// A distribution whose values are not in mm.
fn in_unit(of: &RackStatistics, unit: &str) -> Value {
    fn renamed(value: Value, unit: &str) -> Value {
        match value {
            Value::Object(facts) => {
                let name = |key: String| key.strip_suffix("_mm").map(|name| format!("{name}_{unit}")).unwrap_or(key);
                facts.into_iter().map(|(key, value)| (name(key), renamed(value, unit))).collect::<Map<_, _>>().into()
            }
            Value::Array(all) => all.into_iter().map(|value| renamed(value, unit)).collect(),
            other => other,
        }
    }
    renamed(json!(of), unit)
}

/// A share with its confidence interval.
fn share_in_words(of: &Inside) -> [String; 3] {
    [of.share, of.lower, of.upper].map(|share| format!("{:.2} %", 100.0 * share))
}

impl RacksYokePart<'_> {
    /// The distributions that are not of ΔCD: name for programs, for people, unit of JSON's keys.
    fn distributions(&self) -> impl Iterator<Item = (&'static str, &'static str, &'static str, &RackStatistics)> {
        let [fluctuation, lift_off] = [Target::TorqueFluctuation, Target::LiftOffForce];
        let all = [(fluctuation, "n_m", &self.yoke.fluctuation), (lift_off, "n", &self.yoke.lift_off)];
        all.into_iter().filter_map(|(on, unit, of)| Some((on.name(), on.words(), unit, of.as_ref()?)))
    }

    fn limits(&self) -> impl Iterator<Item = (Target, Bounds, Option<Inside>)> {
        self.judge.limits.iter().map(|&(on, bounds)| {
            let place = Target::ALL.iter().position(|target| *target == on);
            (on, bounds, place.and_then(|place| *self.yoke.limits.get(place)?))
        })
    }

    /// For programs.
    pub(in crate::report) fn json(&self) -> Value {
        let shared = self.yoke.shared.map(|SharedPlug { setting, suits, confidence }| {
            let mut json = setting_json(&self.judge.yoke, setting.as_setting());
            json["suits"] = json!(suits);
            json["confidence_interval"] = json!(confidence.map(|of| {
                let degrees = |mm: Option<f64>| mm.and_then(|mm| self.judge.yoke.degrees(mm));
                let Setting { from_mm, to_mm } = of;
                let [from_deg, to_deg] = [degrees(Some(from_mm)), degrees(to_mm)];
                json!({ "from_mm": from_mm, "to_mm": to_mm, "from_deg": from_deg, "to_deg": to_deg })
            }));
            json
        });
        let limits = self.limits().map(|(on, Bounds { lower, upper }, inside)| {
            json!({ "on": on.name(), "unit": on.unit(), "lower": lower, "upper": upper, "inside_limit": inside })
        });
        let mut json = json!({
            "racks": self.yoke.racks,
            "without_setting": self.yoke.without,
            "shared_setting": shared,
            "variation": self.racks.peak_to_peak,
            "torque_fluctuation": null,
            "lift_off_force": null,
            "limits": limits.collect::<Vec<_>>(),
        });
        for (name, _, unit, of) in self.distributions() {
            json[name] = in_unit(of, unit);
        }
        json
    }

    /// Moments and quantiles for programs, with the columns of their values.
    pub(in crate::report) fn records(&self) -> Vec<Value> {
        let of_one = |(name, _, unit, of): (&str, _, &str, &RackStatistics)| {
            let moments = [("mean", Some(of.mean_mm)), ("standard_deviation", of.standard_deviation_mm)];
            let moments = moments.map(|(of, value)| {
                let mut record = json!({ "delta_cd": name, "statistic": of });
                record[format!("value_{unit}")] = value.into();
                record
            });
            let json = in_unit(of, unit);
            let quantiles = json["quantiles"].as_array().cloned().unwrap_or_default().into_iter().map(|mut record| {
                record["delta_cd"] = name.into();
                record["statistic"] = format!("quantile_{}", record["share"]).into();
                record
            });
            moments.into_iter().chain(quantiles).collect::<Vec<_>>()
        };
        self.distributions().flat_map(of_one).collect()
    }

    /// For people: what is counted, and one plug for all.
    pub(in crate::report) fn blocks(&self) -> Vec<Block> {
        let distributions = self.distributions().flat_map(|(_, words, unit, of)| {
            let (unit, decimals) = if unit == "n" { ("N", 1) } else { ("N m", 4) };
            let number = move |value: Option<f64>| {
                value.map_or_else(|| "?".to_owned(), |value| format!("{:.decimals$}", tidy(value)))
            };
            let deviation = [number(of.standard_deviation_mm), String::new()];
            let moments = (format!("{words} [{unit}]: mean, σ"), number(Some(of.mean_mm)), deviation);
            let quantiles = of.quantiles.iter().map(move |quantile| {
                let ends = [quantile.lower_mm, quantile.upper_mm].map(number);
                (format!("  {}", percent(quantile.share)), number(Some(quantile.value_mm)), ends)
            });
            std::iter::once(moments).chain(quantiles)
        });
        let distributions = Table::of(distributions)
            .text("yoke", |(name, ..)| name.clone())
            .number("value", |(_, value, _)| value.clone())
            .number("95 % from", |(.., [from, _])| from.clone())
            .number("to", |(.., [_, to])| to.clone())
            .block_if_any();
        distributions.into_iter().chain(self.plug_table()).collect()
    }

    fn plug_table(&self) -> Option<Block> {
        let without = self.yoke.without?;
        let words = |setting: Setting| settings_in_words(&self.judge.yoke, Some(setting), "");
        let counted = |of: Inside| [grouped(of.racks)].into_iter().chain(share_in_words(&of)).collect::<Vec<_>>();
        let best = match &self.yoke.shared {
            None => vec![("setting that suits the most racks", "none".to_owned(), Vec::new())],
            Some(SharedPlug { setting, suits, confidence }) => vec![
                ("setting that suits the most racks", words(setting.as_setting()), counted(*suits)),
                ("best setting, with 95 % confidence", confidence.map_or("?".to_owned(), words), Vec::new()),
            ],
        };
        let rows = best.into_iter().chain([("no setting suits", String::new(), counted(without))]);
        let cell = |counted: &[String], index: usize| counted.get(index).cloned().unwrap_or_default();
        Some(
            Table::of(rows)
                .text("one plug for all", |(name, ..)| *name)
                .number("play and angle", |(_, setting, _)| setting.clone())
                .number("racks", move |(.., counted)| cell(counted, 0))
                .number("share", move |(.., counted)| cell(counted, 1))
                .number("95 % from", move |(.., counted)| cell(counted, 2))
                .number("to", move |(.., counted)| cell(counted, 3))
                .block(),
        )
    }

    /// How many racks keep each limit that they were judged by.
    pub(in crate::report) fn verdicts(&self, all: u64) -> Vec<Block> {
        let verdict = |(on, bounds, inside): (Target, Bounds, Option<Inside>)| {
            let inside = inside?;
            let [share, from, to] = share_in_words(&inside);
            let (racks, limit) = (inside.racks, bounds.in_words(on.unit()));
            let text = format!(
                "{}: {racks} of {all} {keep} the limit ({limit}): {share}, 95 % confidence {from} … {to}",
                on.words(),
                keep = if all == 1 { "rack keeps" } else { "racks keep" }
            );
            let is_kept = inside.racks == all && self.racks.missing.is_empty();
            let verdict = if inside.share < 1.0 { Some(Verdict::Fail) } else { is_kept.then_some(Verdict::Pass) };
            Some(Block::Verdict(verdict, text))
        };
        self.limits().filter_map(verdict).collect()
    }
}
