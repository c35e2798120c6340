//! The keys of `[simulation]`: a part of the table in [`keys`](super).

use std::ops::Bound;

use super::kind::{Key, MeasureUnit, Section, between, count, from_zero, length, measure, section, word};
use crate::quantity::{Domain, Length};

const fn nodes(name: &'static str, symbol: &'static str) -> Domain {
    between(name, symbol, 2, 100_000)
}

const fn exponent(name: &'static str, symbol: &'static str) -> Domain {
    Domain { name, symbol, lower: Bound::Included(1), upper: Bound::Unbounded }
}

section! {
    SIMULATION = "simulation", "The multibody simulation; every key has a default." {
        SIMULATION_START: Length = "start", length(Domain::any("start of the stroke", "s_0")),
            "Stroke at which the run starts. Default 0.";
        SIMULATION_STROKE: Length = "stroke", length(Domain::positive("stroke", "s")),
            "How far the rack travels. Default 50 mm.";
        SIMULATION_DIRECTION: &'static str = "direction", word(&["rising", "both"]),
            "rising: the rack travels over the stroke; both: there and back. Default rising.";
        SIMULATION_SPEED: f64 = "speed", measure(Domain::positive("speed of the rack", "v"), MeasureUnit::SPEED),
            "Speed of the rack. Default 20 mm/s.";
        SIMULATION_RAMP: Length = "ramp", length(Domain::positive("ramp", "s_r")),
            "Travel during which the speed is reached. Default 1 mm.";
        SIMULATION_PRELOAD: f64 = "preload", measure(Domain::positive("preload", "F"), MeasureUnit::FORCE),
            "Force that presses the pinion on. Default 500 N.";
        SIMULATION_SUPPORT: &'static str = "support", word(&["slider", "yoke"]),
            "slider: the preload presses the pinion on; yoke: its axis is fixed, and a yoke presses the rack on. Default slider.";
        SIMULATION_CONTACT: &'static str = "contact", word(&["spheres", "analytic"]),
            "spheres: spheres on the pinion against triangles on the rack; analytic: exact surfaces. Default spheres.";
        SIMULATION_STIFFNESS: f64 = "stiffness", measure(Domain::positive("contact stiffness", "k"), MeasureUnit::NONE),
            "Contact stiffness k, N/mm^a; of one sphere, or of 1 mm of contact line.";
        SIMULATION_STIFFNESS_EXPONENT: f64 = "stiffness_exponent",
            measure(exponent("stiffness exponent", "a"), MeasureUnit::NONE),
            "Exponent of the penetration, 1 to 2.5.";
        SIMULATION_DAMPING: f64 = "damping", measure(from_zero("contact damping", "c"), MeasureUnit::NONE),
            "Contact damping c.";
        SIMULATION_DAMPING_EXPONENT: f64 = "damping_exponent",
            measure(exponent("damping exponent", "b"), MeasureUnit::NONE),
            "Exponent of the penetration's rate, 1 to 2.5.";
        SIMULATION_INDENTATION_EXPONENT: f64 = "indentation_exponent",
            measure(exponent("indentation exponent", "e"), MeasureUnit::NONE),
            "Exponent of the penetration in the damping term, 1 to 2.5.";
        SIMULATION_FRICTION: f64 = "friction", measure(from_zero("friction coefficient", "μ"), MeasureUnit::NONE),
            "Friction coefficient μ. Default 0; with a yoke, yoke.friction.teeth.";
        SIMULATION_FRICTION_SPEED: f64 = "friction_speed",
            measure(Domain::positive("friction regularisation speed", "v_f"), MeasureUnit::SPEED),
            "Sliding speed below which friction fades.";
        SIMULATION_PROFILE_NODES: u32 = "profile_nodes", count(nodes("number of spheres over the profile", "n_p")),
            "Spheres over the profile of a flank.";
        SIMULATION_WIDTH_NODES: u32 = "width_nodes", count(nodes("number of spheres over the width", "n_w")),
            "Spheres over the width of a flank.";
        SIMULATION_SPHERE_RADIUS: Length = "sphere_radius", length(from_zero("sphere radius", "R")),
            "Largest radius of a sphere.";
        SIMULATION_PATCH_CELLS: u32 = "patch_cells", count(between("number of cells of a rack flank", "n_c", 1, 1000)),
            "Cells of two triangles of a rack flank along each direction where it is not plane.";
        SIMULATION_STRIPS: u32 = "strips", count(nodes("number of strips over the width", "n_s")),
            "Strips over the width, with contact = \"analytic\".";
        SIMULATION_PINION_MASS: f64 = "pinion_mass", measure(from_zero("mass of the pinion", "m_p"), MeasureUnit::MASS),
            "Mass of the pinion. Default that of its cylinder in steel.";
        SIMULATION_PINION_INERTIA: f64 = "pinion_inertia",
            measure(from_zero("inertia of the pinion", "J_p"), MeasureUnit::INERTIA),
            "Moment of inertia of the pinion about its axis. Default that of its cylinder in steel.";
        SIMULATION_RACK_MASS: f64 = "rack_mass", measure(from_zero("mass of the rack", "m_r"), MeasureUnit::MASS),
            "Mass of the rack. Default that of a round bar in steel.";
        SIMULATION_RACK_INERTIA: f64 = "rack_inertia",
            measure(from_zero("inertia of the rack", "J_r"), MeasureUnit::INERTIA),
            "Moment of inertia of the rack about its roll axis. Default that of a round bar in steel.";
        SIMULATION_TOLERANCE: Length = "tolerance", length(Domain::positive("tolerance of a step", "ε")),
            "Largest error of a step in time.";
        SIMULATION_SPACING: Length = "spacing", length(Domain::positive("spacing of the samples", "Δs")),
            "Travel from one printed position to the next. Default 0.1 mm.";
        SIMULATION_MAX_STEPS: u32 = "max_steps", count(between("step limit", "n", 1, 1_000_000_000)),
            "Most steps in time before a run gives up. Default 1 000 000.";
    }
}
