//! Limits on a yoke, and their verdicts; a value equal to a limit is inside.

use super::play::{SafeSettings, Setting, Window};
use super::{Function, SetAt, Yoke};
use crate::judge::Verdict;
use crate::quantity::tidy;

named! {
    /// The quantity that a limit is on.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Target {
        /// The play of the yoke over the travel, mm.
        YokePlay = "yoke_play",
        /// The free torque of the pinion in both directions, N m.
        PinionTorque = "pinion_torque",
        /// Largest less smallest torque in one direction, N m.
        TorqueFluctuation = "torque_fluctuation",
        /// The force along the rack at which one side of the teeth unloads, N.
        LiftOffForce = "lift_off_force",
    }
}

impl Target {
    /// The name of the quantity for people.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::YokePlay => "yoke play",
            Self::PinionTorque => "free pinion torque",
            Self::TorqueFluctuation => "fluctuation of the pinion torque",
            Self::LiftOffForce => "lift-off force",
        }
    }

    /// The unit of its values.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::YokePlay => "mm",
            Self::PinionTorque | Self::TorqueFluctuation => "N m",
            Self::LiftOffForce => "N",
        }
    }
}

/// Permitted values in the unit of their quantity, ends included; a missing end is open.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bounds {
    /// The lowest.
    pub lower: Option<f64>,
    /// The highest.
    pub upper: Option<f64>,
}

impl Bounds {
    fn judge(&self, [smallest, largest]: [f64; 2]) -> Verdict {
        let is_inside = self.lower.is_none_or(|lower| lower <= tidy(smallest))
            && self.upper.is_none_or(|upper| tidy(largest) <= upper);
        if is_inside { Verdict::Pass } else { Verdict::Fail }
    }

    /// The bounds as a window of play, mm.
    #[must_use]
    pub fn window(&self) -> Window {
        Window { lower_mm: self.lower.unwrap_or(0.0), upper_mm: self.upper }
    }
}

/// The outcome of a limit.
#[derive(Debug, Clone, PartialEq)]
pub enum Judged {
    /// The smallest and the largest value, compared with the limit.
    Values([f64; 2]),
    /// No position of the plug keeps the window.
    NoSetting,
    /// For every curve within a bound, a position of the plug keeps the window.
    SomeSetting,
    /// The bound proves no pass, and no placement that was found proves a fail.
    NotProven,
    /// These keys of the spec are needed and missing.
    Lacks(Vec<&'static str>),
    /// The decision rule needs an uncertainty, which is not known.
    NoUncertainty,
    /// Flanks that carry on the travel were not measured.
    NotMeasured,
    /// A stroke has no solution, or the curve is not resolved.
    Unsolved,
    /// The rack may roll; its torque is not computed.
    Rolls,
}

/// A limit and its verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// Its quantity.
    pub on: Target,
    /// The permitted values.
    pub bounds: Bounds,
    /// Its outcome.
    pub judged: Judged,
    /// `None` if it is open.
    pub verdict: Option<Verdict>,
}

impl Check {
    /// The largest distance of the values outside the limit; infinite without values.
    pub(super) fn beyond(&self) -> f64 {
        let Judged::Values([smallest, largest]) = self.judged else { return f64::INFINITY };
        let below = self.bounds.lower.map(|lower| lower - smallest);
        let above = self.bounds.upper.map(|upper| largest - upper);
        below.into_iter().chain(above).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// How limits on a yoke are judged.
#[derive(Debug, Clone, Copy)]
pub struct Terms {
    /// Whether the strokes are the rack's travel.
    pub knows_travel: bool,
    /// Whether every flank that carries on these strokes was measured.
    pub is_measured: bool,
    /// Whether the decision rule takes the value alone, without its uncertainty.
    pub is_by_value: bool,
}

/// Judges the figures of a yoke by these limits.
#[must_use]
pub fn judge(function: &Function, yoke: &Yoke, limits: &[(Target, Bounds)], terms: Terms) -> Vec<Check> {
    limits
        .iter()
        .map(|&(on, bounds)| {
            let lacking = lacking(on, yoke, terms.knows_travel);
            let judged = match lacking.is_empty() {
                false => Judged::Lacks(lacking),
                true if !terms.is_by_value => Judged::NoUncertainty,
                true if !terms.is_measured => Judged::NotMeasured,
                true => judged(function, on),
            };
            let verdict = match judged {
                Judged::Values(_) if on == Target::YokePlay => Some(function.keeps_window()),
                Judged::Values(values) => Some(bounds.judge(values)),
                Judged::NoSetting => Some(Verdict::Fail),
                _ => None,
            };
            Check { on, bounds, judged, verdict }
        })
        .collect()
}

/// The figures of a yoke where only a bound of ΔCD is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounded<'a> {
    /// The settings by the bound.
    pub safe: SafeSettings,
    /// Lift-off force over the yoke's force, F_x / F.
    pub lift_off: f64,
    /// The yoke's figures for placements of the errors that a search found.
    pub reached: &'a [Function],
}

impl Bounded<'_> {
    /// The settings, where the play is set, that keep the window for every curve within the bound.
    #[must_use]
    pub fn settings(&self, yoke: &Yoke) -> Option<Setting> {
        if yoke.set_at == SetAt::Tightest { self.safe.at_tightest } else { self.safe.at_stroke }
    }

    /// Smallest and largest force of the yoke, N; `None` if preload or rate is not known.
    #[must_use]
    pub fn yoke_n(&self, yoke: &Yoke) -> Option<[f64; 2]> {
        let (preload, change) = (yoke.preload_n?, yoke.rate_n_per_mm.unwrap_or(0.0) * self.safe.width_mm);
        let most = if yoke.set_at == SetAt::Tightest { preload } else { preload + change };
        Some([(preload - change).max(0.0), most])
    }

    /// The outcome of a limit that the bound or a placement proves, if one does.
    fn proof(&self, yoke: &Yoke, on: Target, bounds: &Bounds) -> Option<Judged> {
        match on {
            Target::YokePlay => {
                let Some(play) = yoke.play_mm else { return self.safe.is_there_one.then_some(Judged::SomeSetting) };
                let below = if yoke.set_at == SetAt::Tightest { 0.0 } else { self.safe.width_mm };
                let is_safe = self.settings(yoke).is_some_and(|setting| setting.contains(play));
                is_safe.then_some(Judged::Values([play - below, play + self.safe.width_mm]))
            }
            Target::LiftOffForce => {
                let least = self.yoke_n(yoke)?.map(|force| force * self.lift_off);
                (bounds.judge(least) == Verdict::Pass).then_some(Judged::Values(least))
            }
            Target::PinionTorque | Target::TorqueFluctuation => None,
        }
    }

    /// Judges by these limits: the bound proves a pass, a placement a fail.
    #[must_use]
    pub fn judge(&self, yoke: &Yoke, limits: &[(Target, Bounds)], is_by_value: bool) -> Vec<Check> {
        let terms = Terms { knows_travel: true, is_measured: true, is_by_value };
        let judged = |&(on, bounds): &(Target, Bounds)| {
            let lacking = lacking(on, yoke, true);
            let open = |judged| Check { on, bounds, judged, verdict: None };
            if !lacking.is_empty() {
                return open(Judged::Lacks(lacking));
            }
            if !is_by_value {
                return open(Judged::NoUncertainty);
            }
            if let Some(judged) = self.proof(yoke, on, &bounds) {
                return Check { verdict: Some(Verdict::Pass), ..open(judged) };
            }
            let placed = self.reached.iter().flat_map(|function| judge(function, yoke, &[(on, bounds)], terms));
            let fails = placed.into_iter().filter(|check| check.verdict == Some(Verdict::Fail));
            let worst = fails.max_by(|a, b| a.beyond().total_cmp(&b.beyond()));
            worst.unwrap_or(open(Judged::NotProven))
        };
        limits.iter().map(judged).collect()
    }
}

/// The missing keys without which a limit cannot be judged.
fn lacking(on: Target, yoke: &Yoke, knows_travel: bool) -> Vec<&'static str> {
    let forces = [("yoke.preload", yoke.preload_n), ("yoke.rate", yoke.rate_n_per_mm)];
    let teeth = ("yoke.friction.teeth", yoke.tooth_friction);
    let friction = [("yoke.friction.yoke", yoke.yoke_friction), teeth];
    let bearing = [("yoke.bearing_torque", yoke.bearing_torque_n_m)];
    let needed = match on {
        Target::YokePlay => vec![],
        Target::PinionTorque => [&forces[..], &friction[..], &bearing[..]].concat(),
        Target::TorqueFluctuation => [&forces[..], &friction[..]].concat(),
        Target::LiftOffForce => [&forces[..], &[teeth][..]].concat(),
    };
    let travel = (!knows_travel).then_some("rack.travel");
    travel.into_iter().chain(needed.into_iter().filter(|key| key.1.is_none()).map(|key| key.0)).collect()
}

/// The values that a limit judges.
fn judged(function: &Function, on: Target) -> Judged {
    if !function.is_solved {
        return Judged::Unsolved;
    }
    if on == Target::YokePlay {
        return match (function.plays_mm(), function.setting) {
            (Some((smallest, largest)), _) => Judged::Values([smallest, largest]),
            (None, None) => Judged::NoSetting,
            (None, Some(_)) => Judged::Lacks(vec!["yoke.set_play"]),
        };
    }
    let Some(forces) = &function.forces else { return Judged::Rolls };
    let [rising, falling] = [&forces.rising, &forces.falling];
    Judged::Values(match on {
        Target::PinionTorque => {
            [rising.extent.smallest.min(falling.extent.smallest), rising.extent.largest.max(falling.extent.largest)]
        }
        Target::TorqueFluctuation => {
            let [rising, falling] = [rising.fluctuation_n_m(), falling.fluctuation_n_m()];
            [rising.min(falling), rising.max(falling)]
        }
        _ => [forces.lift_off_n.smallest; 2],
    })
}
