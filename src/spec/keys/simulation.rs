//! The keys of `[simulation]`: a part of the table in [`keys`](super).

use super::{Kind, Section, Unit, key};
use crate::quantity::{Bound, Domain};

const fn positive(name: &'static str, symbol: &'static str) -> Domain {
    Domain::positive(name, symbol)
}

const fn from_zero(name: &'static str, symbol: &'static str) -> Domain {
    Domain { name, symbol, lower: Bound::Inclusive(0), upper: Bound::None }
}

const fn nodes(name: &'static str, symbol: &'static str) -> Domain {
    Domain { name, symbol, lower: Bound::Inclusive(2), upper: Bound::Inclusive(100_000) }
}

const fn exponent(name: &'static str, symbol: &'static str) -> Domain {
    Domain { name, symbol, lower: Bound::Inclusive(1), upper: Bound::None }
}

pub(crate) const YOKE: Section = Section {
    name: "simulation.yoke",
    doc: "The sprung yoke behind the mesh and the bush at the rack's other end.",
    keys: &[
        key(
            "preload",
            Kind::Measure(positive("preload of the yoke's spring", "F_y"), Unit::FORCE),
            "Force of the yoke's spring with the rack in its nominal place. Default simulation.preload.",
        ),
        key(
            "rate",
            Kind::Measure(from_zero("rate of the yoke's spring", "c_y"), Unit::RATE),
            "Rate of the spring. Default 100 N/mm.",
        ),
        key(
            "clearance",
            Kind::Length(from_zero("clearance of the yoke", "s_y")),
            "Travel until the yoke meets its stop. Default 0.15 mm.",
        ),
        key(
            "stop",
            Kind::Measure(from_zero("stiffness of the yoke's stop", "c_s"), Unit::RATE),
            "Stiffness of the stop. Default 1e5 N/mm.",
        ),
        key(
            "bush",
            Kind::Measure(from_zero("stiffness of the bush", "c_b"), Unit::RATE),
            "Stiffness of the flexible bush as it is felt at the mesh. Default 20 N/mm.",
        ),
    ],
};

pub(crate) const SIMULATION: Section = Section {
    name: "simulation",
    doc: "The multibody simulation; every key has a default.",
    keys: &[
        key(
            "start",
            Kind::Length(Domain::any("start of the stroke", "s_0")),
            "Stroke at which the run starts. Default 0.",
        ),
        key("stroke", Kind::Length(positive("stroke", "s")), "How far the rack travels. Default 50 mm."),
        key(
            "speed",
            Kind::Measure(positive("speed of the rack", "v"), Unit::SPEED),
            "Speed of the rack. Default 20 mm/s.",
        ),
        key("ramp", Kind::Length(positive("ramp", "s_r")), "Travel during which the speed is reached. Default 1 mm."),
        key(
            "preload",
            Kind::Measure(positive("preload", "F"), Unit::FORCE),
            "Force that presses the pinion on. Default 500 N.",
        ),
        key(
            "support",
            Kind::Word(&["slider", "yoke"]),
            "slider: the pinion on a slider that the preload presses on, as in the paper; yoke: the pinion's axis fixed, \
             the rack pressed on by a sprung yoke. Default slider.",
        ),
        key("yoke", Kind::Table(&YOKE), "The yoke, with support = \"yoke\"."),
        key(
            "contact",
            Kind::Word(&["spheres", "analytic"]),
            "spheres: spheres on the pinion's flanks against triangles of the rack's; analytic: exact surfaces, the load \
             spread over the contact line. Default spheres.",
        ),
        key(
            "stiffness",
            Kind::Measure(positive("contact stiffness", "k"), Unit::NONE),
            "Contact stiffness k, N/mm^a; of one sphere, or of 1 mm of contact line.",
        ),
        key(
            "stiffness_exponent",
            Kind::Measure(exponent("stiffness exponent", "a"), Unit::NONE),
            "Exponent of the penetration, 1 to 2.5.",
        ),
        key("damping", Kind::Measure(from_zero("contact damping", "c"), Unit::NONE), "Contact damping c."),
        key(
            "damping_exponent",
            Kind::Measure(exponent("damping exponent", "b"), Unit::NONE),
            "Exponent of the penetration's rate, 1 to 2.5.",
        ),
        key(
            "indentation_exponent",
            Kind::Measure(exponent("indentation exponent", "e"), Unit::NONE),
            "Exponent of the penetration in the damping term, 1 to 2.5.",
        ),
        key(
            "friction",
            Kind::Measure(from_zero("friction coefficient", "μ"), Unit::NONE),
            "Friction coefficient μ. Default 0.",
        ),
        key(
            "friction_speed",
            Kind::Measure(positive("friction regularisation speed", "v_f"), Unit::SPEED),
            "Sliding speed below which friction fades.",
        ),
        key(
            "profile_nodes",
            Kind::Count(nodes("number of spheres over the profile", "n_p")),
            "Spheres over the profile of a flank.",
        ),
        key(
            "width_nodes",
            Kind::Count(nodes("number of spheres over the width", "n_w")),
            "Spheres over the width of a flank.",
        ),
        key("sphere_radius", Kind::Length(from_zero("sphere radius", "R")), "Largest radius of a sphere."),
        key(
            "patch_cells",
            Kind::Count(Domain {
                name: "number of cells of a rack flank",
                symbol: "n_c",
                lower: Bound::Inclusive(1),
                upper: Bound::Inclusive(1000),
            }),
            "Cells of two triangles of a rack flank along each direction where it is not plane.",
        ),
        key(
            "strips",
            Kind::Count(nodes("number of strips over the width", "n_s")),
            "Strips over the width, with contact = \"analytic\".",
        ),
        key(
            "pinion_mass",
            Kind::Measure(from_zero("mass of the pinion", "m_p"), Unit::MASS),
            "Mass of the pinion. Default that of its cylinder in steel.",
        ),
        key(
            "pinion_inertia",
            Kind::Measure(from_zero("inertia of the pinion", "J_p"), Unit::INERTIA),
            "Moment of inertia of the pinion about its axis. Default that of its cylinder in steel.",
        ),
        key(
            "rack_mass",
            Kind::Measure(from_zero("mass of the rack", "m_r"), Unit::MASS),
            "Mass of the rack. Default that of a round bar in steel.",
        ),
        key(
            "rack_inertia",
            Kind::Measure(from_zero("inertia of the rack", "J_r"), Unit::INERTIA),
            "Moment of inertia of the rack about its roll axis. Default that of a round bar in steel.",
        ),
        key("integrator", Kind::Word(&["implicit", "explicit"]), "How time is stepped through. Default implicit."),
        key("tolerance", Kind::Length(positive("tolerance of a step", "ε")), "Largest error of a step in time."),
        key(
            "spacing",
            Kind::Length(positive("spacing of the samples", "Δs")),
            "Travel from one printed position to the next. Default 0.1 mm.",
        ),
        key(
            "max_steps",
            Kind::Count(Domain {
                name: "step limit",
                symbol: "n",
                lower: Bound::Inclusive(1),
                upper: Bound::Inclusive(1_000_000_000),
            }),
            "Most steps in time before a run gives up. Default 1 000 000.",
        ),
    ],
};
