//! The report on a yoke where a bound of ΔCD is known and the teeth are not.

use serde_json::{Value, json};

use super::super::evaluation::ON_WORST_TEETH;
use super::super::number::{tidy, unsigned};
use super::super::{Block, Table};
use super::{WHEREVER, check_json, scope_of_bound, setting_json, settings_in_words, torque_json};
use crate::function::{Bounded, Bounds, Check, Function, SafeSettings, Setting, Target, Yoke};

/// The results for a yoke where a bound of ΔCD is known and the teeth are not.
#[derive(Debug)]
pub struct BoundPart {
    yoke: Yoke,
    window: Option<Bounds>,
    bound: Option<Bound>,
    error_free: Option<Function>,
    /// One per limit.
    pub checks: Vec<Check>,
}

/// The results of the bound.
#[derive(Debug)]
struct Bound {
    safe: SafeSettings,
    settings: Option<Setting>,
    lift_off_n: Option<f64>,
    /// Largest variation of ΔCD, and fluctuation of the torque, on the placements that a search found.
    reached: Option<(f64, Option<f64>)>,
}

impl BoundPart {
    /// The results of a bound, and of the pair without errors.
    #[must_use]
    pub fn new(
        yoke: Yoke,
        window: Option<Bounds>,
        bounded: Option<&Bounded<'_>>,
        error_free: Option<Function>,
        checks: Vec<Check>,
    ) -> Self {
        let bound = bounded.map(|bounded| {
            let largest = |of: fn(&Function) -> Option<f64>| bounded.reached.iter().filter_map(of).reduce(f64::max);
            let fluctuation = |function: &Function| {
                let forces = function.forces.as_ref()?;
                Some(forces.rising.fluctuation_n_m().max(forces.falling.fluctuation_n_m()))
            };
            Bound {
                safe: bounded.safe,
                settings: bounded.settings(&yoke),
                lift_off_n: bounded.yoke_n(&yoke).map(|force| force[0] * bounded.lift_off),
                reached: largest(|function| Some(function.variation_mm())).map(|most| (most, largest(fluctuation))),
            }
        });
        Self { yoke, window, bound, error_free, checks }
    }

    pub(super) fn json(&self) -> Value {
        let bound = self.bound.as_ref();
        let of_window = bound.filter(|_| self.window.is_some());
        let setting = |setting: Option<Setting>| setting.map(|setting| setting_json(&self.yoke, setting));
        let torque = self.error_free.as_ref().and_then(|function| function.forces.as_ref());
        json!({
            "judged_by": "bound",
            "variation_at_most_mm": bound.map(|bound| tidy(bound.safe.width_mm)),
            "setting_exists": of_window.map(|bound| bound.safe.is_there_one),
            "safe_setting": of_window.and_then(|bound| setting(bound.settings)),
            "safe_setting_at_stroke": of_window.and_then(|bound| setting(bound.safe.at_stroke)),
            "safe_setting_at_tightest": of_window.and_then(|bound| setting(bound.safe.at_tightest)),
            "lift_off_force_n": bound.and_then(|bound| bound.lift_off_n).map(tidy),
            "error_free_torque_n_m": torque.map(|forces| json!({
                "rising": torque_json(&forces.rising),
                "falling": torque_json(&forces.falling),
            })),
            "reached": bound.and_then(|bound| bound.reached).map(|(variation, fluctuation)| json!({
                "variation_mm": tidy(variation),
                "torque_fluctuation_n_m": fluctuation.map(tidy),
            })),
            "limits": self.checks.iter().map(check_json).collect::<Vec<_>>(),
        })
    }

    pub(super) fn blocks(&self) -> Vec<Block> {
        let mm = |mm: f64| format!("{} mm", unsigned(tidy(mm)));
        let torque = |n_m: f64| format!("{} N m", Target::PinionTorque.in_words(n_m));
        let (bound, window) = (self.bound.as_ref(), self.window.as_ref());
        let safe = |setting: Option<Setting>| settings_in_words(&self.yoke, setting, "none is proven");
        let reached = bound.and_then(|bound| bound.reached);
        let error_free = self.error_free.as_ref().and_then(|function| function.forces.as_ref());
        let rows = [
            bound.map(|bound| ("variation of ΔCD, at most", mm(bound.safe.width_mm), WHEREVER)),
            reached.map(|(variation, _)| ("variation of ΔCD, reached", mm(variation), ON_WORST_TEETH)),
            bound.zip(window).map(|(bound, _)| {
                let exists = if bound.safe.is_there_one { "yes" } else { "not proven" };
                ("a setting that keeps the window exists", exists.to_owned(), WHEREVER)
            }),
            bound
                .zip(window)
                .map(|(bound, _)| ("safe at any stroke", safe(bound.safe.at_stroke), "without knowing the curve")),
            bound
                .zip(window)
                .map(|(bound, _)| ("safe at the tightest", safe(bound.safe.at_tightest), "without knowing the curve")),
            error_free.map(|forces| ("free pinion torque, mean", torque(forces.rising.extent.mean), "without errors")),
            reached
                .and_then(|reached| reached.1)
                .map(|most| ("its fluctuation, reached", torque(most), ON_WORST_TEETH)),
            bound.and_then(|bound| bound.lift_off_n).map(|force| {
                ("lift-off force, at least", format!("{} N", Target::LiftOffForce.in_words(force)), WHEREVER)
            }),
        ];
        let table = Table::of(rows.into_iter().flatten())
            .text("yoke", |(name, ..)| *name)
            .number("value", |(_, value, _)| value.clone())
            .text("assumes", |(.., assumes)| *assumes)
            .block_if_any();
        let verdicts =
            self.checks.iter().map(|check| Block::Verdict(check.verdict, check.sentence(scope_of_bound(check))));
        table.into_iter().chain(verdicts).collect()
    }
}
