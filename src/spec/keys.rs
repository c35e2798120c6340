//! Every key of the spec, declared once: the reader, the JSON Schema and the suggestions for misspelt
//! keys all follow this table.

use crate::deviation::ErrorKind;
use crate::formula::domain;
use crate::quantity::{Bound, Domain};

/// What a key holds.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Kind {
    /// Any text.
    Text,
    /// A length, mm.
    Length(Domain),
    /// An angle, degrees.
    Angle(Domain),
    /// A number without a unit.
    Number(Domain),
    /// A whole number.
    Count(Domain),
    /// A deviation, or a table from which one follows.
    Error(ErrorKind),
    /// Limits of ΔCD.
    Limit,
}

/// One key.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    pub(crate) doc: &'static str,
}

/// One section; the one without a name holds the keys at the top.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Section {
    pub(crate) name: &'static str,
    pub(crate) doc: &'static str,
    pub(crate) keys: &'static [Key],
}

const fn key(name: &'static str, kind: Kind, doc: &'static str) -> Key {
    Key { name, kind, doc }
}

pub(crate) const TOP: Section = Section {
    name: "",
    doc: "What may be wrong with a rack and pinion, and how much of it is permitted.",
    keys: &[key("title", Kind::Text, "Printed above the results.")],
};

pub(crate) const PAIR: Section = Section {
    name: "pair",
    doc: "What rack and pinion have in common.",
    keys: &[
        key("normal_module", Kind::Length(domain::NORMAL_MODULE), "Normal module m_n."),
        key(
            "normal_pressure_angle",
            Kind::Angle(domain::NORMAL_PRESSURE_ANGLE),
            "Normal pressure angle α_n, above 0° and at most 45°.",
        ),
    ],
};

pub(crate) const RACK: Section = Section {
    name: "rack",
    doc: "Nominal geometry of the rack.",
    keys: &[
        key(
            "helix_angle",
            Kind::Angle(domain::RACK_HELIX_ANGLE),
            "Helix angle of the teeth β_r, right hand positive. Default 0.",
        ),
        key("face_width", Kind::Length(domain::FACE_WIDTH), "Face width k."),
        key(
            "addendum",
            Kind::Length(Domain::positive("addendum of the rack", "h_a")),
            "Height of the tooth tips above the reference plane.",
        ),
        key(
            "tooth_thickness",
            Kind::Length(domain::TOOTH_THICKNESS),
            "Normal tooth thickness s_n at the reference plane. Default π m_n / 2.",
        ),
        key(
            "datum",
            Kind::Length(domain::DATUM),
            "Distance K from the measuring datum (the bar's axis or back) to the reference plane.",
        ),
    ],
};

pub(crate) const PINION: Section = Section {
    name: "pinion",
    doc: "Nominal geometry of the pinion.",
    keys: &[
        key(
            "teeth",
            Kind::Count(Domain {
                name: "number of teeth",
                symbol: "z",
                lower: Bound::Inclusive(1),
                upper: Bound::Inclusive(100_000),
            }),
            "Number of teeth z.",
        ),
        key(
            "helix_angle",
            Kind::Angle(domain::PINION_HELIX_ANGLE),
            "Helix angle at the reference cylinder β_p, right hand positive. Default 0.",
        ),
        key(
            "profile_shift",
            Kind::Number(Domain::any("profile shift coefficient", "x")),
            "Profile shift coefficient x, in units of m_n. Default 0.",
        ),
        key("face_width", Kind::Length(Domain::positive("face width of the pinion", "b")), "Face width b."),
        key("tip_diameter", Kind::Length(Domain::positive("tip diameter", "d_a")), "Tip diameter d_a."),
        key(
            "root_form_diameter",
            Kind::Length(Domain::positive("root form diameter", "d_Ff")),
            "Root form diameter d_Ff, where the involute starts.",
        ),
        key(
            "tooth_thickness_deviation",
            Kind::Length(Domain::any("tooth thickness deviation of the pinion", "E_s")),
            "Deviation of the transverse tooth thickness at the reference circle from nominal. Default 0.",
        ),
    ],
};

pub(crate) const ERRORS: Section = Section {
    name: "errors",
    doc: "The measured errors: a deviation, or the values from which it follows.",
    keys: &[
        key(
            "rack_over_roller",
            Kind::Error(ErrorKind::RackOverRoller),
            "Over-roller error of the rack, M - M_nom; with { measured, roller } the nominal is computed.",
        ),
        key("rack_pitch", Kind::Error(ErrorKind::RackPitch), "Pitch error of the rack, along its axis."),
        key(
            "rack_lead",
            Kind::Error(ErrorKind::RackLead),
            "Lead angle error of the rack; or { f_h_beta, length }, a helix slope deviation over its length.",
        ),
        key("pinion_radial", Kind::Error(ErrorKind::PinionRadial), "Radial measurement error of the pinion."),
        key(
            "pinion_pitch",
            Kind::Error(ErrorKind::PinionPitch),
            "Single pitch deviation f_p of the pinion, transverse, at the reference circle.",
        ),
    ],
};

pub(crate) const LIMITS: Section = Section {
    name: "limits",
    doc: "Permitted ΔCD: of the combination, and of single errors.",
    keys: &[
        key("center_distance", Kind::Limit, "Limits of the combined ΔCD."),
        key("rack_over_roller", Kind::Limit, "Limits of ΔCD from the rack's over-roller error."),
        key("rack_pitch", Kind::Limit, "Limits of ΔCD from the rack's pitch error."),
        key("rack_lead", Kind::Limit, "Limits of ΔCD from the rack's lead angle error."),
        key("pinion_radial", Kind::Limit, "Limits of ΔCD from the pinion's radial error."),
        key("pinion_pitch", Kind::Limit, "Limits of ΔCD from the pinion's pitch error."),
    ],
};

/// The sections in the order in which they are documented.
pub(crate) const SECTIONS: &[Section] = &[PAIR, RACK, PINION, ERRORS, LIMITS];
