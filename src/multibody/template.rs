//! A pinion flank of one lead for the contact models: its constants and, for spheres, its grid. The scene makes it once per
//! lead.
//!
//! # The grid
//! Rows of spheres at equal distances w over the face, stations at equal steps h of the roll angle τ over the profile.
//! All rows of a flank are the same profile turned by −κ w, so only profiles are stored. A contact line crosses the
//! rows at τ = const + κ w; if all rows had the same stations, κ Δw/h near a small fraction would let many rows meet
//! the line in the same phase and the force would ripple. So row r's stations are shifted by a share of h such that the
//! phases relative to any contact line are r times the golden ratio (modulo 1, in 32nds at most), the most even
//! sequence there is. The ends of the profile carry spheres in every row. Each sphere has the weight of its share of
//! the profile and of the width.
//!
//! # Radii
//! A sphere inside a flank of the radius of curvature ρ = r_b τ / cos β_b must be smaller than ρ. Radii are
//! R = min(R_0, C τ²) with C from [`radius_factor`], small enough that the height of spheres over any plane is monotone
//! to either side of the contact line; see [`super::spheres`].

use super::ParameterName;
use super::error::SimulationError;
use super::parameters::{ContactModel, SphereGrid, StripGrid};
use crate::deviation::PinionForm;
use crate::gear::Pair;
use crate::trig;

/// Phases that rows may have: at most so many, and fewer for profiles with many stations, which need them less.
const PHASES: u32 = 32;
/// Stations of all phases together, about.
const STATIONS: u32 = 4096;
/// The golden ratio less 1.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// How far before the start of the profile a contact line may lie for the monotone bound to be used, rad.
pub(super) const EARLY: f64 = 0.5;

/// A sphere of a profile. Its centre lies at (ξ, ζ) for a flank that starts at the angle 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub(super) xi: f64,
    pub(super) zeta: f64,
    pub(super) radius: f64,
    pub(super) weight: f64,
    /// Removed by the pinion's form, mm.
    pub(super) removed: f64,
}

/// A profile's spheres: those between its ends lie at this share of a step and whole steps on.
#[derive(Debug, Clone)]
pub(super) struct Phase {
    pub(super) shift: f64,
    pub(super) nodes: Vec<Node>,
}

/// A row of spheres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    pub(super) w: f64,
    /// Sine and cosine of κ w.
    pub(super) sin: f64,
    pub(super) cos: f64,
    pub(super) weight: f64,
    pub(super) phase: usize,
    pub(super) removed: f64,
}

/// A flank of one side and lead.
#[derive(Debug, Clone)]
pub(super) struct Template {
    /// Of the side and the lead deviation that it is of.
    pub(super) sign: f64,
    pub(super) lead: f64,
    pub(super) kappa: f64,
    pub(super) base_radius: f64,
    pub(super) sin_base: f64,
    pub(super) cos_base: f64,
    pub(super) start_roll: f64,
    pub(super) tip_roll: f64,
    pub(super) half_face: f64,
    pub(super) step: f64,
    /// Sine and cosine of τ_0, and the largest radius.
    pub(super) sin_start: f64,
    pub(super) cos_start: f64,
    pub(super) widest: f64,
    /// Its inverse.
    pub(super) per_step: f64,
    /// r_b τ_a − R cos β_b at the tip.
    pub(super) last_reach: f64,
    pub(super) phases: Vec<Phase>,
    pub(super) rows: Vec<Row>,
    pub(super) form: PinionForm,
    /// Half the angle that a tooth takes in a section, from its centre line to either flank's start, at most.
    pub(super) tooth_reach: f64,
}

/// C of the radii: the largest for which C cos β_b (τ + 2 tan(δ/2)) ≤ r_b wherever the bound is used.
pub(super) fn radius_factor(base_radius: f64, cos_base: f64, tip_roll: f64) -> f64 {
    let widest = tip_roll + EARLY;
    if widest > 2.5 { 0.0 } else { base_radius / (cos_base * (tip_roll + 2.0 * trig::tan(0.5 * widest))) }
}

/// Spheres of a flank at most: a run with so many takes a minute.
const MOST_NODES: f64 = 2e6;

impl Template {
    pub(super) fn new(
        pair: &Pair,
        sign: f64,
        lead: f64,
        form: PinionForm,
        contact: &ContactModel,
    ) -> Result<Self, SimulationError> {
        let p = pair.pinion();
        let kappa = sign * trig::tan(p.helix_angle_rad + lead) / p.reference_radius_mm;
        let tan_base = p.base_radius_mm * kappa;
        let cos_base = 1.0 / (1.0 + tan_base * tan_base).sqrt();
        let mut template = Self {
            sign,
            lead,
            kappa,
            base_radius: p.base_radius_mm,
            sin_base: tan_base * cos_base,
            cos_base,
            start_roll: p.start_roll_rad,
            tip_roll: p.tip_roll_rad,
            half_face: 0.5 * p.face_width_mm,
            step: p.tip_roll_rad - p.start_roll_rad,
            sin_start: trig::sin(p.start_roll_rad),
            cos_start: trig::cos(p.start_roll_rad),
            widest: 0.0,
            per_step: 0.0,
            last_reach: 0.0,
            phases: Vec::new(),
            rows: Vec::new(),
            form,
            tooth_reach: 0.0,
        };
        if let ContactModel::Spheres(grid) = contact {
            let (profile, width) = (f64::from(grid.profile_nodes), f64::from(grid.width_nodes));
            if profile * width > MOST_NODES {
                let max = (MOST_NODES / width).floor();
                return Err(SimulationError::OutOfDomain {
                    name: ParameterName::ProfileNodes,
                    value: profile,
                    min: 2.0,
                    max,
                });
            }
            template.fill(grid);
        }
        if let ContactModel::Analytic(grid) = contact {
            template.cut(*grid);
        }
        Ok(template)
    }

    /// How far a contact line may sink between the stations of one row, mm: ρ/2 (h/2)² with the radius of curvature
    /// ρ = r_b τ_a / cos β_b at the tip, less the spheres' own.
    pub(super) fn sag(&self) -> f64 {
        if self.phases.is_empty() {
            return 0.0;
        }
        let half = 0.5 * self.step * self.cos_base;
        0.5 * self.base_radius * self.tip_roll / self.cos_base * half * half
    }

    /// How far a corner where the path of contact ends may sink between two rows, mm: r_b τ_a (κ Δw/2)²/2.
    pub(super) fn corner_sag(&self) -> f64 {
        let half = 0.5 * self.kappa * self.row_step();
        0.5 * self.base_radius * self.tip_roll * half * half
    }

    /// Distance of two rows, mm.
    pub(super) fn row_step(&self) -> f64 {
        match &self.rows[..] {
            [first, second, ..] => second.w - first.w,
            _ => 0.0,
        }
    }

    fn cut(&mut self, grid: StripGrid) {
        self.last_reach = self.base_radius * self.tip_roll;
        let width = 2.0 * self.half_face / f64::from(grid.strips);
        for strip in 0..grid.strips {
            let w = -self.half_face + (f64::from(strip) + 0.5) * width;
            self.add_row(w, w / self.half_face, width, 0);
        }
    }

    /// Adds a row at w, which is a share of half the face.
    fn add_row(&mut self, w: f64, share: f64, weight: f64, phase: usize) {
        let (sin, cos) = trig::sin_cos(self.kappa * w);
        self.rows.push(Row { w, sin, cos, weight, phase, removed: self.form.crowning_mm * share * share });
    }

    fn fill(&mut self, grid: &SphereGrid) {
        let intervals = grid.profile_nodes - 1;
        self.step = (self.tip_roll - self.start_roll) / f64::from(intervals);
        self.per_step = 1.0 / self.step;
        self.widest = grid.radius_mm;
        let per_square = radius_factor(self.base_radius, self.cos_base, self.tip_roll);
        let last_radius = grid.radius_mm.min(per_square * self.tip_roll * self.tip_roll);
        self.last_reach = self.base_radius * self.tip_roll - last_radius * self.cos_base;
        let phases = (STATIONS / grid.profile_nodes).clamp(1, PHASES);
        for phase in 0..phases {
            let shift = (f64::from(phase) + 0.5) / f64::from(phases);
            let mut rolls = vec![self.start_roll];
            rolls.extend((0..intervals).map(|k| self.start_roll + (f64::from(k) + shift) * self.step));
            rolls.push(self.tip_roll);
            let nodes = (0..rolls.len()).map(|k| {
                let tau = rolls[k];
                let before = if k == 0 { tau } else { rolls[k - 1] };
                let after = rolls.get(k + 1).copied().unwrap_or(tau);
                let radius = grid.radius_mm.min(per_square * tau * tau);
                let reach = self.base_radius * tau - radius * self.cos_base;
                let (sin, cos) = trig::sin_cos(tau);
                Node {
                    xi: self.base_radius * sin - reach * cos,
                    zeta: -(self.base_radius * cos + reach * sin),
                    radius,
                    weight: 0.5 * (after - before) / self.step,
                    removed: self.form.profile_slope_mm * (tau - self.start_roll) / (self.tip_roll - self.start_roll),
                }
            });
            self.phases.push(Phase { shift, nodes: nodes.collect() });
        }
        let last = grid.width_nodes - 1;
        for r in 0..grid.width_nodes {
            let share = 2.0 * f64::from(r) / f64::from(last) - 1.0;
            let w = self.half_face * share;
            let turn = f64::from(r) * GOLDEN + self.kappa * w / self.step;
            let phase = ((turn - turn.floor()) * f64::from(phases)) as usize;
            let weight = if r == 0 || r == last { 0.5 } else { 1.0 };
            self.add_row(w, share, weight, phase.min(phases as usize - 1));
        }
    }
}
