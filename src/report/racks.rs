//! The report of `monte-carlo`: how ΔCD of randomly deviating racks is distributed.

use std::f64::consts::FRAC_1_SQRT_2;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::chart::{Axis, Chart, Layer, Scale, Shape};
use super::fact::FORMAT_VERSION;
use super::function::{RACK_YOKE_COLUMNS, RacksYokePart, rack_values};
use super::number::{counted, millimetres, percent, plain, tidy, unsigned};
use super::{Block, Report, Table, contributions, fact, titled};
use crate::chance::racks::{
    Bin, CONFIDENCE, Contributions, Inside, MOST_BINS, RackRange, RackResult, RackStatistics, RacksStudy, RacksSummary,
    STEPS_PER_PITCH, Scatter, StudyError,
};
use crate::deviation::{DeviationKind, key_in_words};
use crate::function::YokeJudge;
use crate::judge::class::ErrorClass;
use crate::judge::{Limit, Verdict};
use crate::mesh::TOLERANCE_MM;
use crate::quantity::Length;
use crate::uncertainty::{Distribution, Uncertainty};

/// Randomly deviating racks, solved.
#[derive(Debug)]
pub struct RacksReport<'a> {
    /// The spec's title.
    pub title: Option<&'a str>,
    /// How the teeth scatter.
    pub scatter: &'a Scatter,
    /// The permissible values of classes.
    pub classes: &'a [ErrorClass],
    /// The racks, counted.
    pub study: &'a RacksStudy,
    /// Their summary.
    pub summary: &'a RacksSummary,
    /// The yoke and its limits, if there is one.
    pub yoke: Option<&'a YokeJudge>,
    /// Where the spread comes from, if that was asked for.
    pub contributions: Option<&'a Contributions>,
    /// Remarks.
    pub notes: Vec<String>,
    /// Limits of the spec that racks are not judged by, so that no rack passes.
    pub unjudged: Vec<String>,
}

impl RacksReport<'_> {
    /// The scatter as drawn.
    fn spreads(&self) -> impl Iterator<Item = (&'static str, Uncertainty)> {
        self.scatter.spreads().into_iter().filter_map(|(of, drawn)| Some((of, drawn?)))
    }

    fn scatter_table(&self) -> Block {
        let drawn = |(of, drawn): &(&str, Uncertainty)| {
            let amount = |value: f64| {
                if is_angle(of) {
                    format!("{:.3}′", value * 180.0 * 60.0 / std::f64::consts::PI)
                } else {
                    format!("{:.2} µm", 1000.0 * value)
                }
            };
            match drawn.distribution {
                Distribution::Normal => {
                    let each = if *of == "pinion_runout" { " in each of two directions" } else { "" };
                    format!("normal, σ = {}{each}", amount(drawn.standard))
                }
                other if is_difference(of) => {
                    let half = drawn.standard * other.half_width();
                    format!("places {}, ± {}: no pitch beyond ± {}", other.name(), amount(0.5 * half), amount(half))
                }
                other => format!("{}, ± {}", other.name(), amount(drawn.standard * other.half_width())),
            }
        };
        Table::of(self.spreads()).text("scatter per tooth", |(of, _)| key_in_words(of)).text("drawn", drawn).block()
    }

    fn quantile_table(&self) -> Block {
        const FEW: [f64; 3] = [0.01, 0.5, 0.99];
        let or_unknown = |text: Option<String>| text.unwrap_or_else(|| "?".to_owned());
        let rows = self.quantities().into_iter().flat_map(|(name, of)| {
            let is_short = matches!(name, "smallest" | "largest");
            // no peak to peak is negative
            let length = if name == "peak_to_peak" { unsigned } else { millimetres };
            let title = if name == "mean" { name.to_owned() } else { format!("{}, mean", key_in_words(name)) };
            let deviation = or_unknown(of.standard_deviation_mm.map(unsigned));
            let moments = (title, length(of.mean_mm), deviation, [String::new(), String::new()]);
            let shown = of.quantiles.iter().filter(move |quantile| !is_short || FEW.contains(&quantile.share));
            let quantiles = shown.map(move |quantile| {
                let ends = [quantile.lower_mm, quantile.upper_mm].map(|end| or_unknown(end.map(length)));
                (format!("  {}", percent(quantile.share)), length(quantile.value_mm), String::new(), ends)
            });
            std::iter::once(moments).chain(quantiles)
        });
        Table::of(rows)
            .text("ΔCD along the stroke", |(name, ..)| name.clone())
            .number("value\n[mm]", |(_, value, ..)| value.clone())
            .number("σ\n[mm]", |(.., deviation, _)| deviation.clone())
            .number("95 % from\n[mm]", |(.., [from, _])| from.clone())
            .number("to\n[mm]", |(.., [_, to])| to.clone())
            .block()
    }

    fn yoke(&self) -> Option<RacksYokePart<'_>> {
        let yoke = self.summary.yoke.as_ref()?;
        Some(RacksYokePart { judge: self.yoke?, racks: self.summary, yoke })
    }

    /// The quantities counted of the racks, in the order of the reports.
    fn quantities(&self) -> [(&'static str, &RackStatistics); 4] {
        let RacksSummary { mean, peak_to_peak, smallest, largest, .. } = self.summary;
        [("mean", mean), ("peak_to_peak", peak_to_peak), ("smallest", smallest), ("largest", largest)]
    }

    fn histograms(&self) -> Vec<Block> {
        const WIDTH: u128 = 40;
        [("mean", &self.summary.mean), ("peak to peak", &self.summary.peak_to_peak)]
            .map(|(name, of)| {
                let most = of.histogram.iter().map(|bin| bin.racks).max().unwrap_or(1).max(1);
                let length = if name == "mean" { millimetres } else { unsigned };
                let mut text = format!("{name} of ΔCD [mm], racks\n");
                for Bin { from_mm, racks, .. } in &of.histogram {
                    let bar = "█".repeat((u128::from(*racks) * WIDTH).div_ceil(most.into()) as usize);
                    text.push_str(&format!("{} {bar} {racks}\n", length(*from_mm)));
                }
                Block::Drawing(text.trim_end().to_owned())
            })
            .into()
    }

    /// The distributions of the smallest, mean and largest ΔCD of the racks, with the limit on ΔCD; or where the spread comes from.
    #[must_use]
    pub fn chart(&self, limit: Option<&Limit>) -> Chart {
        if let Some(contributions) = self.contributions {
            return contributions::chart(contributions, self.title.unwrap_or("Where the spread of ΔCD comes from"));
        }
        let RacksSummary { smallest, mean, largest, .. } = self.summary;
        let outline = |name, of: &RackStatistics| Layer::new(name, Shape::Line(outline(&of.histogram)));
        let ends = limit.copied().into_iter().flat_map(Limit::ends);
        Chart {
            title: self.title.unwrap_or("ΔCD of random racks").to_owned(),
            x: Axis { label: "ΔCD [mm]".to_owned(), scale: Scale::Airy },
            y: Axis { label: "racks per µm".to_owned(), scale: Scale::Airy },
            layers: vec![
                outline("smallest along the stroke", smallest),
                outline("mean", mean),
                outline("largest", largest),
                Layer::new("limits", Shape::LimitsOnX(ends.map(Length::mm).collect())),
            ],
            ..Chart::default()
        }
    }

    /// Why the verdict is open, where a limit of the spec is not judged.
    fn reason(&self) -> Option<String> {
        (self.summary.verdict.is_none() && !self.unjudged.is_empty()).then(|| self.unjudged.join("; "))
    }

    fn all_notes(&self) -> Vec<String> {
        let (of, asked) = (self.study.study_of(), self.study.asked());
        let from = if asked.first_rack == 0 { String::new() } else { format!(" from number {}", asked.first_rack) };
        let followed = match self.yoke {
            Some(_) => format!("resolved to {} mm", plain(TOLERANCE_MM)),
            None => format!("{STEPS_PER_PITCH:.0} strokes per pitch"),
        };
        let mut notes = vec![format!(
            "{}{from} by the exact mesh, stroke {} … {} mm, {followed}, seed {}; quantiles with distribution-free 95 % confidence intervals (order statistics)",
            counted(self.study.racks(), "rack"),
            plain(of.from_mm),
            plain(of.to_mm),
            of.seed
        )];
        let missing = &self.summary.missing;
        let error = self.quantities().into_iter().map(|(_, of)| of.quantile_error_mm).fold(0.0, f64::max);
        if error > 0.0 {
            notes.push(format!(
                "quantiles are exact to ± {} mm, and their intervals hold: lengths are counted in {MOST_BINS} bins at most",
                plain(error)
            ));
        }
        if !missing.is_empty() {
            let (solved, asked) = (self.study.racks(), asked.racks);
            notes.push(format!(
                "interrupted, or ranges are missing: {solved} of the {asked} racks asked for were solved, and the result is of these; missing: {}",
                listed(missing)
            ));
        }
        notes.extend(self.classes.iter().map(|class| {
            let drawn = match class.kind {
                DeviationKind::RackPitch | DeviationKind::PinionPitch => {
                    "every place of a tooth within half of it is as probable as any other, so that no pitch exceeds it; \
                     parts with larger sums of pitches may conform, too"
                }
                _ => "every value within it is taken to be as probable as any other",
            };
            format!("{} {} of {}: {drawn}", class.kind, class.permissible.length(), class.permissible.standard)
        }));
        notes.extend(self.notes.iter().chain(&self.unjudged).cloned());
        notes
    }
}

/// Whether it is an angle; else it is a length.
fn is_angle(of: &str) -> bool {
    of == "rack_lead"
}

/// Whether it is the difference of the drawn places of two teeth.
fn is_difference(of: &str) -> bool {
    matches!(of, "rack_pitch" | "pinion_pitch")
}

/// The outline of a histogram: racks per µm against mm, so that bins of other widths compare.
fn outline(bins: &[Bin]) -> Vec<(f64, f64)> {
    const MICROMETRES: f64 = 1000.0;
    let (first, last) = (bins.first(), bins.last());
    let tops = bins.iter().flat_map(|bin| {
        let height = bin.racks as f64 / (MICROMETRES * (bin.to_mm - bin.from_mm));
        [(bin.from_mm, height), (bin.to_mm, height)]
    });
    let ends = |end: Option<f64>| end.map(|mm| (mm, 0.0));
    ends(first.map(|bin| bin.from_mm)).into_iter().chain(tops).chain(ends(last.map(|bin| bin.to_mm))).collect()
}

/// Ranges, the first of them by name.
fn listed(ranges: &[RackRange]) -> String {
    const SHOWN: usize = 10;
    let named: Vec<_> = ranges.iter().take(SHOWN).map(ToString::to_string).collect();
    let more = if ranges.len() > SHOWN { format!(" and {} ranges more", ranges.len() - SHOWN) } else { String::new() };
    named.join(", ") + &more
}

/// The columns of a list of racks.
#[must_use]
pub fn rack_columns(has_yoke: bool) -> String {
    format!("rack,mean_mm,peak_to_peak_mm,min_mm,max_mm{}\n", if has_yoke { RACK_YOKE_COLUMNS } else { "" })
}

/// The lines of a list of racks, from number `first_rack` on.
#[must_use]
pub fn rack_lines(first_rack: u64, results: &[RackResult]) -> String {
    let mut lines = String::new();
    for (rack, result) in (first_rack..).zip(results) {
        let RackResult { mean_mm, min_mm, max_mm, yoke } = result;
        let values = [*mean_mm, result.peak_to_peak_mm(), *min_mm, *max_mm].map(Some).into_iter();
        let values = values.chain(yoke.iter().flat_map(rack_values));
        let values: Vec<_> = values.map(|value| value.map_or_else(String::new, |value| plain(tidy(value)))).collect();
        lines.push_str(&format!("{rack},{}\n", values.join(",")));
    }
    lines
}

/// The content of a study's file.
#[derive(Serialize, Deserialize)]
struct StudyFile<S> {
    format_version: u32,
    holds: String,
    study: S,
}

/// The kind that such a file names.
const HOLDS: &str = "random racks";

/// A study as JSON, for merging.
///
/// # Errors
/// None for a valid study.
pub fn study_json(study: &RacksStudy) -> Result<String, serde_json::Error> {
    let file = StudyFile { format_version: FORMAT_VERSION, holds: HOLDS.to_owned(), study };
    Ok(serde_json::to_string(&file)? + "\n")
}

/// Reads what [`study_json`] has written.
///
/// # Errors
/// Why the text is no study.
pub fn read_study(text: &str) -> Result<RacksStudy, StudyFileError> {
    let file: StudyFile<RacksStudy> = serde_json::from_str(text)?;
    if file.holds != HOLDS {
        return Err(StudyFileError::OtherContent(file.holds));
    }
    if file.format_version != FORMAT_VERSION {
        return Err(StudyFileError::OtherVersion(file.format_version));
    }
    file.study.check()?;
    Ok(file.study)
}

/// Why a text is no study.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyFileError {
    /// It is not JSON, or not the JSON of a study.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// It has another kind of content.
    #[error("it holds {0:?}, not {HOLDS:?}")]
    OtherContent(String),
    /// It is of another version of the program.
    #[error("its format_version is {0}, and this program reads {FORMAT_VERSION}")]
    OtherVersion(u32),
    /// Its content is inconsistent.
    #[error(transparent)]
    Study(#[from] StudyError),
}

impl Report for RacksReport<'_> {
    fn json(&self) -> Value {
        let RacksSummary { inside, verdict, missing, .. } = self.summary;
        let yoke = self.yoke();
        let of = self.study.study_of();
        let scatter = self.spreads().map(|(of, drawn)| {
            let is_normal = drawn.distribution == Distribution::Normal;
            // the difference of two places, each within half of it
            let standard = if is_difference(of) && !is_normal { FRAC_1_SQRT_2 } else { 1.0 } * drawn.standard;
            let key = if is_angle(of) { "standard_deviation_rad" } else { "standard_deviation_mm" };
            let mut fact = json!({
                "of": of,
                "distribution": drawn.distribution.name(),
                // whether that is the distribution of the places of teeth, whose differences are what scatters
                "of_places": is_difference(of),
                "standard_deviation_mm": null,
                "standard_deviation_rad": null,
            });
            fact[key] = standard.into();
            fact
        });
        let delta_cd = self.quantities().into_iter().map(|(name, of)| (name.to_owned(), json!(of)));
        let mut json = json!({
            "title": self.title,
            "seed": of.seed,
            "first_rack": self.study.asked().first_rack,
            "racks": self.study.racks(),
            "interrupted": !missing.is_empty(),
            "missing": missing,
            "from_mm": of.from_mm,
            "to_mm": of.to_mm,
            "confidence": CONFIDENCE,
            "scatter": scatter.collect::<Vec<_>>(),
            "delta_cd": delta_cd.collect::<Map<_, _>>(),
            "inside_limits": inside,
            "yoke": yoke.map(|yoke| yoke.json()),
            "verdict": verdict.map(Verdict::name),
            "reason": self.reason(),
            "notes": self.all_notes(),
        });
        if let Some(found) = self.contributions {
            json["contributions"] = contributions::json(found, of.seed);
        }
        json
    }

    /// Moments and quantiles: results of racks are not kept, [`rack_columns`] are written while they are there. Or contributions.
    fn rows(&self) -> Vec<Vec<String>> {
        if let Some(found) = self.contributions {
            return contributions::rows(found, self.study.study_of().seed);
        }
        let records = self.quantities().into_iter().flat_map(|(name, of)| {
            let moments = [("mean", Some(of.mean_mm)), ("standard_deviation", of.standard_deviation_mm)];
            let moments = moments.map(|(of, value)| json!({ "delta_cd": name, "statistic": of, "value_mm": value }));
            let quantiles = of.quantiles.iter().map(move |quantile| {
                let mut record = json!(quantile);
                record["delta_cd"] = name.into();
                record["statistic"] = format!("quantile_{}", quantile.share).into();
                record
            });
            moments.into_iter().chain(quantiles)
        });
        let yoke = self.yoke();
        let records: Vec<_> = records.chain(yoke.iter().flat_map(RacksYokePart::records)).collect();
        let of_yoke = if yoke.is_some() { " value_n_m lower_n_m upper_n_m value_n lower_n upper_n" } else { "" };
        let columns = format!("delta_cd statistic value_mm lower_mm upper_mm{of_yoke}");
        fact::rows(&json!({ "records": records }), "records", &columns)
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = titled(self.title);
        blocks.push(self.scatter_table());
        blocks.push(self.quantile_table());
        blocks.extend(self.histograms());
        let yoke = self.yoke();
        blocks.extend(yoke.iter().flat_map(RacksYokePart::blocks));
        blocks.extend(self.contributions.into_iter().flat_map(contributions::blocks));
        blocks.extend(self.all_notes().into_iter().map(Block::Remark));
        let inside = self.summary.inside.map(|Inside { racks, share, lower, upper }| {
            format!(
                "{racks} of {} within the limits along the stroke: {:.2} %, 95 % confidence {:.2} … {:.2} %",
                match self.study.racks() {
                    1 => "1 rack stays".to_owned(),
                    all => format!("{all} racks stay"),
                },
                100.0 * share,
                100.0 * lower,
                100.0 * upper
            )
        });
        let verdict = self.summary.on_delta_cd();
        let verdict = verdict.filter(|verdict| *verdict == Verdict::Fail || self.unjudged.is_empty());
        let said: Vec<_> = inside.into_iter().chain(self.reason()).collect();
        if !said.is_empty() {
            blocks.push(Block::Verdict(verdict, said.join("; ")));
        }
        blocks.extend(yoke.iter().flat_map(|yoke| yoke.verdicts(self.study.racks())));
        blocks
    }
}
