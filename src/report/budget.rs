//! The report of `budget`: tolerances, sensitivities, and the tornado plot.

use serde::Serialize;
use serde_json::{Value, json};

use super::chart::{Axis, Bar, Chart, Layer, Scale, Shape};
use super::class::class_fact;
use super::evaluation::ON_WORST_TEETH;
use super::grounds::{Assumption, assumed, assumptions, why_ends_differ};
use super::number::{deviation_text, interval_text, millimetres, plain, signed, truncated, unsigned};
use super::{Block, Column, Report, Screen, Table, fact, number, titled};
use crate::budget::{Budget, Line, Request, Summation};
use crate::deviation::{DeviationKind, DeviationValue, Extent};
use crate::formula::{Influence, Sensitivity, domain};
use crate::judge::class::ErrorClass;
use crate::judge::{Interval, Stack, Verdict};
use crate::quantity::{Length, LengthUnit};

/// A budget with its request.
#[derive(Debug)]
pub struct BudgetReport<'a> {
    /// The spec's title.
    pub title: Option<&'a str>,
    /// The budget.
    pub budget: &'a Budget,
    /// The request.
    pub request: &'a Request,
    /// The permissible values of fixed classes.
    pub classes: &'a [ErrorClass],
    /// For free tolerances, the coarsest grade that stays within them, if a standard is known.
    pub grades: &'a [ErrorClass],
    /// The range that the exact mesh reaches with these tolerances on the worst teeth that a search finds, if it was asked for.
    pub reached: Option<Interval>,
    /// Remarks on the result's validity.
    pub notes: Vec<String>,
    /// Room for the tornado plot.
    pub screen: Screen,
}

/// The name of a quantity.
fn input_name(input: Influence) -> String {
    let gear = match input {
        Influence::NormalPressureAngle => domain::NORMAL_PRESSURE_ANGLE,
        Influence::PinionHelixAngle => domain::PINION_HELIX_ANGLE,
        Influence::RackHelixAngle => domain::RACK_HELIX_ANGLE,
        Influence::FaceWidth => domain::FACE_WIDTH,
        other => return other.to_string(),
    };
    format!("{} {}", gear.name, gear.symbol)
}

/// ∂ΔCD/∂input.
#[derive(Serialize)]
struct SensitivityFact {
    input: String,
    unit: &'static str,
    value: Option<f64>,
}

impl SensitivityFact {
    fn of(Sensitivity { input, value }: &Sensitivity) -> Self {
        let unit = if input.is_angle() { "mm/°" } else { "mm/mm" };
        Self { input: input_name(*input), unit, value: *value }
    }
}

/// The sum of ∂ΔCD/∂input over the errors, as the worst case adds them; `None` if it is not known for one of them.
fn sensitivities(budget: &Budget) -> Vec<SensitivityFact> {
    let mut all: Vec<SensitivityFact> = Vec::new();
    for line in &budget.lines {
        for one in line.sensitivities.iter().map(SensitivityFact::of) {
            match all.iter_mut().find(|sum| sum.input == one.input) {
                Some(sum) => sum.value = sum.value.zip(one.value).map(|(sum, value)| sum + value),
                None => all.push(one),
            }
        }
    }
    // where the errors' parts cancel, the rest is rounding of ΔCD to 1e-12 mm
    all.retain(|sum| sum.value.is_some_and(|value| value.abs() > 1e-9));
    all
}

/// The ΔCD that an error may make.
struct Swing {
    error: String,
    from_mm: f64,
    to_mm: f64,
    is_fixed: bool,
}

impl Swing {
    fn of(line: &Line) -> Self {
        let (from_mm, to_mm) = (line.range.lower.mm().min(0.0), line.range.upper.mm());
        Self { error: line.error.kind().to_string(), from_mm, to_mm, is_fixed: line.is_fixed }
    }

    fn width_mm(&self) -> f64 {
        self.to_mm - self.from_mm
    }
}

impl BudgetReport<'_> {
    /// The ΔCD that the errors may make, widest first.
    fn swings(&self) -> Vec<Swing> {
        let mut swings: Vec<_> = self.budget.lines.iter().map(Swing::of).collect();
        swings.sort_by(|a, b| b.width_mm().total_cmp(&a.width_mm()));
        swings
    }

    /// The tornado plot: a horizontal bar for each error, widest first.
    #[must_use]
    pub fn chart(&self) -> Chart {
        let swings = self.swings();
        let bars = |are_fixed: bool| {
            let rows = swings.iter().enumerate().filter(move |(_, swing)| swing.is_fixed == are_fixed);
            let bar = |(row, swing): (usize, &Swing)| Bar {
                left: swing.from_mm,
                right: swing.to_mm,
                low: row as f64 + 0.15,
                high: row as f64 + 0.85,
                text: millimetres(swing.to_mm),
            };
            Shape::Bars(rows.map(bar).collect())
        };
        let limits = self.request.limit.ends().map(Length::mm).collect();
        Chart {
            title: self.title.unwrap_or("ΔCD by error").to_owned(),
            x: Axis { label: "ΔCD [mm]".to_owned(), scale: Scale::Airy },
            y: Axis {
                label: "error".to_owned(),
                scale: Scale::Names(swings.iter().map(|s| s.error.clone()).collect()),
            },
            layers: vec![
                Layer::new("free tolerance", bars(false)),
                Layer::new("fixed tolerance", bars(true)),
                Layer::new("limits", Shape::LimitsOnX(limits)),
            ],
            height: 150.0 + 44.0 * swings.len() as f64,
            ..Chart::default()
        }
    }

    /// The sum of the free tolerances, in words.
    fn sentence(&self) -> String {
        let budget = self.budget;
        match (&self.request.rule, budget.conforming) {
            (Summation::Simulation(settings), Some(conforming)) => format!(
                "{} % of {} random assemblies have their bound within {} (at least {} % wanted; {} within tolerances; \
                 seed {})",
                plain(percent(conforming)),
                settings.draws,
                self.request.limit,
                plain(percent(settings.conforming)),
                settings.spread.name(),
                settings.seed
            ),
            (rule, _) => {
                let stack = if *rule == Summation::Rss { Stack::Rss } else { Stack::Range };
                let interval = budget.combined.interval(stack);
                let text = interval.map_or_else(|_| "open".to_owned(), |interval| interval_text(&interval));
                format!("{stack} {text} mm, within {}", self.request.limit)
            }
        }
    }

    /// What the budget assumes.
    fn assumptions(&self) -> Vec<Assumption> {
        assumptions(&self.budget.notes, true, &[])
    }

    /// The range of the tolerances in the mesh, beside their bound.
    fn reached_text(&self) -> Option<String> {
        let (reached, bound) = (self.reached?, self.budget.combined.range.ok()?);
        let (reached, bound) = (interval_text(&reached), interval_text(&bound));
        Some(format!("reached: {reached} mm, of the worst case's {bound} mm; {ON_WORST_TEETH}"))
    }

    fn why_ends_differ(&self) -> Option<String> {
        let alone: Vec<_> = self.budget.lines.iter().map(|line| Some(line.range)).collect();
        why_ends_differ(&alone, self.budget.combined.range.ok(), &self.budget.notes)
    }

    /// Which fixed tolerances take more than the limit.
    fn why_broken(&self) -> String {
        let names: Vec<String> = self
            .budget
            .broken_by
            .iter()
            .map(|kind| {
                let line = self.budget.lines.iter().find(|line| line.error.kind() == *kind);
                let range = line.map_or_else(String::new, |line| interval_text(&line.range));
                let own = self.request.own_limits.iter().find(|(of, _)| of == kind);
                let own = own.map_or_else(String::new, |(_, limit)| format!(", its own limit {limit}"));
                format!("{kind} ({range} mm{own})")
            })
            .collect();
        format!("the fixed tolerances take more than the limit: {}; {}", names.join(", "), self.sentence())
    }

    /// The simulation, for programs.
    fn simulation_fact(&self) -> Value {
        match self.request.rule {
            Summation::Simulation(settings) => json!({
                "conforming": self.budget.conforming,
                "target": settings.conforming,
                "distribution": settings.spread.name(),
                "draws": settings.draws,
                "seed": settings.seed,
            }),
            _ => Value::Null,
        }
    }

    /// Horizontal bars for a screen.
    fn tornado(&self) -> Option<String> {
        const NAME: usize = 17;
        let width = self.screen.drawing_width()?.checked_sub(NAME + 24).filter(|width| *width >= 10)?.min(80);
        let swings = self.swings();
        let low = swings.iter().map(|swing| swing.from_mm).fold(0.0, f64::min);
        let high = swings.iter().map(|swing| swing.to_mm).fold(0.0, f64::max);
        if high <= low {
            return None;
        }
        let column = |mm: f64| ((mm - low) / (high - low) * width as f64).round() as usize;
        let zero = column(0.0);
        let lines = swings.iter().map(|Swing { error, from_mm: from, to_mm: to, is_fixed }| {
            let (from_column, to_column) = (column(*from), column(*to).max(column(*from) + 1));
            let fill = if *is_fixed { '▒' } else { '█' };
            let bar: String = (0..=width)
                .map(|at| match at {
                    at if (from_column..to_column).contains(&at) => fill,
                    at if at == zero => '│',
                    _ => ' ',
                })
                .collect();
            let ends =
                if *from == -*to { format!("±{to:.4}") } else { format!("{} … {}", unsigned(*from), unsigned(*to)) };
            format!("{error:<NAME$} {bar} {ends}")
        });
        Some(lines.collect::<Vec<_>>().join("\n"))
    }
}

fn tolerance_text(line: &Line) -> String {
    let ends = line.error.tolerance();
    if ends.nearer.is_some() {
        return deviation_text(line.error.value(), Some(ends.base()));
    }
    // cut, not rounded: printed tolerances meet the limit
    match line.error.value() {
        DeviationValue::Length(length) => {
            format!("±{} µm", truncated(length.abs().in_unit(LengthUnit::Micrometre), 3))
        }
        angle => format!("±{}°", truncated(angle.abs().base(), 6)),
    }
}

/// Assemblies outside the limit from which their share is known to about a tenth.
const FEWEST_SEEN: f64 = 100.0;

/// A fraction in percent; below 1 it is never shown as 100 %.
fn percent(fraction: f64) -> f64 {
    (fraction * 1e12).round() / 1e10
}

impl Report for BudgetReport<'_> {
    fn json(&self) -> Value {
        let budget = self.budget;
        let feasible = budget.is_feasible();
        let tolerances: Vec<_> = budget
            .lines
            .iter()
            .map(|line| {
                let kind = line.error.kind();
                let class = self.classes.iter().find(|class| class.kind == kind);
                let value = (feasible || line.is_fixed).then(|| line.error.value().abs().base());
                let key = if kind == DeviationKind::RackLead { "tolerance_deg" } else { "tolerance_mm" };
                let mut fact = json!({
                    "error": kind.key(),
                    "fixed": line.is_fixed,
                    key: value,
                    "delta_cd_mm": value.map(|_| line.delta_cd),
                    "extent": line.error.extent().name(),
                    "range_mm": value.map(|_| line.range),
                    "share": line.share,
                    "at_own_limit": line.at_own_limit,
                    "class": class.map(class_fact),
                    "class_within": self.grades.iter().find(|grade| grade.kind == kind).map(class_fact),
                    "sensitivities": line.sensitivities.iter().map(SensitivityFact::of).collect::<Vec<_>>(),
                });
                let ends = line.error.tolerance();
                if ends.nearer.is_some() {
                    let [lower, upper] = ends.base();
                    fact[key.replace('_', "_lower_")] = lower.into();
                    fact[key.replace('_', "_upper_")] = upper.into();
                }
                fact
            })
            .collect();
        json!({
            "title": self.title,
            "stack": self.request.rule.name(),
            "model": self.request.model.name(),
            "limit_lower_mm": self.request.limit.lower,
            "limit_upper_mm": self.request.limit.upper,
            "feasible": feasible,
            "broken_by": budget.broken_by.iter().map(|kind| kind.key()).collect::<Vec<_>>(),
            "tolerances": tolerances,
            "worst_case_mm": budget.combined.range.ok(),
            "rss_mm": budget.combined.rss.ok(),
            "reached_mm": self.reached,
            "simulation": self.simulation_fact(),
            "sensitivities": sensitivities(budget),
            "assumes": self.assumptions(),
            "notes": self.notes,
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        const NAMES: &str = "error fixed tolerance_mm tolerance_deg delta_cd_mm share \
                             sensitivity=sensitivities/0/value feasible extent";
        fact::rows(&self.json(), "tolerances", NAMES)
    }

    fn blocks(&self) -> Vec<Block> {
        let budget = self.budget;
        let feasible = budget.is_feasible();
        let share = if self.request.rule == Summation::WorstCase { "share of\nΔCD" } else { "share of\nsquares" };
        let has_extents = budget.lines.iter().any(|line| line.error.extent() != Extent::Each);
        let if_known = |line: &Line, text: String| (feasible || line.is_fixed).then_some(text);
        let grade = |line: &Line| self.grades.iter().find(|grade| grade.kind == line.error.kind());
        let tolerances = Table::of(&budget.lines)
            .text("error", |line| line.error.kind().to_string())
            .number("tolerance", |line| if_known(line, tolerance_text(line)).unwrap_or_else(|| "none left".to_owned()))
            .text("", |line| match (line.is_fixed, line.at_own_limit) {
                (true, _) => "fixed",
                (false, true) => "free, at its own limit",
                (false, false) => "free",
            })
            .number("ΔCD alone\n[mm]", |line| if_known(line, interval_text(&line.range)))
            .number(share, |line| number::percent(line.share))
            .column_if(has_extents, Column::text("on"), |line| {
                line.error.extent().words(line.error.kind().counts(), None)
            })
            .column_if(!self.grades.is_empty(), Column::number("grade\nwithin"), |line| {
                grade(line).map(|grade| grade.permissible.grade.to_string())
            });
        let sensitivities = Table::of(sensitivities(budget))
            .text("input", |of| of.input.clone())
            .number("∂ΔCD/∂input", |of| of.value.map(|value| signed(value, 5)))
            .text("unit", |of| of.unit);
        let mut blocks = titled(self.title);
        blocks.push(tolerances.block());
        blocks.extend(self.tornado().map(Block::Drawing));
        blocks.extend(sensitivities.block_if_any());
        blocks.extend(self.classes.iter().map(|class| Block::Note(format!("class: {}", class.in_words()))));
        blocks.extend(self.grades.iter().map(|class| Block::Note(format!("within: {}", class.in_words()))));
        if let Summation::Simulation(settings) = &self.request.rule
            && (1.0 - settings.conforming) * f64::from(settings.draws) < FEWEST_SEEN
        {
            blocks.push(Block::Remark(format!(
                "fewer than {FEWEST_SEEN} of {} assemblies may fail, which is too few to know their share well; --stack worst leaves none",
                settings.draws
            )));
        }
        blocks.extend(self.why_ends_differ().into_iter().chain(self.notes.iter().cloned()).map(Block::Remark));
        blocks.extend(self.reached_text().map(Block::Note));
        blocks.push(if feasible {
            Block::Verdict(Some(Verdict::Pass), format!("{}{}", self.sentence(), assumed(&self.assumptions())))
        } else {
            Block::Verdict(Some(Verdict::Fail), self.why_broken())
        });
        blocks
    }
}
