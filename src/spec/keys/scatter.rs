//! The keys of `[scatter]`: a part of the table in [`keys`](super).

use super::{AnyKey, Kind, Section, key, section};
use crate::deviation::DeviationKind;

const fn length(name: &'static str, class: Option<DeviationKind>, doc: &'static str) -> AnyKey {
    key(name, Kind::Spread { is_angle: false, class }, doc)
}

pub(crate) const SCATTER: Section = section(
    "scatter",
    "How the teeth deviate at random: standard deviations, half-widths with their distribution, or classes.",
    &[
        length("rack_pitch", Some(DeviationKind::RackPitch), "Single pitch deviation of the rack, along its axis."),
        length("rack_thickness", None, "Normal tooth thickness of the rack."),
        key(
            "rack_lead",
            Kind::Spread { is_angle: true, class: Some(DeviationKind::RackLead) },
            "Lead deviation of each rack tooth.",
        ),
        length("rack_over_roller", None, "Pitch-line shift of each rack tooth."),
        length("pinion_pitch", Some(DeviationKind::PinionPitch), "Single pitch deviation of the pinion, an arc."),
        length("pinion_thickness", None, "Transverse tooth thickness of the pinion, an arc."),
        length(
            "pinion_lead",
            Some(DeviationKind::PinionLead),
            "Helix slope deviation f_Hβ of each pinion tooth over its face width, along the transverse base tangent.",
        ),
        length(
            "pinion_runout",
            Some(DeviationKind::PinionRadial),
            "Runout of the pinion, twice its eccentricity, in a random direction.",
        ),
    ],
);
