//! `[simulation]` as written, and the scene that follows from it. Resolved for `simulate` and `report`; runs nothing.

use std::ops::Range;

use super::keys;
use super::reader::SectionReader;
use super::{MeshInput, Spec};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::mesh;
use crate::multibody::{
    ContactModel, Integrator, ParameterName, Parameters, Scene, SimulationError, SphereGrid, StripGrid, Support, Yoke,
};

/// `[simulation]`: the parameters, defaults where nothing is written.
#[derive(Debug, Clone, Default)]
pub struct SimulationSection {
    /// Everything but how the rack may roll, which `[support]` says.
    pub parameters: Parameters,
    /// Where each written number stands.
    places: Vec<(ParameterName, Range<usize>)>,
}

type Number<T> = (&'static str, ParameterName, fn(&mut T, f64));

const LENGTHS: &[Number<Parameters>] = &[
    ("start", ParameterName::Start, |p, v| p.start_mm = v),
    ("stroke", ParameterName::Stroke, |p, v| p.stroke_mm = v),
    ("ramp", ParameterName::Ramp, |p, v| p.ramp_mm = v),
    ("tolerance", ParameterName::Tolerance, |p, v| p.tolerance_mm = v),
    ("spacing", ParameterName::Spacing, |p, v| p.spacing_mm = v),
];

const MEASURES: &[Number<Parameters>] = &[
    ("speed", ParameterName::Speed, |p, v| p.speed_mm_per_s = v),
    ("preload", ParameterName::Preload, |p, v| p.preload_n = v),
    ("stiffness", ParameterName::Stiffness, |p, v| p.stiffness = v),
    ("stiffness_exponent", ParameterName::StiffnessExponent, |p, v| p.stiffness_exponent = v),
    ("damping", ParameterName::Damping, |p, v| p.damping = v),
    ("damping_exponent", ParameterName::DampingExponent, |p, v| p.damping_exponent = v),
    ("indentation_exponent", ParameterName::IndentationExponent, |p, v| p.indentation_exponent = v),
    ("friction", ParameterName::Friction, |p, v| p.friction = v),
    ("friction_speed", ParameterName::FrictionSpeed, |p, v| p.friction_speed_mm_per_s = v),
    ("pinion_mass", ParameterName::PinionMass, |p, v| p.masses.pinion_kg = Some(v)),
    ("pinion_inertia", ParameterName::PinionInertia, |p, v| p.masses.pinion_kg_mm2 = Some(v)),
    ("rack_mass", ParameterName::RackMass, |p, v| p.masses.rack_kg = Some(v)),
    ("rack_inertia", ParameterName::RackInertia, |p, v| p.masses.rack_kg_mm2 = Some(v)),
];

const YOKE: &[Number<Yoke>] = &[
    ("preload", ParameterName::YokePreload, |y, v| y.preload_n = v),
    ("rate", ParameterName::YokeRate, |y, v| y.rate_n_per_mm = v),
    ("stop", ParameterName::YokeStop, |y, v| y.stop_n_per_mm = v),
    ("bush", ParameterName::BushStiffness, |y, v| y.bush_n_per_mm = v),
];

/// Reads `[simulation]`.
pub(super) fn read(reader: &mut SectionReader<'_>) -> SimulationSection {
    let mut section = SimulationSection::default();
    let SimulationSection { parameters, places } = &mut section;
    let before = reader.diagnostics.len();
    for (key, name, set) in LENGTHS {
        if let Some(length) = reader.length(key) {
            set(parameters, length.value.mm());
            places.push((*name, length.span));
        }
    }
    for (key, name, set) in MEASURES {
        if let Some(number) = reader.measure(key) {
            set(parameters, number.value);
            places.push((*name, number.span));
        }
    }
    parameters.contact = contact(reader, places);
    if let Some(word) = reader.word("integrator") {
        parameters.integrator = if word.value == "explicit" { Integrator::Explicit } else { Integrator::Implicit };
    }
    if let Some(steps) = reader.count("max_steps") {
        parameters.max_steps = u64::from(steps.value);
        places.push((ParameterName::MaxSteps, steps.span));
    }
    let yoke = yoke(reader, parameters.preload_n, places);
    if reader.word("support").is_some_and(|word| word.value == "yoke") {
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
        if let Some(count) = reader.count(key) {
            *value = count.value;
            places.push((name, count.span));
        }
    };
    let (mut spheres, mut strips) = (SphereGrid::default(), StripGrid::default());
    count("profile_nodes", ParameterName::ProfileNodes, &mut spheres.profile_nodes);
    count("width_nodes", ParameterName::WidthNodes, &mut spheres.width_nodes);
    count("patch_cells", ParameterName::PatchCells, &mut spheres.patch_cells);
    count("strips", ParameterName::Strips, &mut strips.strips);
    if let Some(radius) = reader.length("sphere_radius") {
        spheres.radius_mm = radius.value.mm();
        places.push((ParameterName::SphereRadius, radius.span));
    }
    match reader.word("contact") {
        Some(word) if word.value == "analytic" => ContactModel::Analytic(strips),
        _ => ContactModel::Spheres(spheres),
    }
}

fn yoke(reader: &mut SectionReader<'_>, preload_n: f64, places: &mut Vec<(ParameterName, Range<usize>)>) -> Yoke {
    let default = Yoke { preload_n, ..Yoke::default() };
    let read = reader.table("yoke", &keys::YOKE, |reader| {
        let mut yoke = default;
        for (key, name, set) in YOKE {
            if let Some(number) = reader.measure(key) {
                set(&mut yoke, number.value);
                places.push((*name, number.span));
            }
        }
        if let Some(clearance) = reader.length("clearance") {
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
                let span = self.support.roll.as_ref().map_or(0..0, |roll| roll.span.clone());
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
