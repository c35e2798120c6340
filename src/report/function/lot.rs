//! The yokes of many parts: each in short, and one position of the plug for all of them.

use serde_json::{Value, json};

use super::super::number::{counted, grouped, unsigned};
use super::super::{Block, Column, Table};
use super::{BoundPart, FunctionPart, YokeSection, setting_json, settings_in_words, unsigned_play};
use crate::batch::Part;
use crate::function::{Function, JudgedYoke, Settings, Target, Torque, Yoke, YokeJudge};
use crate::judge::Verdict;
use crate::quantity::tidy;

impl YokeSection {
    /// The figures of a yoke on a judged part.
    #[must_use]
    pub fn of_part(judged: &JudgedYoke, judge: &YokeJudge) -> Self {
        let JudgedYoke { yoke, function, bounded, checks } = judged.clone();
        let window = judge.window();
        match function {
            Some(function) => Self::Known(Box::new(FunctionPart { yoke, function, window, checks, is_known: true })),
            None => Self::Bounded(Box::new(BoundPart::new(yoke, window, bounded.as_ref(), None, checks))),
        }
    }
}

fn share(count: u64, of: u64) -> f64 {
    count as f64 / of.max(1) as f64
}

/// The position of the plug that the most parts share, for programs.
pub(in crate::report) fn lot_json(yoke: &Yoke, settings: &Settings) -> Value {
    let shared = settings.shared().map(|shared| {
        let mut json = setting_json(yoke, shared.as_setting());
        json["parts"] = shared.parts.into();
        json["share"] = share(shared.parts, settings.parts).into();
        json
    });
    json!({ "parts": settings.parts, "without_setting": settings.without, "shared_setting": shared })
}

/// That position for people; `None` where no part's settings are known.
pub(in crate::report) fn lot_table(yoke: &Yoke, settings: &Settings) -> Option<Block> {
    if settings.parts == 0 {
        return None;
    }
    let (setting, suited) = match settings.shared() {
        Some(shared) => (settings_in_words(yoke, Some(shared.as_setting()), ""), shared.parts),
        None => ("none".to_owned(), 0),
    };
    let rows = [
        ("position that suits the most parts", setting, suited),
        ("no position suits", String::new(), settings.without),
        ("parts whose settings are known", String::new(), settings.parts),
    ];
    let percent = |count: u64| format!("{:.2} %", 100.0 * share(count, settings.parts));
    Some(
        Table::of(rows)
            .text("one plug for all", |(name, ..)| *name)
            .number("play and angle", |(_, setting, _)| setting.clone())
            .number("parts", |(.., count)| grouped(*count))
            .number("share", |(.., count)| percent(*count))
            .block(),
    )
}

/// That position in a line.
#[must_use]
pub fn plug_in_words(yoke: &Yoke, settings: &Settings) -> Option<String> {
    let of = counted(settings.parts, "part");
    (settings.parts > 0).then(|| match settings.shared() {
        Some(shared) => {
            let setting = settings_in_words(yoke, Some(shared.as_setting()), "");
            format!("one plug, {setting}, suits {} of {of}, and none suits {}", grouped(shared.parts), settings.without)
        }
        None => format!("no plug suits any of {of}"),
    })
}

/// The figures of a yoke on each part, with their verdicts; `name` is above the parts' names. `None` without a yoke.
#[must_use]
pub fn yokes_block(parts: &[Part], name: &str) -> Option<Block> {
    let yokes: Vec<_> = parts.iter().filter_map(|part| Some((part.id.clone(), part.yoke.as_deref()?))).collect();
    let function = |yoke: &JudgedYoke| yoke.function.clone();
    let knows = |of: fn(&Function) -> bool| yokes.iter().any(|(_, yoke)| yoke.function.as_ref().is_some_and(of));
    let is_limited = |on: Target| yokes.iter().any(|(_, yoke)| yoke.checks.iter().any(|check| check.on == on));
    let (is_solved, has_forces) = (knows(|_| true), knows(|function| function.forces.is_some()));
    let mut table = Table::of(yokes.iter())
        .text(name, |(id, _)| id.clone())
        .column_if(is_solved, Column::number("ΔCD varies by\n[mm]"), |(_, yoke)| {
            function(yoke).map(|function| unsigned(tidy(function.variation_mm())))
        })
        .column_if(is_solved, Column::number("play\n[mm]"), |(_, yoke)| {
            let (smallest, largest) = function(yoke)?.plays_mm()?;
            Some(format!("{} … {}", unsigned_play(smallest), unsigned_play(largest)))
        })
        .column_if(
            is_limited(Target::YokePlay) && is_solved,
            Column::number("settings that keep\nthe window"),
            |(_, yoke)| yoke.settings_known().map(|setting| settings_in_words(&yoke.yoke, setting, "none")),
        );
    let is_bounded = yokes.iter().any(|(_, yoke)| yoke.bounded.is_some());
    table = table
        .column_if(is_bounded, Column::number("ΔCD varies by\nat most [mm]"), |(_, yoke)| {
            Some(unsigned(tidy(yoke.bounded?.safe.width_mm)))
        })
        .column_if(is_limited(Target::YokePlay) && is_bounded, Column::number("safe settings"), |(_, yoke)| {
            yoke.bounded.map(|_| settings_in_words(&yoke.yoke, yoke.safe_setting(), "none is proven"))
        });
    for (heading, of) in [("rising", 0), ("falling", 1)] {
        let torque = move |yoke: &JudgedYoke| -> Option<Torque> {
            let forces = yoke.function.as_ref()?.forces.as_ref()?;
            Some([forces.rising, forces.falling][of])
        };
        let number = |value: f64| Target::PinionTorque.in_words(value);
        table = table
            .column_if(has_forces, Column::number(format!("torque {heading}\n[N m]")), |(_, yoke)| {
                torque(yoke).map(|torque| number(torque.extent.mean))
            })
            .column_if(has_forces, Column::number("its\nfluctuation"), |(_, yoke)| {
                torque(yoke).map(|torque| number(torque.fluctuation_n_m()))
            });
    }
    table = table.column_if(has_forces, Column::number("lift-off\n[N]"), |(_, yoke)| {
        Some(Target::LiftOffForce.in_words(yoke.function.as_ref()?.forces.as_ref()?.lift_off_n.smallest))
    });
    for on in Target::ALL {
        table = table.column_if(is_limited(on), Column::text(on.words()), |(_, yoke)| {
            let check = yoke.checks.iter().find(|check| check.on == on)?;
            Some(check.verdict.map_or("open", Verdict::name))
        });
    }
    table.block_if_any()
}
