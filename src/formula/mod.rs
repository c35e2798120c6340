//! The closed formulas: what one manufacturing error does to the operating centre distance.
//!
//! The formulas of the paper *Effects of Gear Manufacturing Errors on Rack and Pinion Steering Meshing*, sections 2.1 and
//! 2.2, and one for the pinion's lead, which the paper does not have. Each has a page with its equation, symbols, units,
//! domain and source. The formulas of ΔCD are [laws](Law): value, inverse (the largest error that stays within a ΔCD) and
//! sensitivities (∂ΔCD/∂input) in one place. The [evaluation](crate::evaluation) evaluates and combines them. Formulas
//! take validated quantities and know nothing of files or tables.
//!
//! | error | ΔCD | law |
//! |---|---|---|
//! | rack over-roller error | `M - M_nom` | [`Law::rack_over_roller`] |
//! | rack pitch error | `\|Δp\| cos β_r / (2 tan α_n)` | [`Law::rack_pitch`] |
//! | rack lead angle error | `k \|sin Δβ\| / (2 cos β_r tan α_n)` | [`Law::rack_lead`] |
//! | pinion radial error | `r - r_nom` | [`Law::pinion_radial`] |
//! | pinion single pitch error | `\|f_p\| cos β_p / (2 tan α_n)` | [`Law::pinion_pitch`] |
//! | pinion helix slope deviation | `\|f_Hβ\| cos β_b / (2 sin α_n)` | [`Law::pinion_lead`] |
//!
//! [`mesh::relations`](crate::mesh::relations) derives the exact formulas.
//!
//! # Precision
#![doc = include_str!("precision.md")]

pub mod domain;
pub mod ideal_pin;
pub mod law;
pub mod over_pin;
pub mod roller_change;

mod catalogue;
mod influence;
mod part_deviation;

#[cfg(feature = "spec")]
pub(crate) use catalogue::OVER_PIN;
pub use catalogue::{CATALOGUE, FormulaPage};
#[cfg(feature = "cli")]
pub(crate) use catalogue::{IDEAL_PIN, ROLLER_CHANGE};
pub use influence::Influence;
pub use law::{Geometry, Law};
pub use part_deviation::{PartDeviation, ToleranceEnds};

use crate::quantity::Length;

named! {
    /// Which formula to use where the paper's differs from the exact one.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    #[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
    pub enum Model {
        /// Exact for rigid teeth.
        ///
        /// The pressure angle is taken in the plane in which the error was measured.
        #[default]
        Exact = "exact",
        /// As the paper prints it; for the pinion's lead, for which the paper has no formula, the exact one.
        Paper = "paper",
    }
}

impl Model {
    /// The other model, with which results of this one are compared.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Exact => Self::Paper,
            Self::Paper => Self::Exact,
        }
    }
}

display_by_name!(Model);

/// One partial derivative of a formula's result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivity {
    /// The quantity that varies.
    pub input: Influence,
    /// ∂result/∂input, in mm per mm or mm per degree. `None` at a kink, where there is no
    /// derivative: |Δp| and |sin Δβ| at zero error.
    pub value: Option<f64>,
}

impl Sensitivity {
    fn new(input: Influence, value: f64) -> Self {
        Self { input, value: Some(value) }
    }

    /// Converts a derivative by radians to one by degrees: ∂/∂degree = π/180 ∂/∂radian.
    fn by_angle(input: Influence, per_radian: f64) -> Self {
        Self::new(input, per_radian * law::RADIANS_PER_DEGREE)
    }
}

/// A length in femtometres for the arithmetic of a formula.
pub(crate) fn femtometres(length: Length) -> f64 {
    length.fm() as f64
}
