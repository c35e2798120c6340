//! The keys of `[scatter]`: a part of the table in [`keys`](super).

use super::kind::{Key, Kind, Section, of, section};
use crate::deviation::DeviationKind;

/// Spreads of lengths, with this class if any.
const fn lengths(class: Option<DeviationKind>) -> Key<()> {
    of(Kind::Spread { is_angle: false, class })
}

section! {
    SCATTER = "scatter",
    "How the teeth deviate at random: standard deviations, half-widths with their distribution, or classes." {
        "rack_pitch", lengths(Some(DeviationKind::RackPitch)), "Single pitch deviation of the rack, along its axis.";
        "rack_thickness", lengths(None), "Normal tooth thickness of the rack.";
        "rack_lead", of(Kind::Spread { is_angle: true, class: Some(DeviationKind::RackLead) }),
            "Lead deviation of each rack tooth.";
        "rack_over_roller", lengths(None), "Pitch-line shift of each rack tooth.";
        "pinion_pitch", lengths(Some(DeviationKind::PinionPitch)), "Single pitch deviation of the pinion, an arc.";
        "pinion_thickness", lengths(None), "Transverse tooth thickness of the pinion, an arc.";
        "pinion_lead", lengths(Some(DeviationKind::PinionLead)),
            "Helix slope deviation f_Hβ of each pinion tooth over its face width, along the transverse base tangent.";
        "pinion_runout", lengths(Some(DeviationKind::PinionRadial)),
            "Runout of the pinion, twice its eccentricity, in a random direction. A standard deviation is that of each of two directions at \
             right angles: the mean runout is 1.25 times as much.";
    }
}
