//! What a simulation can be told, with defaults. Written by the spec layer, checked once by
//! [`Scene::new`](super::Scene::new), read by the runs.

use super::error::{ParameterName as Name, SimulationError};

/// Spheres on the pinion's flanks, triangles on the rack's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereGrid {
    /// Spheres over the profile of a flank, from the start of the involute to the tip; default 48.
    pub profile_nodes: u32,
    /// Rows of spheres over the face width; default 96.
    pub width_nodes: u32,
    /// Largest radius R of a sphere, mm; default 0.1. Towards the base circle the radius falls as τ², so that no
    /// sphere stands out of the flank. Spheres round the pinion's tip edge off: where a tooth that stands proud by e
    /// carries there, ΔCD comes out up to e R/((r_b τ_a − R) sin α_n) too high.
    pub radius_mm: f64,
    /// Cells (of two triangles) of a rack flank along each direction where it has crowning or relief; default 32. A
    /// plane flank needs one.
    pub patch_cells: u32,
}

/// Strips of the exact surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripGrid {
    /// Strips over the pinion's face width; default 256.
    pub strips: u32,
}

/// How two flanks touch.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ContactModel {
    /// Spheres on the pinion against triangles of the rack; the stiffness is that of one sphere, N/mm^a.
    Spheres(SphereGrid),
    /// Exact helicoid against exact plane, load spread over the contact line; the stiffness is that of 1 mm of line,
    /// N/mm^a per mm.
    Analytic(StripGrid),
}

impl Default for SphereGrid {
    fn default() -> Self {
        Self { profile_nodes: 48, width_nodes: 96, radius_mm: 0.1, patch_cells: 32 }
    }
}

impl Default for StripGrid {
    fn default() -> Self {
        Self { strips: 256 }
    }
}

impl Default for ContactModel {
    fn default() -> Self {
        Self::Spheres(SphereGrid::default())
    }
}

/// A yoke that presses the rack against a pinion with a fixed axis.
///
/// Pinion, yoke and bush are all fixed in the housing and the rack slides through them, so the lever L from the bush to
/// the mesh is the same at every stroke. The yoke stands right behind the mesh, so of the bush only what resists the
/// rack's tilt reaches the mesh: a bush with the tilting stiffness k_φ (N mm/rad) is felt there as k_φ/L². A tooth one
/// pitch from the mesh moves with the tilt ΔCD/L, which changes ΔCD by at most p ΔCD/(2 L): under 1 % for the usual
/// levers above 300 mm, and left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Yoke {
    /// Force of the yoke's spring with the rack at a_0, N; default 500.
    pub preload_n: f64,
    /// Rate of the spring, N/mm; default 100.
    pub rate_n_per_mm: f64,
    /// Travel backwards from a_0 until the yoke meets its solid stop, mm; default 0.15.
    pub clearance_mm: f64,
    /// Stiffness of the stop, N/mm; default 1e5.
    pub stop_n_per_mm: f64,
    /// Stiffness of the flexible bush at the rack's other end as it is felt at the mesh, k_φ/L², N/mm; default 20.
    pub bush_n_per_mm: f64,
}

impl Default for Yoke {
    fn default() -> Self {
        Self { preload_n: 500.0, rate_n_per_mm: 100.0, clearance_mm: 0.15, stop_n_per_mm: 1e5, bush_n_per_mm: 20.0 }
    }
}

/// How the parts are held.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Support {
    /// The rack cannot roll; the pinion's slider is pressed on by the preload.
    #[default]
    Fixed,
    /// As [`Support::Fixed`], but the rack may roll about an axis along X this far below the reference plane, mm.
    FreeRoll {
        /// Depth of the axis, mm.
        axis_depth_mm: f64,
    },
    /// The pinion's axis is fixed; the yoke presses the rack on.
    Yoke(Yoke),
}

/// Masses, where the geometry's are not wanted. 0 is a massless body.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Masses {
    /// Pinion, kg; default a steel cylinder of reference radius and face width.
    pub pinion_kg: Option<f64>,
    /// Pinion about its axis, kg mm²; default that cylinder's.
    pub pinion_kg_mm2: Option<f64>,
    /// Rack, kg; default a round steel bar with the face width as its diameter, as long as the stroke and ten
    /// diameters.
    pub rack_kg: Option<f64>,
    /// Rack about its roll axis, kg mm²; default that bar's about its own axis.
    pub rack_kg_mm2: Option<f64>,
}

/// How time is stepped through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Integrator {
    /// TR-BDF2 (Bank et al. 1985, with the error estimate of Hosea and Shampine 1996): implicit, second order,
    /// L-stable.
    #[default]
    Implicit,
    /// Velocity Verlet: explicit, second order; for comparison.
    Explicit,
}

/// Everything a simulation can be told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Stroke at which the run starts, mm; default 0.
    pub start_mm: f64,
    /// How far the rack travels, mm; default 50.
    pub stroke_mm: f64,
    /// Its speed, mm/s; default 20.
    pub speed_mm_per_s: f64,
    /// Travel during which the speed is reached, mm; default 1.
    pub ramp_mm: f64,
    /// Force that presses the pinion on, N; default 500. [`Support::Yoke`] has its own.
    pub preload_n: f64,
    /// Contact stiffness k, see [`ContactModel`]; default 1e7.
    pub stiffness: f64,
    /// Exponent a of the penetration, 1..2.5; default 1.5.
    pub stiffness_exponent: f64,
    /// Damping c; default 5e5.
    pub damping: f64,
    /// Exponent b of the penetration's rate, 1..2.5; default 1.
    pub damping_exponent: f64,
    /// Exponent e of the penetration in the damping term, 1..2.5; default 1.5.
    pub indentation_exponent: f64,
    /// Friction coefficient μ; default 0.
    pub friction: f64,
    /// Sliding speed below which friction fades, mm/s; default 0.1.
    pub friction_speed_mm_per_s: f64,
    /// How flanks touch.
    pub contact: ContactModel,
    /// Skip what provably cannot touch; default true. The result is the same to the last bit.
    pub cull: bool,
    /// How the parts are held.
    pub support: Support,
    /// Masses and inertias.
    pub masses: Masses,
    /// How time is stepped through.
    pub integrator: Integrator,
    /// Largest error of a step in a mm of height or of arc at the base circle; default 1e-4 mm.
    pub tolerance_mm: f64,
    /// Travel from one sample to the next, mm; default 0.1. The last one is at the end of the stroke.
    pub spacing_mm: f64,
    /// Largest drift of the energy in a run without damping and friction, as a share of the energy exchanged; default
    /// 1e-6. The implicit scheme's steps are shortened, and vibrations that they would damp are followed, until it
    /// holds: most such runs take a second, one whose contacts ring through all the stroke ten to thirty. 1 leaves
    /// it out, and with it the shortening of steps that lose energy in a run with damping or friction.
    pub energy_tolerance: f64,
    /// Most steps of a dynamic run, rejected ones included; default 1 000 000.
    pub max_steps: u64,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            start_mm: 0.0,
            stroke_mm: 50.0,
            speed_mm_per_s: 20.0,
            ramp_mm: 1.0,
            preload_n: 500.0,
            stiffness: 1e7,
            stiffness_exponent: 1.5,
            damping: 5e5,
            damping_exponent: 1.0,
            indentation_exponent: 1.5,
            friction: 0.0,
            friction_speed_mm_per_s: 0.1,
            contact: ContactModel::default(),
            cull: true,
            support: Support::default(),
            masses: Masses::default(),
            integrator: Integrator::default(),
            tolerance_mm: 1e-4,
            energy_tolerance: 1e-6,
            spacing_mm: 0.1,
            max_steps: 1_000_000,
        }
    }
}

impl Parameters {
    /// Checks every number against its domain.
    ///
    /// # Errors
    /// [`SimulationError::OutOfDomain`] names the first one outside.
    pub fn check(&self) -> Result<(), SimulationError> {
        let within = |name, value: f64, min: f64, max: f64| {
            if value >= min && value <= max {
                Ok(())
            } else {
                Err(SimulationError::OutOfDomain { name, value, min, max })
            }
        };
        within(Name::Start, self.start_mm, -1e6, 1e6)?;
        within(Name::Stroke, self.stroke_mm, 1e-6, 1e6)?;
        within(Name::Speed, self.speed_mm_per_s, 1e-6, 1e6)?;
        within(Name::Ramp, self.ramp_mm, 1e-9, 1e6)?;
        within(Name::Preload, self.preload_n, 1e-6, 1e9)?;
        within(Name::Stiffness, self.stiffness, 1.0, 1e15)?;
        within(Name::StiffnessExponent, self.stiffness_exponent, 1.0, 2.5)?;
        within(Name::Damping, self.damping, 0.0, 1e15)?;
        within(Name::DampingExponent, self.damping_exponent, 1.0, 2.5)?;
        within(Name::IndentationExponent, self.indentation_exponent, 1.0, 2.5)?;
        within(Name::Friction, self.friction, 0.0, 0.5)?;
        within(Name::FrictionSpeed, self.friction_speed_mm_per_s, 1e-9, 1e6)?;
        match self.contact {
            ContactModel::Spheres(grid) => {
                within(Name::ProfileNodes, f64::from(grid.profile_nodes), 2.0, 1e5)?;
                within(Name::WidthNodes, f64::from(grid.width_nodes), 2.0, 1e5)?;
                within(Name::SphereRadius, grid.radius_mm, 0.0, 1e3)?;
                within(Name::PatchCells, f64::from(grid.patch_cells), 1.0, 1e3)?;
            }
            ContactModel::Analytic(grid) => within(Name::Strips, f64::from(grid.strips), 2.0, 1e5)?,
        }
        match self.support {
            Support::Fixed => {}
            Support::FreeRoll { axis_depth_mm } => within(Name::RollAxisDepth, axis_depth_mm, -1e6, 1e6)?,
            Support::Yoke(yoke) => {
                within(Name::YokePreload, yoke.preload_n, 1e-6, 1e9)?;
                within(Name::YokeRate, yoke.rate_n_per_mm, 0.0, 1e9)?;
                within(Name::YokeClearance, yoke.clearance_mm, 0.0, 1e3)?;
                within(Name::YokeStop, yoke.stop_n_per_mm, 0.0, 1e12)?;
                within(Name::BushStiffness, yoke.bush_n_per_mm, 0.0, 1e9)?;
            }
        }
        for (name, value) in [
            (Name::PinionMass, self.masses.pinion_kg),
            (Name::PinionInertia, self.masses.pinion_kg_mm2),
            (Name::RackMass, self.masses.rack_kg),
            (Name::RackInertia, self.masses.rack_kg_mm2),
        ] {
            within(name, value.unwrap_or(0.0), 0.0, 1e9)?;
        }
        within(Name::Tolerance, self.tolerance_mm, 1e-12, 1.0)?;
        within(Name::EnergyTolerance, self.energy_tolerance, 1e-12, 1.0)?;
        within(Name::Spacing, self.spacing_mm, self.stroke_mm * 1e-7, f64::MAX)?;
        within(Name::MaxSteps, self.max_steps as f64, 1.0, 1e12)
    }
}
