//! `[simulation]` as written, and the scene that follows from it. Resolved for `simulate` and `report`; runs nothing.

use std::ops::Range;

use super::keys::{self, Key};
use super::reader::SectionReader;
use super::{MeshInput, Spec};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::mesh;
use crate::multibody::{
    ContactModel, Integrator, ParameterName, Parameters, Scene, SimulationError, SphereGrid, StripGrid, Support, Yoke,
};
use crate::quantity::Length;

/// `[simulation]`: the parameters, defaults where nothing is written.
#[derive(Debug, Clone, Default)]
pub struct SimulationSection {
    /// Everything but how the rack may roll, which `[support]` says.
    pub parameters: Parameters,
    /// Where each written number stands.
    places: Vec<(ParameterName, Range<usize>)>,
}

type Number<V, T> = (Key<V>, ParameterName, fn(&mut T, f64));

const LENGTHS: &[Number<Length, Parameters>] = &[
    (keys::SIMULATION_START, ParameterName::Start, |p, v| p.start_mm = v),
    (keys::SIMULATION_STROKE, ParameterName::Stroke, |p, v| p.stroke_mm = v),
    (keys::SIMULATION_RAMP, ParameterName::Ramp, |p, v| p.ramp_mm = v),
    (keys::SIMULATION_TOLERANCE, ParameterName::Tolerance, |p, v| p.tolerance_mm = v),
    (keys::SIMULATION_SPACING, ParameterName::Spacing, |p, v| p.spacing_mm = v),
];

const MEASURES: &[Number<f64, Parameters>] = &[
    (keys::SIMULATION_SPEED, ParameterName::Speed, |p, v| p.speed_mm_per_s = v),
    (keys::SIMULATION_PRELOAD, ParameterName::Preload, |p, v| p.preload_n = v),
    (keys::SIMULATION_STIFFNESS, ParameterName::Stiffness, |p, v| p.stiffness = v),
    (keys::SIMULATION_STIFFNESS_EXPONENT, ParameterName::StiffnessExponent, |p, v| p.stiffness_exponent = v),
    (keys::SIMULATION_DAMPING, ParameterName::Damping, |p, v| p.damping = v),
    (keys::SIMULATION_DAMPING_EXPONENT, ParameterName::DampingExponent, |p, v| p.damping_exponent = v),
    (keys::SIMULATION_INDENTATION_EXPONENT, ParameterName::IndentationExponent, |p, v| p.indentation_exponent = v),
    (keys::SIMULATION_FRICTION, ParameterName::Friction, |p, v| p.friction = v),
    (keys::SIMULATION_FRICTION_SPEED, ParameterName::FrictionSpeed, |p, v| p.friction_speed_mm_per_s = v),
    (keys::SIMULATION_PINION_MASS, ParameterName::PinionMass, |p, v| p.masses.pinion_kg = Some(v)),
    (keys::SIMULATION_PINION_INERTIA, ParameterName::PinionInertia, |p, v| p.masses.pinion_kg_mm2 = Some(v)),
    (keys::SIMULATION_RACK_MASS, ParameterName::RackMass, |p, v| p.masses.rack_kg = Some(v)),
    (keys::SIMULATION_RACK_INERTIA, ParameterName::RackInertia, |p, v| p.masses.rack_kg_mm2 = Some(v)),
];

const YOKE: &[Number<f64, Yoke>] = &[
    (keys::SIMULATION_YOKE_PRELOAD, ParameterName::YokePreload, |y, v| y.preload_n = v),
    (keys::SIMULATION_YOKE_RATE, ParameterName::YokeRate, |y, v| y.rate_n_per_mm = v),
    (keys::SIMULATION_YOKE_STOP, ParameterName::YokeStop, |y, v| y.stop_n_per_mm = v),
    (keys::SIMULATION_YOKE_BUSH, ParameterName::BushStiffness, |y, v| y.bush_n_per_mm = v),
];

/// Reads `[simulation]`.
pub(super) fn read(reader: &mut SectionReader<'_>) -> SimulationSection {
    let mut section = SimulationSection::default();
    let SimulationSection { parameters, places } = &mut section;
    let before = reader.diagnostics.len();
    for &(key, name, set) in LENGTHS {
        if let Some(length) = reader.get(key) {
            set(parameters, length.value.mm());
            places.push((name, length.span));
        }
    }
    for &(key, name, set) in MEASURES {
        if let Some(number) = reader.get(key) {
            set(parameters, number.value);
            places.push((name, number.span));
        }
    }
    parameters.contact = contact(reader, places);
    if let Some(word) = reader.get(keys::SIMULATION_INTEGRATOR) {
        parameters.integrator = if word.value == "explicit" { Integrator::Explicit } else { Integrator::Implicit };
    }
    if let Some(steps) = reader.get(keys::SIMULATION_MAX_STEPS) {
        parameters.max_steps = u64::from(steps.value);
        places.push((ParameterName::MaxSteps, steps.span));
    }
    let yoke = yoke(reader, parameters.preload_n, places);
    if reader.get(keys::SIMULATION_SUPPORT).is_some_and(|word| word.value == "yoke") {
        parameters.support = Support::Yoke(yoke);
    }
    // what follows from one value alone has been said; now what the model allows
    if reader.diagnostics.len() == before
        && let Err(error) = section.parameters.check()
    {
        let span = section.place(&error);
        reader.report(Diagnostic::error(Code::OutOfDomain, error.to_string()), span.unwrap_or(0..0), "");
    }
    section
}

fn contact(reader: &mut SectionReader<'_>, places: &mut Vec<(ParameterName, Range<usize>)>) -> ContactModel {
    let mut count = |key, name, value: &mut u32| {
        if let Some(count) = reader.get(key) {
            *value = count.value;
            places.push((name, count.span));
        }
    };
    let (mut spheres, mut strips) = (SphereGrid::default(), StripGrid::default());
    count(keys::SIMULATION_PROFILE_NODES, ParameterName::ProfileNodes, &mut spheres.profile_nodes);
    count(keys::SIMULATION_WIDTH_NODES, ParameterName::WidthNodes, &mut spheres.width_nodes);
    count(keys::SIMULATION_PATCH_CELLS, ParameterName::PatchCells, &mut spheres.patch_cells);
    count(keys::SIMULATION_STRIPS, ParameterName::Strips, &mut strips.strips);
    if let Some(radius) = reader.get(keys::SIMULATION_SPHERE_RADIUS) {
        spheres.radius_mm = radius.value.mm();
        places.push((ParameterName::SphereRadius, radius.span));
    }
    match reader.get(keys::SIMULATION_CONTACT) {
        Some(word) if word.value == "analytic" => ContactModel::Analytic(strips),
        _ => ContactModel::Spheres(spheres),
    }
}

fn yoke(reader: &mut SectionReader<'_>, preload_n: f64, places: &mut Vec<(ParameterName, Range<usize>)>) -> Yoke {
    let default = Yoke { preload_n, ..Yoke::default() };
    let read = reader.table("yoke", &keys::YOKE, |reader| {
        let mut yoke = default;
        for &(key, name, set) in YOKE {
            if let Some(number) = reader.get(key) {
                set(&mut yoke, number.value);
                places.push((name, number.span));
            }
        }
        if let Some(clearance) = reader.get(keys::SIMULATION_YOKE_CLEARANCE) {
            yoke.clearance_mm = clearance.value.mm();
            places.push((ParameterName::YokeClearance, clearance.span));
        }
        yoke
    });
    read.map_or(default, |read| read.value)
}

impl SimulationSection {
    fn place(&self, error: &SimulationError) -> Option<Range<usize>> {
        let SimulationError::OutOfDomain { name, .. } = error else { return None };
        self.places.iter().find(|(written, _)| written == name).map(|(_, span)| span.clone())
    }
}

impl Spec {
    /// The simulation of a mesh's parts, held as `[support]` and `[simulation]` say.
    ///
    /// # Errors
    /// A diagnostic for a parameter that the model refuses, or for supports that contradict each other.
    pub fn scene(&self, input: &MeshInput) -> Result<Scene, Diagnostics> {
        let mut parameters = self.simulation.parameters;
        let mesh = &input.mesh;
        if let mesh::Support::FreeRoll { axis_depth_mm } = mesh.support() {
            if matches!(parameters.support, Support::Yoke(_)) {
                let span = self.place(keys::SUPPORT_ROLL).unwrap_or(0..0);
                let diagnostic =
                    Diagnostic::error(Code::Usage, "a rack carried by a yoke is not solved with free roll")
                        .at(&self.source, span, "")
                        .help("write roll = \"fixed\", or simulation.support = \"slider\"");
                return Err(diagnostic.into());
            }
            parameters.support = Support::FreeRoll { axis_depth_mm };
        }
        Scene::new(*mesh.pair(), mesh.rack().clone(), mesh.pinion().clone(), parameters).map_err(|error| {
            let diagnostic = Diagnostic::error(Code::NoSimulation, error.to_string());
            match self.simulation.place(&error) {
                Some(span) => diagnostic.at(&self.source, span, "").into(),
                None => diagnostic.into(),
            }
        })
    }
}
