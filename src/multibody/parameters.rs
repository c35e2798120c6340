//! The parameters of a simulation, with defaults. The spec layer writes them, [`Scene::new`](super::Scene::new) checks them once,
//! the runs read them.

use super::SimulationError;

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

/// Masses in place of those of the geometry. 0 is a massless body.
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

/// All parameters of a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Stroke at which the run starts, mm; default 0.
    pub start_mm: f64,
    /// How far the rack travels, mm; default 50.
    pub stroke_mm: f64,
    /// Whether it comes back; default no.
    pub returns: bool,
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
    /// Largest error of a step in a mm of height or of arc at the base circle; default 1e-4 mm.
    pub tolerance_mm: f64,
    /// Travel from one sample to the next, mm; default 0.1. The last one is at the end of the stroke.
    pub spacing_mm: f64,
    /// Largest share of the driven, stored or lost energy, whichever is most, that a step of a run with damping or friction may
    /// lose or make up; default 3e-5. 1 switches it off.
    pub energy_tolerance: f64,
    /// Most steps of a dynamic run, rejected ones included; default 1 000 000.
    pub max_steps: u64,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            start_mm: 0.0,
            stroke_mm: 50.0,
            returns: false,
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
            tolerance_mm: 1e-4,
            energy_tolerance: 3e-5,
            spacing_mm: 0.1,
            max_steps: 1_000_000,
        }
    }
}

/// The name of a parameter for people, the unit of its values, and its domain.
struct Row {
    words: &'static str,
    /// Empty for numbers.
    unit: &'static str,
    domain: [f64; 2],
    /// Its value, if the run has it.
    value: fn(&Parameters) -> Option<f64>,
}

/// Declares the parameters with their rows.
macro_rules! parameters {
    ($($name:ident($words:literal, $unit:literal, $domain:expr) = $value:expr;)*) => {
        /// A number of [`Parameters`].
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum ParameterName {
            $(#[doc = concat!("The ", $words, ".")] $name,)*
        }

        impl ParameterName {
            /// Every parameter, in the order in which they are checked and told.
            pub(crate) const ALL: [Self; ROWS.len()] = [$(Self::$name),*];
        }

        static ROWS: [Row; [$($words),*].len()] =
            [$(Row { words: $words, unit: $unit, domain: $domain, value: $value }),*];
    };
}

parameters! {
    Start("start stroke", "mm", [-1e6, 1e6]) = |p| Some(p.start_mm);
    Stroke("stroke", "mm", [1e-6, 1e6]) = |p| Some(p.stroke_mm);
    Speed("speed", "mm/s", [1e-6, 1e6]) = |p| Some(p.speed_mm_per_s);
    Ramp("start ramp", "mm", [1e-9, 1e6]) = |p| Some(p.ramp_mm);
    YokePreload("yoke preload", "N", [1e-6, 1e9]) = |p| Some(p.yoke()?.preload_n);
    YokeRate("yoke rate", "N/mm", [0.0, 1e9]) = |p| Some(p.yoke()?.rate_n_per_mm);
    YokeClearance("yoke clearance", "mm", [0.0, 1e3]) = |p| Some(p.yoke()?.clearance_mm);
    YokeStop("yoke stop stiffness", "N/mm", [0.0, 1e12]) = |p| Some(p.yoke()?.stop_n_per_mm);
    BushStiffness("bush stiffness", "N/mm", [0.0, 1e9]) = |p| Some(p.yoke()?.bush_n_per_mm);
    Preload("preload", "N", [1e-6, 1e9]) = |p| Some(p.preload_n);
    RollAxisDepth("roll axis depth", "mm", [-1e6, 1e6]) = |p| p.roll_axis_depth_mm();
    Stiffness("contact stiffness", "N/mm^a", [1.0, 1e15]) = |p| Some(p.stiffness);
    StiffnessExponent("stiffness exponent", "", [1.0, 2.5]) = |p| Some(p.stiffness_exponent);
    Damping("contact damping", "N/((mm/s)^b mm^e)", [0.0, 1e15]) = |p| Some(p.damping);
    DampingExponent("damping exponent", "", [1.0, 2.5]) = |p| Some(p.damping_exponent);
    IndentationExponent("indentation exponent", "", [1.0, 2.5]) = |p| Some(p.indentation_exponent);
    Friction("friction coefficient", "", [0.0, 0.5]) = |p| Some(p.friction);
    FrictionSpeed("friction regularisation speed", "mm/s", [1e-9, 1e6]) = |p| Some(p.friction_speed_mm_per_s);
    ProfileNodes("spheres over the profile", "", [2.0, 1e5]) = |p| Some(p.spheres()?.profile_nodes.into());
    WidthNodes("spheres over the width", "", [2.0, 1e5]) = |p| Some(p.spheres()?.width_nodes.into());
    SphereRadius("sphere radius", "mm", [0.0, 1e3]) = |p| Some(p.spheres()?.radius_mm);
    PatchCells("cells of a rack flank", "", [1.0, 1e3]) = |p| Some(p.spheres()?.patch_cells.into());
    Strips("strips over the width", "", [2.0, 1e5]) = |p| Some(p.strips()?.strips.into());
    PinionMass("pinion mass", "kg", [0.0, 1e9]) = |p| p.masses.pinion_kg;
    PinionInertia("pinion inertia", "kg mm²", [0.0, 1e9]) = |p| p.masses.pinion_kg_mm2;
    RackMass("rack mass", "kg", [0.0, 1e9]) = |p| p.masses.rack_kg;
    RackInertia("rack inertia", "kg mm²", [0.0, 1e9]) = |p| p.masses.rack_kg_mm2;
    Tolerance("tolerance", "mm", [1e-12, 1.0]) = |p| Some(p.tolerance_mm);
    EnergyTolerance("energy tolerance", "", [1e-12, 1.0]) = |p| Some(p.energy_tolerance);
    // at least a ten-millionth of the stroke, as `Parameters::check` has it
    Spacing("sample spacing", "mm", [0.0, f64::MAX]) = |p| Some(p.spacing_mm);
    MaxSteps("step limit", "", [1.0, 1e12]) = |p| Some(p.max_steps as f64);
}

display_by_name!(ParameterName);

impl ParameterName {
    fn row(self) -> &'static Row {
        &ROWS[self as usize]
    }

    /// The name that people read.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().words
    }

    /// The unit its values are in, empty for numbers.
    #[must_use]
    pub fn unit(self) -> &'static str {
        self.row().unit
    }

    /// Its value, if the run has it.
    pub(crate) fn value(self, parameters: &Parameters) -> Option<f64> {
        (self.row().value)(parameters)
    }
}

impl Parameters {
    fn spheres(&self) -> Option<SphereGrid> {
        if let ContactModel::Spheres(grid) = self.contact { Some(grid) } else { None }
    }

    fn strips(&self) -> Option<StripGrid> {
        if let ContactModel::Analytic(grid) = self.contact { Some(grid) } else { None }
    }

    fn roll_axis_depth_mm(&self) -> Option<f64> {
        if let Support::FreeRoll { axis_depth_mm } = self.support { Some(axis_depth_mm) } else { None }
    }

    /// The yoke, if there is one.
    pub(super) fn yoke(&self) -> Option<Yoke> {
        if let Support::Yoke(yoke) = self.support { Some(yoke) } else { None }
    }

    /// Checks every number against its domain.
    ///
    /// # Errors
    /// [`SimulationError::OutOfDomain`] names the first one outside.
    pub fn check(&self) -> Result<(), SimulationError> {
        for name in ParameterName::ALL {
            let [min, max] = name.row().domain;
            let min = if name == ParameterName::Spacing { self.stroke_mm * 1e-7 } else { min };
            if let Some(value) = name.value(self).filter(|value| !(min..=max).contains(value)) {
                return Err(SimulationError::OutOfDomain { name, value, min, max });
            }
        }
        Ok(())
    }
}
