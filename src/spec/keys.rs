//! Every key of the spec, declared once: the reader, the JSON Schema and the suggestions for misspelt
//! keys all follow this table. It holds names, kinds of values and their domains, and reads nothing.

use std::ops::Bound;

use crate::deviation::{DeviationKind, ToothRange};
use crate::formula::domain;
use crate::gear::MOST_TEETH;
use crate::judge::Rule;
use crate::judge::class::RackDiameter;
use crate::quantity::{Angle, Domain, Length};
use crate::standard::Standard;

mod entry;
#[macro_use]
mod kind;
mod scatter;
mod simulation;
mod table;
mod yoke;

pub(crate) use entry::{
    ANGLE_NOMINAL, COLUMN_KIND, COLUMN_MEASURED_AT, COLUMN_NAME, EVALUATION_LENGTH, EVERY_PART, EXTENT, LENGTH_NOMINAL,
    MEASURED_AT, READINGS, UNCERTAINTY_KEYS,
};
pub use kind::{AnyKey, Key};
pub(crate) use kind::{Kind, MeasureUnit, Section};
use kind::{angle, between, count, file, flag, from_zero, key, label, length, number, of, section, teeth, text, word};
pub(crate) use scatter::SCATTER;
pub use simulation::*;
pub use table::*;
pub use yoke::*;

/// The coarsest grade of any standard.
pub(super) const LARGEST_CLASS: u8 = 12;

/// Printed above the results.
pub const TITLE: Key<String> = text().with("title", "Printed above the results.");

pub(crate) const TOP: Section = section(
    "",
    "What may be wrong with a rack and pinion, and how much of it is permitted.",
    &[
        TITLE.any,
        key(
            "correlation",
            Kind::Tables(&CORRELATION),
            "Which uncertainties belong together; any number, each between two values.",
        ),
    ],
);

section! {
    CORRELATION = "correlation", "The correlation of two uncertain values." {
        "between", of(Kind::Pair), "The two values: their keys, such as \"rack_pitch\" or \"rack.face_width\".";
        "coefficient", number(between("correlation coefficient", "r", -1, 1)), "Correlation coefficient r, -1 to 1.";
    }
}

section! {
    DECISION = "decision", "How a verdict is reached." {
        DECISION_RULE: Rule = "rule", Key::<Rule>::new(Kind::Rule),
            "simple: the measured value decides. iso14253: with a guard band of 1.65 standard uncertainties. \
             guard=VALUE: with that guard band. Default simple.";
    }
}

section! {
    PAIR = "pair", "What rack and pinion have in common." {
        PAIR_NORMAL_MODULE: Length = "normal_module", length(domain::NORMAL_MODULE), "Normal module m_n.";
        PAIR_TRANSVERSE_MODULE: Length = "transverse_module", length(domain::TRANSVERSE_MODULE),
            "Transverse module of the pinion m_t, instead of the normal one: m_n = m_t cos β_p.";
        PAIR_NORMAL_PRESSURE_ANGLE: Angle = "normal_pressure_angle", angle(domain::NORMAL_PRESSURE_ANGLE),
            "Normal pressure angle α_n, above 0° and at most 45°.";
        PAIR_SHAFT_ANGLE: Angle = "shaft_angle", angle(domain::SHAFT_ANGLE),
            "Magnitude of the shaft angle Σ = β_r + β_p, against which the helix angles are checked.";
        PAIR_CONTACT: &'static str = "contact", word(&[BOTH_FLANKS]),
            "\"both flanks\": where the geometry is not given, a tooth of either part always carries with both flanks.";
    }
}

/// What `[pair] contact` may state.
pub(crate) const BOTH_FLANKS: &str = "both flanks";

section! {
    RACK = "rack", "Nominal geometry of the rack." {
        RACK_HELIX_ANGLE: Angle = "helix_angle", angle(domain::RACK_HELIX_ANGLE),
            "Helix angle of the teeth β_r, right hand positive. Default 0.";
        RACK_FACE_WIDTH: Length = "face_width", length(domain::FACE_WIDTH), "Face width k.";
        RACK_ADDENDUM: Length = "addendum", length(Domain::positive("addendum of the rack", "h_a")),
            "Height of the tooth tips above the reference plane.";
        RACK_TOOTH_THICKNESS: Length = "tooth_thickness", length(domain::TOOTH_THICKNESS),
            "Normal tooth thickness s_n at the reference plane. Default π m_n / 2.";
        RACK_DATUM: Length = "datum", length(domain::DATUM),
            "Distance K from the measuring datum (the bar's axis or back) to the reference plane.";
        RACK_TOOTHED_LENGTH: Length = "toothed_length", length(Domain::positive("toothed length", "L")),
            "Length L of the toothed part; its developed diameter is L/π.";
        "travel", of(Kind::Whole(&TRAVEL)), "Strokes of the rack on its gear.";
        RACK_PIN: Length = "pin", length(domain::PIN_DIAMETER), "Diameter of the pin behind measured over-pin values.";
        RACK_MEASURED: String = "measured", file(), "Table of measured spaces: over-pin, position, lead.";
        "deviation", of(Kind::Tables(&RACK_DEVIATION)), "Deviations of some teeth; any number, they add up.";
        RACK_CROWNING: Length = "crowning", length(FORM),
            "Lead crowning: removed at the ends of the face width, falling off as the square towards its middle.";
        RACK_TIP_RELIEF: () = "tip_relief", of(Kind::Whole(&TIP_RELIEF)), "Relief of the flanks towards their tips.";
    }
}

section! {
    PINION = "pinion", "Nominal geometry of the pinion." {
        PINION_TEETH: u32 = "teeth", count(between("number of teeth", "z", 1, MOST_TEETH as i64)), "Number of teeth z.";
        PINION_HELIX_ANGLE: Angle = "helix_angle", angle(domain::PINION_HELIX_ANGLE),
            "Helix angle at the reference cylinder β_p, right hand positive. Default 0.";
        PINION_PROFILE_SHIFT: f64 = "profile_shift", number(Domain::any("profile shift coefficient", "x")),
            "Profile shift coefficient x, in units of m_n. Default 0.";
        PINION_FACE_WIDTH: Length = "face_width", length(Domain::positive("face width of the pinion", "b")),
            "Face width b.";
        PINION_TIP_DIAMETER: Length = "tip_diameter", length(Domain::positive("tip diameter", "d_a")),
            "Tip diameter d_a.";
        PINION_ROOT_FORM_DIAMETER: Length = "root_form_diameter", length(Domain::positive("root form diameter", "d_Ff")),
            "Root form diameter d_Ff, where the involute starts.";
        PINION_TOOTH_THICKNESS_DEVIATION: Length = "tooth_thickness_deviation",
            length(Domain::any("tooth thickness deviation of the pinion", "E_s")),
            "Deviation of the transverse tooth thickness at the reference circle from nominal. Default 0.";
        PINION_MASTER: bool = "master", flag(),
            "The pinion is a master: what a measured curve shows is the rack's. Default false.";
        PINION_MEASURED: String = "measured", file(), "Table of measured teeth: radial, left and right pitch, lead.";
        PINION_MEASURED_AT: Length = "measured_at", length(domain::MEASUREMENT_CIRCLE),
            "Diameter of the circle on which the arcs of `measured` and of [[pinion.deviation]] are. Default: the reference circle.";
        "deviation", of(Kind::Tables(&PINION_DEVIATION)), "Deviations of some teeth; any number, they add up.";
        PINION_CROWNING: Length = "crowning", length(FORM),
            "Lead crowning: removed at the ends of the face width, falling off as the square towards its middle.";
        PINION_PROFILE_SLOPE: Length = "profile_slope", length(Domain::any("profile slope", "f_Hα")),
            "Removed at the tip, in proportion to the roll angle from the start of the involute.";
    }
}

section! {
    ERRORS = "errors",
    "The measured errors, each a deviation or the values from which it follows, with its extent and uncertainty." {
        "rack_over_roller", of(Kind::Error(DeviationKind::RackOverRoller)),
            "Over-roller error of the rack, M - M_nom; with { measured, roller } the nominal is computed.";
        "rack_pitch", of(Kind::Error(DeviationKind::RackPitch)), "Pitch error of the rack, along its axis.";
        "rack_lead", of(Kind::Error(DeviationKind::RackLead)),
            "Lead angle error of the rack; or { f_h_beta, length }, a helix slope deviation over its length.";
        "pinion_radial", of(Kind::Error(DeviationKind::PinionRadial)), "Radial measurement error of the pinion.";
        "pinion_pitch", of(Kind::Error(DeviationKind::PinionPitch)),
            "Single pitch deviation f_p of the pinion, transverse, at the reference circle.";
        "pinion_lead", of(Kind::Error(DeviationKind::PinionLead)),
            "Helix slope deviation f_Hβ of the pinion over its face width, along the transverse base tangent.";
    }
}

section! {
    LIMITS = "limits", "Permitted ΔCD: of the combination, and of single errors." {
        "center_distance", of(Kind::Limit), "Limits of the combined ΔCD.";
        "rack_over_roller", of(Kind::Limit), "Limits of ΔCD from the rack's over-roller error.";
        "rack_pitch", of(Kind::Limit), "Limits of ΔCD from the rack's pitch error.";
        "rack_lead", of(Kind::Limit), "Limits of ΔCD from the rack's lead angle error.";
        "pinion_radial", of(Kind::Limit), "Limits of ΔCD from the pinion's radial error.";
        "pinion_pitch", of(Kind::Limit), "Limits of ΔCD from the pinion's pitch error.";
        "pinion_lead", of(Kind::Limit), "Limits of ΔCD from the pinion's helix slope deviation.";
        "yoke_play", of(Kind::Limit), "Limits of the yoke's play.";
        "pinion_torque", of(Kind::MeasureLimit(MeasureUnit::TORQUE)), "Limits of the pinion's free torque.";
        "torque_fluctuation", of(Kind::MeasureLimit(MeasureUnit::TORQUE)), "Limits of its fluctuation.";
        "lift_off_force", of(Kind::MeasureLimit(MeasureUnit::FORCE)), "Limits of the lift-off force.";
    }
}

/// An amount removed from a flank, normal to it.
const FORM: Domain = from_zero("amount removed from the flank", "c");

const DISPLACEMENT: Domain = Domain::any("displacement", "e");

section! {
    TIP_RELIEF = "rack.tip_relief", "Tip relief of the rack, growing linearly from its start to the tip." {
        RACK_TIP_RELIEF_AMOUNT: Length = "amount", length(FORM), "Removed at the tip, normal to the flank.";
        RACK_TIP_RELIEF_START: Length = "start", length(Domain::any("start of the tip relief", "h_0")),
            "Height above the reference plane at which it starts.";
    }
}

section! {
    RACK_DEVIATION = "rack.deviation", "What is wrong with some teeth of the rack." {
        RACK_DEVIATION_TEETH: ToothRange = "teeth", teeth(), "The teeth concerned. Default \"all\".";
        RACK_DEVIATION_OVER_ROLLER: Length = "over_roller", length(DISPLACEMENT),
            "Pitch-line shift of both flanks, along Z; the tip stays.";
        RACK_DEVIATION_PITCH: Length = "pitch", length(DISPLACEMENT),
            "The pitch before each of these teeth is longer by this; later teeth keep the sum.";
        RACK_DEVIATION_SHIFT: Length = "shift", length(DISPLACEMENT), "The teeth shifted along X.";
        RACK_DEVIATION_THICKNESS: Length = "thickness", length(DISPLACEMENT),
            "Change of the normal tooth thickness at the reference plane.";
        RACK_DEVIATION_LEAD: Angle = "lead", angle(Domain::any("lead deviation", "Δβ")),
            "Helix angle deviation: each flank turned about the vertical through its own mid-width point.";
        RACK_DEVIATION_LEFT: Length = "left", length(DISPLACEMENT), "Left flank alone, along X, outward positive.";
        RACK_DEVIATION_RIGHT: Length = "right", length(DISPLACEMENT),
            "Right flank (facing +X) alone, along X, outward positive.";
    }
}

section! {
    ECCENTRICITY = "pinion.deviation.eccentricity",
    "The tooth system sits off the axis of rotation, towards a tooth." {
        PINION_DEVIATION_ECCENTRICITY_AMOUNT: Length = "amount", length(Domain::any("eccentricity", "f_e")), "How far.";
        PINION_DEVIATION_ECCENTRICITY_TOOTH: u32 = "tooth", count(between("tooth number", "j", 0, MOST_TEETH as i64 - 1)),
            "Towards which tooth, 0 to z - 1.";
    }
}

section! {
    PINION_DEVIATION = "pinion.deviation",
    "What is wrong with some teeth of the pinion; lengths are arcs at the reference circle, or at pinion.measured_at." {
        PINION_DEVIATION_TEETH: ToothRange = "teeth", teeth(), "The teeth concerned, 0 to z - 1. Default \"all\".";
        PINION_DEVIATION_SHIFT: Length = "shift", length(DISPLACEMENT), "The teeth shifted towards higher index.";
        PINION_DEVIATION_THICKNESS: Length = "thickness", length(DISPLACEMENT),
            "Change of the transverse tooth thickness.";
        PINION_DEVIATION_LEAD: Angle = "lead", angle(Domain::any("lead deviation", "Δβ")),
            "Helix angle deviation; the section at mid-width stays.";
        PINION_DEVIATION_LEFT: Length = "left", length(DISPLACEMENT),
            "Left flank (facing lower index) alone, outward positive.";
        PINION_DEVIATION_RIGHT: Length = "right", length(DISPLACEMENT),
            "Right flank (facing higher index) alone, outward positive.";
        PINION_DEVIATION_RADIAL: Length = "radial", length(DISPLACEMENT),
            "The space after each of these teeth sits higher by this.";
        "eccentricity", of(Kind::Whole(&ECCENTRICITY)), "The whole part off its axis.";
    }
}

section! {
    SUPPORT = "support", "How the rack is held." {
        SUPPORT_ROLL: &'static str = "roll", word(&["fixed", "free"]),
            "Whether the rack may roll about its own axis. Default fixed.";
        SUPPORT_ROLL_AXIS_DEPTH: Length = "roll_axis_depth", length(Domain::any("depth of the roll axis", "h_roll")),
            "How far the roll axis lies below the reference plane.";
    }
}

section! {
    TOLERANCE = "tolerance", "What an error given as { class = … } refers to." {
        TOLERANCE_STANDARD: Standard = "standard", Key::<Standard>::new(Kind::Standard),
            "The accuracy standard and its edition, such as iso1328-1:1995.";
        TOLERANCE_DIAMETER: RackDiameter = "diameter", Key::<RackDiameter>::new(Kind::RackDiameter),
            "Which reference diameter stands for the rack: \"pinion\", \"developed\" (L/π), or a length. No default.";
    }
}

const FRACTION: Domain = Domain {
    name: "fraction of conforming assemblies",
    symbol: "P",
    lower: Bound::Excluded(0),
    upper: Bound::Included(1),
};

section! {
    BUDGET = "budget",
    "Which tolerances are fixed, which are sought, and how they add up. An extent beside one is by default each." {
        BUDGET_STACK: &'static str = "stack", word(&["worst", "rss", "simulation"]),
            "How tolerances add up. Default worst.";
        BUDGET_CONFORMING: f64 = "conforming", number(FRACTION),
            "Fraction of random assemblies that must conform. Default 0.9973.";
        BUDGET_DISTRIBUTION: &'static str = "distribution", word(&["uniform", "normal", "triangular"]),
            "How errors spread within their tolerances. Default uniform.";
        "rack_over_roller", of(Kind::Tolerance(DeviationKind::RackOverRoller)), "Tolerance of the over-roller error.";
        "rack_pitch", of(Kind::Tolerance(DeviationKind::RackPitch)), "Tolerance of the rack's pitch error.";
        "rack_lead", of(Kind::Tolerance(DeviationKind::RackLead)), "Tolerance of the rack's lead angle error.";
        "pinion_radial", of(Kind::Tolerance(DeviationKind::PinionRadial)), "Tolerance of the pinion's radial error.";
        "pinion_pitch", of(Kind::Tolerance(DeviationKind::PinionPitch)), "Tolerance of the pinion's pitch error.";
        "pinion_lead", of(Kind::Tolerance(DeviationKind::PinionLead)),
            "Tolerance of the pinion's helix slope deviation; not among those sought where none is named.";
    }
}

section! {
    REPORT = "report", "What a page says of the parts." {
        REPORT_PART: String = "part", label(), "Part number.";
        REPORT_DATE: String = "date", label(), "Date.";
        REPORT_INSPECTOR: String = "inspector", label(), "Who measured.";
        REPORT_ORDER: String = "order", label(), "Order.";
        REPORT_DRAWING: String = "drawing", label(), "Drawing.";
    }
}

/// The keys that a page shows of the parts, in its order.
pub const REPORT_KEYS: [Key<String>; 5] = [REPORT_PART, REPORT_DATE, REPORT_INSPECTOR, REPORT_ORDER, REPORT_DRAWING];

/// The sections in the order in which they are documented.
pub(crate) const SECTIONS: &[Section] = &[
    PAIR, RACK, PINION, SUPPORT, TOLERANCE, BUDGET, ERRORS, LIMITS, DECISION, TABLE, YOKE, SIMULATION, SCATTER, REPORT,
];
