//! The limits on a yoke, judged part by part, from the mesh of a part or its bound.

use super::limits::{Bounded, Bounds, Check, Judged, Target, Terms, judge};
use super::play::{SafeSettings, Setting};
use super::torque::lift_off_per_newton;
use super::{Function, Torque, Yoke};
use crate::gear::Pair;
use crate::judge::Verdict;
use crate::mesh::{Curve, Mesh, MeshError};

/// A yoke and its limits.
#[derive(Debug, Clone, PartialEq)]
pub struct YokeJudge {
    /// The yoke.
    pub yoke: Yoke,
    /// The limits on it.
    pub limits: Vec<(Target, Bounds)>,
    /// First and last stroke over which it works, mm.
    pub strokes_mm: (f64, f64),
    /// Whether these strokes are the rack's travel.
    pub knows_travel: bool,
    /// Whether the decision rule takes the value alone, without its uncertainty.
    pub is_by_value: bool,
}

/// A yoke on one part.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgedYoke {
    /// The yoke.
    pub yoke: Yoke,
    /// The yoke's figures; `None` where the part's teeth are not known over the whole travel.
    pub function: Option<Function>,
    /// The yoke's figures from a bound of ΔCD, where a bound is known and the teeth are not.
    pub bounded: Option<Bounded<'static>>,
    /// One per limit.
    pub checks: Vec<Check>,
}

/// A figure of a yoke on a part; `None` where it is not known.
pub type Figure = fn(&JudgedYoke) -> Option<f64>;

impl YokeJudge {
    /// The permitted play.
    #[must_use]
    pub fn window(&self) -> Option<Bounds> {
        self.limits.iter().find(|(on, _)| *on == Target::YokePlay).map(|(_, bounds)| *bounds)
    }

    /// The yoke's figures on a curve; `None` for a curve without points.
    ///
    /// # Errors
    /// [`MeshError`] if there is no mesh where the play is set.
    pub fn on(&self, mesh: &Mesh, curve: &Curve) -> Result<Option<Function>, MeshError> {
        Function::of(mesh, curve, &self.yoke, self.window().as_ref().map(Bounds::window).as_ref())
    }

    /// The limits, judged by the yoke's figures where all teeth are known; `is_measured` says whether every flank that carries
    /// was measured.
    #[must_use]
    pub fn judge(&self, function: &Function, is_measured: bool) -> Vec<Check> {
        let terms = Terms { knows_travel: self.knows_travel, is_measured, is_by_value: self.is_by_value };
        judge(function, &self.yoke, &self.limits, terms)
    }

    /// The yoke's figures from a bound of ΔCD of width U − L, and those for the placements of the errors that a search found.
    #[must_use]
    pub fn bounded<'a>(&self, pair: &Pair, width_mm: f64, reached: &'a [Function]) -> Bounded<'a> {
        let safe = SafeSettings::of(&self.window().unwrap_or_default().window(), width_mm);
        Bounded { safe, lift_off: lift_off_per_newton(pair, self.yoke.tooth_friction.unwrap_or(0.0)), reached }
    }

    /// The limits, judged by a bound of ΔCD of width U − L, which proves a pass, and by placements, which prove a fail; open
    /// without a bound.
    #[must_use]
    pub fn by_bound(&self, pair: &Pair, width_mm: Option<f64>, reached: &[Function]) -> Vec<Check> {
        match width_mm {
            Some(width) => self.bounded(pair, width, reached).judge(&self.yoke, &self.limits, self.is_by_value),
            None => self.open(&Judged::NotProven),
        }
    }

    /// The limits, all open for this reason.
    #[must_use]
    pub fn open(&self, why: &Judged) -> Vec<Check> {
        let open = |&(on, bounds): &(Target, Bounds)| Check { on, bounds, judged: why.clone(), verdict: None };
        self.limits.iter().map(open).collect()
    }

    /// The yoke on a part without any figures: only the outcomes of its limits.
    #[must_use]
    pub fn unknown(&self, checks: Vec<Check>) -> JudgedYoke {
        JudgedYoke { yoke: self.yoke, function: None, bounded: None, checks }
    }

    /// The yoke on a part with a bound of ΔCD of width U − L, without placements.
    #[must_use]
    pub fn within(&self, pair: &Pair, width_mm: Option<f64>) -> JudgedYoke {
        let bounded = width_mm.map(|width| self.bounded(pair, width, &[]));
        JudgedYoke { bounded, ..self.unknown(self.by_bound(pair, width_mm, &[])) }
    }

    /// The yoke on a part whose teeth are known; `is_measured` says whether every flank that carries was measured.
    #[must_use]
    pub fn known(&self, function: Function, is_measured: bool) -> JudgedYoke {
        let checks = self.judge(&function, is_measured);
        JudgedYoke { yoke: self.yoke, function: Some(function).filter(|_| is_measured), bounded: None, checks }
    }
}

/// The yoke's figures on a part, by their names in columns and JSON: the first [`KNOWN_FIGURES`] where its teeth are known, the
/// others where a bound is known.
pub const FIGURES: [(&str, Figure); 22] = [
    ("variation_mm", |yoke| Some(yoke.function.as_ref()?.variation_mm())),
    ("smallest_play_mm", |yoke| Some(yoke.function.as_ref()?.plays_mm()?.0)),
    ("largest_play_mm", |yoke| Some(yoke.function.as_ref()?.plays_mm()?.1)),
    ("setting_from_mm", |yoke| Some(yoke.setting()?.from_mm)),
    ("setting_to_mm", |yoke| yoke.setting()?.to_mm),
    ("setting_from_deg", |yoke| yoke.yoke.degrees(yoke.setting()?.from_mm)),
    ("setting_to_deg", |yoke| yoke.yoke.degrees(yoke.setting()?.to_mm?)),
    ("torque_rising_mean_n_m", |yoke| Some(yoke.torques()?[0].extent.mean)),
    ("torque_rising_smallest_n_m", |yoke| Some(yoke.torques()?[0].extent.smallest)),
    ("torque_rising_largest_n_m", |yoke| Some(yoke.torques()?[0].extent.largest)),
    ("torque_rising_fluctuation_n_m", |yoke| Some(yoke.torques()?[0].fluctuation_n_m())),
    ("torque_falling_mean_n_m", |yoke| Some(yoke.torques()?[1].extent.mean)),
    ("torque_falling_smallest_n_m", |yoke| Some(yoke.torques()?[1].extent.smallest)),
    ("torque_falling_largest_n_m", |yoke| Some(yoke.torques()?[1].extent.largest)),
    ("torque_falling_fluctuation_n_m", |yoke| Some(yoke.torques()?[1].fluctuation_n_m())),
    ("lift_off_force_n", |yoke| Some(yoke.function.as_ref()?.forces.as_ref()?.lift_off_n.smallest)),
    ("variation_at_most_mm", |yoke| Some(yoke.bounded?.safe.width_mm)),
    ("safe_setting_from_mm", |yoke| Some(yoke.safe_setting()?.from_mm)),
    ("safe_setting_to_mm", |yoke| yoke.safe_setting()?.to_mm),
    ("safe_setting_from_deg", |yoke| yoke.yoke.degrees(yoke.safe_setting()?.from_mm)),
    ("safe_setting_to_deg", |yoke| yoke.yoke.degrees(yoke.safe_setting()?.to_mm?)),
    ("lift_off_force_at_least_n", |yoke| Some(yoke.bounded?.yoke_n(&yoke.yoke)?[0] * yoke.bounded?.lift_off)),
];
/// The number of figures that need known teeth.
pub const KNOWN_FIGURES: usize = 16;

impl JudgedYoke {
    /// The yoke without its play and forces at each point of the curve, which take much memory.
    #[must_use]
    pub fn in_short(mut self) -> Self {
        self.function.iter_mut().for_each(|function| function.along = Vec::new());
        self
    }

    /// The settings that keep the window; `None` if there are none, or they are not known.
    #[must_use]
    pub fn setting(&self) -> Option<Setting> {
        self.function.as_ref()?.setting
    }

    /// The settings, where the play is set, that keep the window for every curve within the bound.
    #[must_use]
    pub fn safe_setting(&self) -> Option<Setting> {
        let is_limited = self.checks.iter().any(|check| check.on == Target::YokePlay);
        self.bounded.filter(|_| is_limited)?.settings(&self.yoke)
    }

    /// The settings, if they are known: `Some(None)` for a part that no setting suits.
    #[must_use]
    pub fn settings_known(&self) -> Option<Option<Setting>> {
        let is_judged = |check: &Check| check.on == Target::YokePlay && check.verdict.is_some();
        let function = self.function.as_ref().filter(|_| self.checks.iter().any(is_judged))?;
        Some(function.setting)
    }

    /// The verdict on a limit.
    #[must_use]
    pub fn verdict_on(&self, on: Target) -> Option<Verdict> {
        self.checks.iter().find(|check| check.on == on)?.verdict
    }

    /// The torque in both directions.
    fn torques(&self) -> Option<[Torque; 2]> {
        let forces = self.function.as_ref()?.forces.as_ref()?;
        Some([forces.rising, forces.falling])
    }
}

impl Yoke {
    /// The angle of the plug for a play J, 360° J / P, degrees; `None` if the pitch P of the thread is not known.
    #[must_use]
    pub fn degrees(&self, play_mm: f64) -> Option<f64> {
        self.thread_pitch_mm.map(|pitch| crate::quantity::tidy(360.0 * play_mm / pitch))
    }
}
