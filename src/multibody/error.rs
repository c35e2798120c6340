//! Why a simulation cannot be set up or cannot go on. Raised by the scene and the runs; holds data, words only in
//! `Display`, and always names what to change.

use super::ParameterName;
use crate::mesh::MeshError;
use crate::quantity::Rounded;

/// A value with its unit, and the domain that it is outside of.
fn outside(name: ParameterName, value: f64, min: f64, max: f64) -> String {
    let value = format!("{} {}", Rounded(value), name.unit());
    if max == f64::MAX {
        format!("{} is below {}", value.trim_end(), Rounded(min))
    } else {
        format!("{} is outside {} .. {}", value.trim_end(), Rounded(min), Rounded(max))
    }
}

/// Why there is no simulation, or why it stopped.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A parameter outside its domain (NaN and infinities always are).
    #[error("{name} = {}", outside(*.name, *.value, *.min, *.max))]
    OutOfDomain {
        /// Which one.
        name: ParameterName,
        /// Its value.
        value: f64,
        /// Smallest allowed value.
        min: f64,
        /// Largest allowed value.
        max: f64,
    },
    /// The rigid mesh, from which every run starts, has no solution.
    #[error("no start position: {0}")]
    Mesh(#[from] MeshError),
    /// There are so few spheres, rows or strips that contacts fall between them.
    #[error(
        "contacts may sink by {resolution_mm:.4} mm between two spheres or strips, more than {limit_mm} mm; \
         raise the number of spheres over profile and width, or of strips"
    )]
    TooCoarse {
        /// How far they may sink.
        resolution_mm: f64,
        /// The largest depth allowed: 0.005 of the normal module.
        limit_mm: f64,
    },
    /// Newton's method found no equilibrium at a stroke.
    #[error(
        "stroke {stroke_mm:.4} mm: no equilibrium within {iterations} iterations, {residual_n:.2e} N are left; \
         lower the contact stiffness or refine the discretisation"
    )]
    NoEquilibrium {
        /// The stroke.
        stroke_mm: f64,
        /// Iterations made.
        iterations: u32,
        /// Unbalanced force, N.
        residual_n: f64,
    },
    /// The flanks penetrate further than the contact law is valid for.
    #[error(
        "stroke {stroke_mm:.4} mm: penetration {penetration_mm:.4} mm exceeds {limit_mm} mm; \
         raise the contact stiffness or lower the preload"
    )]
    TooDeep {
        /// The stroke.
        stroke_mm: f64,
        /// The penetration.
        penetration_mm: f64,
        /// The largest one allowed: a tenth of the normal module.
        limit_mm: f64,
    },
    /// The step that the tolerance asks for cannot be made.
    #[error(
        "time {time_s:.6} s (stroke {stroke_mm:.4} mm): the step fell below {step_s:.1e} s; \
         loosen the tolerance, raise the damping or lower the stiffness"
    )]
    StepTooSmall {
        /// The time.
        time_s: f64,
        /// The stroke.
        stroke_mm: f64,
        /// The step.
        step_s: f64,
    },
    /// The run took more steps than it may.
    #[error(
        "time {time_s:.6} s (stroke {stroke_mm:.4} mm): {steps} steps are spent; raise the step limit or the tolerance"
    )]
    TooManySteps {
        /// The time.
        time_s: f64,
        /// The stroke.
        stroke_mm: f64,
        /// Steps made.
        steps: u64,
    },
    /// The pinion has left its tooth space.
    #[error("stroke {stroke_mm:.4} mm: the pinion jumped a tooth; raise the preload or lower the speed")]
    Jumped {
        /// The stroke.
        stroke_mm: f64,
    },
}
