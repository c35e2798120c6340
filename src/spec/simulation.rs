//! `[simulation]` as written, and the scene that follows from it, for `simulate` and `report`; runs nothing.

use std::ops::Range;

use super::keys::{self, AnyKey};
use super::reader::SectionReader;
use super::value::{Value, Values};
use super::{Located, MeshInput, Spec};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::mesh;
use crate::multibody::{
    ContactModel, ParameterName as Name, Parameters, Scene, SimulationError, SphereGrid, StripGrid, Support, Yoke,
};

/// The target of a number of `[simulation]`.
#[derive(Default)]
struct Numbers {
    all: Parameters,
    yoke: Yoke,
    spheres: SphereGrid,
    strips: StripGrid,
}

/// A number: its key, its name in the simulation, and its target.
type Number = (AnyKey, Name, fn(&mut Numbers, f64));

const NUMBERS: &[Number] = &[
    (keys::SIMULATION_START.any, Name::Start, |n, v| n.all.start_mm = v),
    (keys::SIMULATION_STROKE.any, Name::Stroke, |n, v| n.all.stroke_mm = v),
    (keys::SIMULATION_RAMP.any, Name::Ramp, |n, v| n.all.ramp_mm = v),
    (keys::SIMULATION_TOLERANCE.any, Name::Tolerance, |n, v| n.all.tolerance_mm = v),
    (keys::SIMULATION_SPACING.any, Name::Spacing, |n, v| n.all.spacing_mm = v),
    (keys::SIMULATION_SPEED.any, Name::Speed, |n, v| n.all.speed_mm_per_s = v),
    (keys::SIMULATION_PRELOAD.any, Name::Preload, |n, v| n.all.preload_n = v),
    (keys::SIMULATION_STIFFNESS.any, Name::Stiffness, |n, v| n.all.stiffness = v),
    (keys::SIMULATION_STIFFNESS_EXPONENT.any, Name::StiffnessExponent, |n, v| n.all.stiffness_exponent = v),
    (keys::SIMULATION_DAMPING.any, Name::Damping, |n, v| n.all.damping = v),
    (keys::SIMULATION_DAMPING_EXPONENT.any, Name::DampingExponent, |n, v| n.all.damping_exponent = v),
    (keys::SIMULATION_INDENTATION_EXPONENT.any, Name::IndentationExponent, |n, v| n.all.indentation_exponent = v),
    (keys::SIMULATION_FRICTION.any, Name::Friction, |n, v| n.all.friction = v),
    (keys::SIMULATION_FRICTION_SPEED.any, Name::FrictionSpeed, |n, v| n.all.friction_speed_mm_per_s = v),
    (keys::SIMULATION_PINION_MASS.any, Name::PinionMass, |n, v| n.all.masses.pinion_kg = Some(v)),
    (keys::SIMULATION_PINION_INERTIA.any, Name::PinionInertia, |n, v| n.all.masses.pinion_kg_mm2 = Some(v)),
    (keys::SIMULATION_RACK_MASS.any, Name::RackMass, |n, v| n.all.masses.rack_kg = Some(v)),
    (keys::SIMULATION_RACK_INERTIA.any, Name::RackInertia, |n, v| n.all.masses.rack_kg_mm2 = Some(v)),
    (keys::SIMULATION_MAX_STEPS.any, Name::MaxSteps, |n, v| n.all.max_steps = v as u64),
    (keys::SIMULATION_PROFILE_NODES.any, Name::ProfileNodes, |n, v| n.spheres.profile_nodes = v as u32),
    (keys::SIMULATION_WIDTH_NODES.any, Name::WidthNodes, |n, v| n.spheres.width_nodes = v as u32),
    (keys::SIMULATION_PATCH_CELLS.any, Name::PatchCells, |n, v| n.spheres.patch_cells = v as u32),
    (keys::SIMULATION_SPHERE_RADIUS.any, Name::SphereRadius, |n, v| n.spheres.radius_mm = v),
    (keys::SIMULATION_STRIPS.any, Name::Strips, |n, v| n.strips.strips = v as u32),
    (keys::YOKE_PRELOAD.any, Name::YokePreload, |n, v| n.yoke.preload_n = v),
    (keys::YOKE_RATE.any, Name::YokeRate, |n, v| n.yoke.rate_n_per_mm = v),
    (keys::YOKE_STOP.any, Name::YokeStop, |n, v| n.yoke.stop_n_per_mm = v),
    (keys::YOKE_BUSH.any, Name::BushStiffness, |n, v| n.yoke.bush_n_per_mm = v),
    (keys::YOKE_CLEARANCE.any, Name::YokeClearance, |n, v| n.yoke.clearance_mm = v),
];

/// Reads `[simulation]`: the parameters, defaults where nothing is written.
pub(super) fn read(reader: &mut SectionReader<'_>, values: &mut Values) -> Parameters {
    let before = reader.diagnostics.len();
    reader.values(values);
    let parameters = parameters(values);
    // each value was checked alone; now the model checks them together
    if reader.diagnostics.len() == before
        && let Err(error) = parameters.check()
    {
        let span = place(values, &error).unwrap_or(0..0);
        reader.report(Diagnostic::error(Code::OutOfDomain, error.to_string()), span);
    }
    parameters
}

fn parameters(values: &Values) -> Parameters {
    let word = |key| values.located(key).map_or("", |word: Located<&'static str>| word.value);
    let mut numbers = Numbers::default();
    for (key, _, set) in NUMBERS {
        match values.at(key.path).map(|written| &written.value) {
            Some(Value::Length(length)) => set(&mut numbers, length.mm()),
            Some(Value::Number(number)) => set(&mut numbers, *number),
            Some(Value::Count(count)) => set(&mut numbers, f64::from(*count)),
            _ => {}
        }
    }
    let Numbers { all: mut parameters, mut yoke, spheres, strips } = numbers;
    parameters.returns = word(keys::SIMULATION_DIRECTION) == "both";
    let is_analytic = word(keys::SIMULATION_CONTACT) == "analytic";
    parameters.contact = if is_analytic { ContactModel::Analytic(strips) } else { ContactModel::Spheres(spheres) };
    if values.at(keys::YOKE_PRELOAD.any.path).is_none() {
        yoke.preload_n = parameters.preload_n;
    }
    if word(keys::SIMULATION_SUPPORT) == "yoke" {
        parameters.support = Support::Yoke(yoke);
        if values.at(keys::SIMULATION_FRICTION.any.path).is_none()
            && let Some(friction) = values.located(keys::YOKE_FRICTION_TEETH)
        {
            parameters.friction = friction.value;
        }
    }
    parameters
}

/// The place of the refused number.
fn place(values: &Values, error: &SimulationError) -> Option<Range<usize>> {
    let SimulationError::OutOfDomain { name, .. } = error else { return None };
    let (key, ..) = NUMBERS.iter().find(|(_, of, _)| of == name)?;
    values.at(key.path).map(|written| written.span.clone())
}

impl Spec {
    /// The simulation of a mesh's parts, held as `[support]` and `[simulation]` say.
    ///
    /// # Errors
    /// A diagnostic for a parameter that the model refuses, or for supports that contradict each other.
    pub fn scene(&self, input: &MeshInput) -> Result<Scene, Diagnostics> {
        let mut parameters = self.simulation;
        let mesh = &input.mesh;
        if let mesh::Support::FreeRoll { axis_depth_mm } = mesh.support() {
            if matches!(parameters.support, Support::Yoke(_)) {
                let diagnostic = Diagnostic::usage("a rack carried by a yoke is not solved with free roll")
                    .at(&self.source, self.place(keys::SUPPORT_ROLL), "")
                    .help("write roll = \"fixed\", or simulation.support = \"slider\"");
                return Err(diagnostic.into());
            }
            parameters.support = Support::FreeRoll { axis_depth_mm };
        }
        if let Support::Yoke(yoke) = parameters.support {
            let strokes = parameters.start_mm..parameters.start_mm + parameters.stroke_mm;
            parameters.support = Support::Yoke(self.simulated_yoke(mesh, yoke, strokes)?);
        }
        Scene::new(*mesh.pair(), mesh.rack().clone(), mesh.pinion().clone(), parameters).map_err(|error| {
            Diagnostic::error(Code::NoSimulation, error.to_string())
                .at(&self.source, place(&self.values, &error), "")
                .into()
        })
    }
}
