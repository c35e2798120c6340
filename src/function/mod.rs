#![doc = include_str!("method.md")]
//!
//! Called for solved curves ([`Function::of`]) and bounds of ΔCD ([`SafeSettings`]), of one part or, by [`YokeJudge`], of many;
//! solves strokes to find extremes between the points of a curve, and knows nothing of files.

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
    /// Where the rack stands farthest from the pinion.
    Tightest,
}

impl Default for SetAt {
    fn default() -> Self {
        Self::Stroke(0.0)
    }
}

/// What is known of a yoke.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Yoke {
    /// F_0: the force on the rack where the play is set, once it is set, N.
    pub preload_n: Option<f64>,
    /// k_y, N/mm.
    pub rate_n_per_mm: Option<f64>,
    /// s_0.
    pub set_at: SetAt,
    /// J_0: the play left there, mm.
    pub play_mm: Option<f64>,
    /// P: travel of the plug for each turn of its thread, mm.
    pub thread_pitch_mm: Option<f64>,
    /// μ_y, between yoke and rack.
    pub yoke_friction: Option<f64>,
    /// μ_m, between the teeth.
    pub tooth_friction: Option<f64>,
    /// T_0: what the bearings and seals of the pinion take, N m.
    pub bearing_torque_n_m: Option<f64>,
}
