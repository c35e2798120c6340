#![doc = include_str!("method.md")]
//!
//! Called for solved curves ([`Function::of`]) and for bounds of ΔCD ([`SafeSettings`]); [`YokeJudge`] judges many parts. Solves
//! strokes to find extremes between the points of a curve.

mod along;
mod common;
mod judged;
mod limits;
mod play;
mod torque;
mod words;

pub use along::{Forces, Function, Torque};
pub use common::{Settings, Shared};
pub(crate) use common::{most_shared, shared_by};
pub use judged::{FIGURES, Figure, JudgedYoke, KNOWN_FIGURES, YokeJudge};
pub use limits::{Bounded, Bounds, Check, Judged, Target, Terms, judge};
pub use play::{SafeSettings, Setting, Window};
pub use torque::{AtStroke, ForcesAt, lift_off_per_newton};

/// Where the play of the yoke is set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SetAt {
    /// At this stroke, mm.
    Stroke(f64),
    /// At the tightest stroke, where ΔCD is largest.
    Tightest,
}

impl Default for SetAt {
    fn default() -> Self {
        Self::Stroke(0.0)
    }
}

/// The known data of a yoke.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Yoke {
    /// Force F_0 of the yoke on the rack at s_0 with the play set, N.
    pub preload_n: Option<f64>,
    /// Rate k_y of the yoke's spring, N/mm.
    pub rate_n_per_mm: Option<f64>,
    /// Stroke s_0 at which the play is set.
    pub set_at: SetAt,
    /// Play J_0 left at s_0, mm.
    pub play_mm: Option<f64>,
    /// Pitch P of the plug's thread, mm.
    pub thread_pitch_mm: Option<f64>,
    /// Coefficient of friction μ_y of the yoke on the rack.
    pub yoke_friction: Option<f64>,
    /// Coefficient of friction μ_m at the teeth.
    pub tooth_friction: Option<f64>,
    /// Torque T_0 of the bearings and seals of the pinion, N m.
    pub bearing_torque_n_m: Option<f64>,
}
