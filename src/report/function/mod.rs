//! The yoke in the reports of the mesh: its play, the setting of its plug, torque and lift-off, and their limits.

mod bound;
mod charts;
#[cfg(feature = "batch")]
mod lot;
mod racks;

pub use bound::BoundPart;
#[cfg(feature = "batch")]
pub(super) use lot::{lot_json, lot_table};
#[cfg(feature = "batch")]
pub use lot::{plug_in_words, yokes_block};
pub(super) use racks::{RACK_YOKE_COLUMNS, RacksYokePart, rack_values};

use serde_json::{Value, json};

use super::mesh_points::ListedPoint;
use super::number::{plain, signed, stroke_text, tidy, unsigned};
use super::{Block, Table};
use crate::function::{AtStroke, Bounds, Check, ForcesAt, Function, Judged, Setting, Torque, Yoke};
use crate::judge::Verdict;
use crate::mesh::{Mesh, MeshPoint, Sampler};
use crate::multibody::Extent;
use crate::quantity::Rounded;

/// The figures of a yoke on a solved curve, and the outcome of its limits.
#[derive(Debug)]
pub struct FunctionPart {
    /// The yoke.
    pub yoke: Yoke,
    /// Its figures.
    pub function: Function,
    /// Permitted play.
    pub window: Option<Bounds>,
    /// One per limit.
    pub checks: Vec<Check>,
    /// Whether the teeth of both parts are known; otherwise the errors are where a search put them.
    pub is_known: bool,
}

/// The results for a yoke in an evaluation.
#[derive(Debug)]
pub enum YokeSection {
    /// The teeth of both parts are known.
    Known(Box<FunctionPart>),
    /// A bound of ΔCD is known.
    Bounded(Box<BoundPart>),
}

impl YokeSection {
    /// One per limit.
    #[must_use]
    pub fn checks(&self) -> &[Check] {
        match self {
            Self::Known(part) => &part.checks,
            Self::Bounded(part) => &part.checks,
        }
    }

    /// The yoke's figures on the curve, where they are known.
    #[must_use]
    pub fn known(&self) -> Option<&FunctionPart> {
        if let Self::Known(part) = self { Some(part) } else { None }
    }

    pub(super) fn json(&self) -> Value {
        match self {
            Self::Known(part) => part.json(),
            Self::Bounded(part) => part.json(),
        }
    }

    /// For people.
    #[must_use]
    pub fn blocks(&self) -> Vec<Block> {
        match self {
            Self::Known(part) => part.blocks(),
            Self::Bounded(part) => part.blocks(),
        }
    }
}

/// The columns of a list of strokes that a yoke adds.
pub(super) const COLUMNS: &str = "yoke_play_mm yoke_force_n lifting_torque_n_m yoke_friction_torque_n_m \
                                  tooth_friction_torque_n_m torque_rising_n_m torque_falling_n_m lift_off_force_n";

/// The values of these columns.
pub(super) fn values(at: Option<&AtStroke>) -> [Option<f64>; 8] {
    let of = |of: fn(&ForcesAt) -> f64| at.and_then(|at| at.forces).map(|forces| tidy(of(&forces)));
    [
        at.and_then(|at| at.play_mm).map(tidy),
        of(|at| at.yoke_n),
        of(|at| at.lifting_n_m),
        of(|at| at.yoke_friction_n_m),
        of(|at| at.tooth_friction_n_m),
        of(|at| at.rising_n_m),
        of(|at| at.falling_n_m),
        of(|at| at.lift_off_n),
    ]
}

/// The same by name.
pub(super) fn add_values(at: Option<&AtStroke>, json: &mut Value) {
    for (name, value) in COLUMNS.split_whitespace().zip(values(at)) {
        json[name] = value.into();
    }
}

/// The same for solved strokes of a list.
#[must_use]
pub fn at_listed(function: &Function, mesh: &Mesh, points: &[ListedPoint]) -> Vec<Option<AtStroke>> {
    let mut sampler = Sampler::new(mesh);
    let mut at = |point: &MeshPoint| function.at(point, sampler.rates(point));
    points.iter().map(|(_, point)| point.as_ref().ok().map(&mut at)).collect()
}

fn extent_json(extent: &Extent) -> Value {
    let tidied =
        Extent { mean: tidy(extent.mean), smallest: tidy(extent.smallest), largest: tidy(extent.largest), ..*extent };
    json!(tidied)
}

fn torque_json(torque: &Torque) -> Value {
    let mut json = extent_json(&torque.extent);
    json["fluctuation"] = tidy(torque.fluctuation_n_m()).into();
    json["fluctuation_in_a_turn"] = tidy(torque.fluctuation_in_a_turn_n_m).into();
    json
}

/// A play, with its angle if the thread is known.
fn play_in_words(yoke: &Yoke, mm: f64) -> String {
    let degrees = yoke.degrees(mm).map(|degrees| format!(", {degrees:.1}°")).unwrap_or_default();
    format!("{} mm{degrees}", unsigned_play(mm))
}

/// Settings from one end to the other; the text `none` without any.
fn settings_in_words(yoke: &Yoke, setting: Option<Setting>, none: &str) -> String {
    match setting {
        None => none.to_owned(),
        Some(Setting { from_mm, to_mm: Some(to) }) => {
            format!("{} to {}", play_in_words(yoke, from_mm), play_in_words(yoke, to))
        }
        Some(Setting { from_mm, to_mm: None }) => format!("from {} on", play_in_words(yoke, from_mm)),
    }
}

fn setting_json(yoke: &Yoke, setting: Setting) -> Value {
    let [from, to, middle] = [Some(setting.from_mm), setting.to_mm, setting.middle_mm().map(tidy)];
    let degrees = |mm: Option<f64>| mm.and_then(|mm| yoke.degrees(mm));
    json!({
        "from_mm": from, "to_mm": to, "recommended_mm": middle,
        "from_deg": degrees(from), "to_deg": degrees(to), "recommended_deg": degrees(middle),
    })
}

impl FunctionPart {
    pub(super) fn json(&self) -> Value {
        let function = &self.function;
        let (smallest, largest) = function.plays_mm().unzip();
        let teeth = |point: &MeshPoint| {
            json!({
                "stroke_mm": point.stroke_mm,
                "right_tooth": point.right.rack_tooth,
                "left_tooth": point.left.rack_tooth,
            })
        };
        let torque = function.forces.as_ref().map(|forces| {
            json!({
                "rising": torque_json(&forces.rising),
                "falling": torque_json(&forces.falling),
                "terms": {
                    "lifting": extent_json(&forces.lifting_n_m),
                    "yoke_friction": extent_json(&forces.yoke_friction_n_m),
                    "tooth_friction": extent_json(&forces.tooth_friction_n_m),
                    "bearings": self.yoke.bearing_torque_n_m,
                },
            })
        });
        let lift_off = function.forces.as_ref().map(|forces| &forces.lift_off_n);
        json!({
            "stroke_mm": { "from": function.strokes_mm.0, "to": function.strokes_mm.1 },
            "set_at_mm": function.set_at_mm,
            "set_play_mm": function.play_mm.map(tidy),
            "set_play_deg": function.play_mm.and_then(|play| self.yoke.degrees(play)),
            "is_recommended": self.is_known && self.yoke.play_mm.is_none() && function.play_mm.is_some(),
            "variation_mm": tidy(function.variation_mm()),
            "smallest_play_mm": smallest.map(tidy),
            "smallest_play": teeth(&function.highest),
            "largest_play_mm": largest.map(tidy),
            "largest_play": teeth(&function.lowest),
            "setting": function.setting.map(|setting| setting_json(&self.yoke, setting)),
            "yoke_force_n": function.forces.as_ref().map(|forces| extent_json(&forces.yoke_n)),
            "torque_n_m": torque,
            "lift_off_force_n": lift_off.map(|force| tidy(force.smallest)),
            "lift_off_stroke_mm": lift_off.map(|force| force.smallest_stroke_mm),
            "judged_by": if self.is_known { "mesh" } else { "bound" },
            "limits": self.checks.iter().map(check_json).collect::<Vec<_>>(),
        })
    }

    pub(super) fn blocks(&self) -> Vec<Block> {
        let mut blocks = vec![self.play_table()];
        blocks.extend(self.torque_tables());
        blocks.extend(self.notes().into_iter().map(Block::Remark));
        blocks
            .extend(self.checks.iter().map(|check| Block::Verdict(check.verdict, check.sentence(&self.scope(check)))));
        blocks
    }

    fn play_table(&self) -> Block {
        let function = &self.function;
        let at = |point: &MeshPoint| {
            format!("{:.4}, teeth {} and {}", point.stroke_mm, point.right.rack_tooth, point.left.rack_tooth)
        };
        let (smallest, largest) = function.plays_mm().unzip();
        let no_play = || "no play is set".to_owned();
        let set_at = stroke_text(function.set_at_mm);
        let settings = self.window.map(|_| settings_in_words(&self.yoke, function.setting, "none"));
        let play = |mm: f64| play_in_words(&self.yoke, mm);
        let (from, to) = function.strokes_mm;
        // elsewhere on the teeth the same errors leave other settings, so none is recommended
        let in_window =
            if self.is_known { "settings that keep the window" } else { "settings with the errors placed so" };
        let set = match (self.yoke.play_mm, self.is_known) {
            (Some(_), _) => "play that is set",
            (None, false) if self.window.is_some() => "the middle of these",
            (None, _) if function.play_mm.is_none() => "play",
            (None, _) => "recommended play",
        };
        let rows = [
            Some((
                "variation of ΔCD",
                format!("{} mm", unsigned(tidy(function.variation_mm()))),
                format!("{} … {}", plain(from), plain(to)),
            )),
            settings.map(|settings| (in_window, settings, set_at.clone())),
            Some((set, function.play_mm.map_or_else(no_play, play), set_at)),
            Some((
                "smallest play",
                smallest.map_or_else(no_play, |mm| format!("{} mm", unsigned_play(mm))),
                at(&function.highest),
            )),
            Some((
                "largest play",
                largest.map_or_else(no_play, |mm| format!("{} mm", unsigned_play(mm))),
                at(&function.lowest),
            )),
        ];
        Table::of(rows.into_iter().flatten())
            .text("yoke", |(name, ..)| *name)
            .number("value", |(_, value, _)| value.clone())
            .number("at stroke [mm]", |(.., at)| at.clone())
            .block()
    }

    /// Torque, forces, and how far the torque fluctuates; nothing without forces.
    fn torque_tables(&self) -> Vec<Block> {
        let Some(forces) = &self.function.forces else { return Vec::new() };
        let bearing = self.yoke.bearing_torque_n_m;
        let constant = |value: f64| Extent {
            mean: value,
            smallest: value,
            smallest_stroke_mm: f64::NAN,
            largest: value,
            largest_stroke_mm: f64::NAN,
        };
        let rows = [
            Some(("torque, stroke rising [N m]", forces.rising.extent)),
            Some(("torque, stroke falling [N m]", forces.falling.extent)),
            Some(("of it: lifting, rising [N m]", forces.lifting_n_m)),
            self.yoke.yoke_friction.map(|_| ("of it: yoke friction [N m]", forces.yoke_friction_n_m)),
            self.yoke.tooth_friction.map(|_| ("of it: tooth friction [N m]", forces.tooth_friction_n_m)),
            bearing.map(|torque| ("of it: bearings [N m]", constant(torque))),
            Some(("force of the yoke [N]", forces.yoke_n)),
            Some(("lift-off force [N]", forces.lift_off_n)),
        ];
        let number = |value: f64, decimals| signed(tidy(value), decimals).trim_start_matches('+').to_owned();
        let of_row = |name: &str, value: f64| number(value, if name.ends_with("[N]") { 1 } else { 4 });
        let table = Table::of(rows.into_iter().flatten())
            .text("free pinion", |(name, _)| *name)
            .number("mean", |(name, extent)| of_row(name, extent.mean))
            .number("smallest", |(name, extent)| of_row(name, extent.smallest))
            .number("at stroke\n[mm]", |(_, extent)| stroke_text(extent.smallest_stroke_mm))
            .number("largest", |(name, extent)| of_row(name, extent.largest))
            .number("at stroke\n[mm]", |(_, extent)| stroke_text(extent.largest_stroke_mm));
        let fluctuation = Table::of([("stroke rising", forces.rising), ("stroke falling", forces.falling)])
            .text("fluctuation of the torque", |(name, _)| *name)
            .number("over the stroke\n[N m]", |(_, torque)| number(torque.fluctuation_n_m(), 4))
            .number("in a turn\n[N m]", |(_, torque)| number(torque.fluctuation_in_a_turn_n_m, 4));
        vec![table.block(), fluctuation.block()]
    }

    /// The assumptions of the values, and where they are incomplete.
    fn notes(&self) -> Vec<String> {
        let (function, yoke) = (&self.function, &self.yoke);
        let mut notes = Vec::new();
        if !self.is_known && self.window.is_some() {
            notes.push("errors elsewhere on the teeth leave other settings: `rackmesh eval` has those that are safe wherever they are".to_owned());
        }
        let missing = [
            ("yoke.rate", yoke.rate_n_per_mm),
            ("yoke.friction.yoke", yoke.yoke_friction),
            ("yoke.friction.teeth", yoke.tooth_friction),
            ("yoke.bearing_torque", yoke.bearing_torque_n_m),
        ];
        let missing: Vec<_> = missing.iter().filter(|key| key.1.is_none()).map(|key| key.0).collect();
        match &function.forces {
            Some(_) if !missing.is_empty() => {
                notes.push(format!(
                    "torque and lift-off are those without {}, which the spec does not give",
                    missing.join(", ")
                ));
            }
            None if yoke.preload_n.is_some() => {
                notes.push(
                    "torque and lift-off are known for a rack that cannot roll, where every stroke is solved"
                        .to_owned(),
                );
            }
            _ => {}
        }
        if function.plays_mm().is_some_and(|plays| plays.0 < 0.0) {
            notes.push("where the play is below 0 the plug presses on the rack: torque and lift-off are larger there than given".to_owned());
        }
        if function.forces.as_ref().is_some_and(|forces| forces.yoke_n.smallest <= 0.0) {
            notes.push("the spring of the yoke is relaxed on a part of the stroke".to_owned());
        }
        notes
    }

    /// The scope of the verdicts.
    fn scope(&self, check: &Check) -> String {
        if !self.is_known {
            return scope_of_bound(check).to_owned();
        }
        let (from, to) = self.function.strokes_mm;
        format!("over the travel {} … {} mm", Rounded(from), Rounded(to))
    }
}

fn unsigned_play(mm: f64) -> String {
    let text = signed(tidy(mm), 4);
    text.trim_start_matches('+').to_owned()
}

/// The scope of verdicts where the teeth are not known.
const WHEREVER: &str = "wherever on the teeth the errors are";

/// The scope of the verdict on a limit there: the bound proves a pass, a placement a fail.
fn scope_of_bound(check: &Check) -> &'static str {
    if check.verdict == Some(Verdict::Fail) { "with the errors where a search put them" } else { WHEREVER }
}

pub(super) fn check_json(check: &Check) -> Value {
    let Bounds { lower, upper } = check.bounds;
    let values = if let Judged::Values(values) = check.judged { Some(values.map(tidy)) } else { None };
    json!({
        "on": check.on.name(),
        "unit": check.on.unit(),
        "lower": lower,
        "upper": upper,
        "smallest": values.map(|values| values[0]),
        "largest": values.map(|values| values[1]),
        "verdict": check.verdict.map(Verdict::name),
        "reason": check.open_because(),
    })
}
