//! Every key of the spec, declared once: the reader, the JSON Schema and the suggestions for misspelt
//! keys all follow this table. It holds names, kinds of values and their domains, and reads nothing.

mod scatter;
mod simulation;

pub(crate) use scatter::SCATTER;
pub(crate) use simulation::{SIMULATION, YOKE};

use crate::deviation::{self, DeviationKind};
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
    /// A number in a unit, or text that names one of its other units.
    Measure(Domain, Unit),
    /// A deviation, or a table from which one follows.
    Error(DeviationKind),
    /// Limits of ΔCD.
    Limit,
    /// The name of a file, relative to the spec.
    File,
    /// A list of texts.
    Texts,
    /// The unit of a column of lengths; of a column of lead errors, a unit of angle or, of f_Hβ, of length.
    ColumnUnit {
        /// Whether the column holds lead errors.
        of_lead: bool,
    },
    /// On which teeth an error is that counts these.
    Extent(deviation::Unit),
    /// One of these words.
    Word(&'static [&'static str]),
    /// The name of an accuracy standard and its edition.
    Standard,
    /// Which diameter stands for a rack: `"pinion"`, `"developed"`, or a length.
    RackDiameter,
    /// A decision rule.
    Rule,
    /// The names of two values.
    Pair,
    /// A tolerance of a budget: fixed, or free with a weight or cost.
    Tolerance(DeviationKind),
    /// How a deviation scatters: a standard deviation, a half-width with its distribution, or a class where a
    /// standard limits it as that kind of error.
    Spread {
        /// Whether it is an angle.
        is_angle: bool,
        /// The kind of error whose class it may be.
        class: Option<DeviationKind>,
    },
    /// Which teeth: `"all"`, `5`, `"5"`, `"8.."`, `"8..=12"`.
    Teeth,
    /// A table with these keys.
    Table(&'static Section),
    /// Any number of such tables: `[[section.key]]`.
    Tables(&'static Section),
}

/// A unit that is neither a length nor an angle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unit {
    /// What bare numbers are in; empty for numbers without a unit.
    pub(crate) symbol: &'static str,
    /// The same after a number, with the space that goes between.
    pub(crate) after: &'static str,
    /// Other ways to write it, and other units: symbol, numerator and denominator of its size.
    pub(crate) others: &'static [(&'static str, f64, f64)],
}

impl Unit {
    const NONE: Self = Self { symbol: "", after: "", others: &[] };
    const SPEED: Self = Self { symbol: "mm/s", after: " mm/s", others: &[("m/s", 1000.0, 1.0)] };
    const FORCE: Self = Self { symbol: "N", after: " N", others: &[("kN", 1000.0, 1.0)] };
    const RATE: Self = Self {
        symbol: "N/mm",
        after: " N/mm",
        others: &[("kN/mm", 1000.0, 1.0), ("N/m", 1.0, 1000.0), ("N/um", 1000.0, 1.0)],
    };
    const MASS: Self = Self { symbol: "kg", after: " kg", others: &[("g", 1.0, 1000.0)] };
    const INERTIA: Self = Self {
        symbol: "kg mm²",
        after: " kg mm²",
        others: &[
            ("kg mm^2", 1.0, 1.0),
            ("kg m²", 1_000_000.0, 1.0),
            ("kg m^2", 1_000_000.0, 1.0),
            ("g mm²", 1.0, 1000.0),
        ],
    };
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
    keys: &[
        key("title", Kind::Text, "Printed above the results."),
        key(
            "correlation",
            Kind::Tables(&CORRELATION),
            "Which uncertainties belong together; any number, each between two values.",
        ),
    ],
};

/// In an entry of `[errors]`, beside its value: whether that counts for every part of a table.
pub(crate) const EVERY_PART: &str = "every_part";

/// In an entry of `[errors]`, beside its value or alone, of a column or of `[budget]`: on which teeth an error is.
pub(crate) const EXTENT: &str = "extent";

/// The keys of an uncertainty, beside the value that it is of.
pub(crate) const UNCERTAINTY_KEYS: [&str; 6] = ["u", "U", "k", "half_width", "distribution", "dof"];

pub(crate) const CORRELATION: Section = Section {
    name: "correlation",
    doc: "The correlation of two uncertain values.",
    keys: &[
        key("between", Kind::Pair, "The two values: their keys, such as \"rack_pitch\" or \"rack.face_width\"."),
        key(
            "coefficient",
            Kind::Number(Domain {
                name: "correlation coefficient",
                symbol: "r",
                lower: Bound::Inclusive(-1),
                upper: Bound::Inclusive(1),
            }),
            "Correlation coefficient r, -1 to 1.",
        ),
    ],
};

pub(crate) const DECISION: Section = Section {
    name: "decision",
    doc: "How a verdict is reached.",
    keys: &[key(
        "rule",
        Kind::Rule,
        "simple: the measured value decides. iso14253: with a guard band of 1.65 standard uncertainties. guard=VALUE: with \
         that guard band. Default simple.",
    )],
};

pub(crate) const PAIR: Section = Section {
    name: "pair",
    doc: "What rack and pinion have in common.",
    keys: &[
        key("normal_module", Kind::Length(domain::NORMAL_MODULE), "Normal module m_n."),
        key(
            "transverse_module",
            Kind::Length(domain::TRANSVERSE_MODULE),
            "Transverse module of the pinion m_t, instead of the normal one: m_n = m_t cos β_p.",
        ),
        key(
            "normal_pressure_angle",
            Kind::Angle(domain::NORMAL_PRESSURE_ANGLE),
            "Normal pressure angle α_n, above 0° and at most 45°.",
        ),
        key(
            "shaft_angle",
            Kind::Angle(domain::SHAFT_ANGLE),
            "Magnitude of the shaft angle Σ = β_r + β_p, against which the helix angles are checked; 0° where the pinion's axis \
             lies square across the rack.",
        ),
        key(
            "contact",
            Kind::Word(&[BOTH_FLANKS]),
            "\"both flanks\" states, where the geometry is not given, that a tooth of the rack and one of the pinion always carry \
             with both flanks: ε ≥ 1 + 2|c| and ε ≥ 1 + |1 − 2c|, ε and c being length and offset of the path of contact in \
             pitches.",
        ),
    ],
};

/// What `[pair] contact` may state.
pub(crate) const BOTH_FLANKS: &str = "both flanks";

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
        key(
            "toothed_length",
            Kind::Length(Domain::positive("toothed length", "L")),
            "Length L of the toothed part; its developed diameter is L/π.",
        ),
        key("pin", Kind::Length(domain::PIN_DIAMETER), "Diameter of the pin behind measured over-pin values."),
        key("measured", Kind::File, "Table of measured spaces: over-pin, position, lead."),
        key("deviation", Kind::Tables(&RACK_DEVIATION), "Deviations of some teeth; any number, they add up."),
        key(
            "crowning",
            Kind::Length(FORM),
            "Lead crowning: removed at the ends of the face width, falling off as the square towards its middle.",
        ),
        key("tip_relief", Kind::Table(&TIP_RELIEF), "Relief of the flanks towards their tips."),
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
        key("measured", Kind::File, "Table of measured teeth: radial, left and right pitch, lead."),
        key("deviation", Kind::Tables(&PINION_DEVIATION), "Deviations of some teeth; any number, they add up."),
        key(
            "crowning",
            Kind::Length(FORM),
            "Lead crowning: removed at the ends of the face width, falling off as the square towards its middle.",
        ),
        key(
            "profile_slope",
            Kind::Length(Domain::any("profile slope", "f_Hα")),
            "Removed at the tip, in proportion to the roll angle from the start of the involute.",
        ),
    ],
};

pub(crate) const ERRORS: Section = Section {
    name: "errors",
    doc: "The measured errors: a deviation, or the values from which it follows; with every_part = true beside it, the \
          error of every part of a table; with extent = \"one\", \"part\", \"all\", \"each\" or \"total\" beside it, on which teeth.",
    keys: &[
        key(
            "rack_over_roller",
            Kind::Error(DeviationKind::RackOverRoller),
            "Over-roller error of the rack, M - M_nom; with { measured, roller } the nominal is computed.",
        ),
        key("rack_pitch", Kind::Error(DeviationKind::RackPitch), "Pitch error of the rack, along its axis."),
        key(
            "rack_lead",
            Kind::Error(DeviationKind::RackLead),
            "Lead angle error of the rack; or { f_h_beta, length }, a helix slope deviation over its length.",
        ),
        key("pinion_radial", Kind::Error(DeviationKind::PinionRadial), "Radial measurement error of the pinion."),
        key(
            "pinion_pitch",
            Kind::Error(DeviationKind::PinionPitch),
            "Single pitch deviation f_p of the pinion, transverse, at the reference circle.",
        ),
        key(
            "pinion_lead",
            Kind::Error(DeviationKind::PinionLead),
            "Helix slope deviation f_Hβ of the pinion over its face width, along the transverse base tangent.",
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
        key("pinion_lead", Kind::Limit, "Limits of ΔCD from the pinion's helix slope deviation."),
    ],
};

/// An amount removed from a flank, normal to it.
const FORM: Domain =
    Domain { name: "amount removed from the flank", symbol: "c", lower: Bound::Inclusive(0), upper: Bound::None };

const DISPLACEMENT: Domain = Domain::any("displacement", "e");

pub(crate) const TIP_RELIEF: Section = Section {
    name: "rack.tip_relief",
    doc: "Tip relief of the rack, growing linearly from its start to the tip.",
    keys: &[
        key("amount", Kind::Length(FORM), "Removed at the tip, normal to the flank."),
        key(
            "start",
            Kind::Length(Domain::any("start of the tip relief", "h_0")),
            "Height above the reference plane at which it starts.",
        ),
    ],
};

pub(crate) const RACK_DEVIATION: Section = Section {
    name: "rack.deviation",
    doc: "What is wrong with some teeth of the rack.",
    keys: &[
        key("teeth", Kind::Teeth, "The teeth concerned. Default \"all\"."),
        key("over_roller", Kind::Length(DISPLACEMENT), "Pitch-line shift of both flanks, along Z; the tip stays."),
        key(
            "pitch",
            Kind::Length(DISPLACEMENT),
            "The pitch before each of these teeth is longer by this; later teeth keep the sum.",
        ),
        key("shift", Kind::Length(DISPLACEMENT), "The teeth shifted along X."),
        key("thickness", Kind::Length(DISPLACEMENT), "Change of the normal tooth thickness at the reference plane."),
        key(
            "lead",
            Kind::Angle(Domain::any("lead deviation", "Δβ")),
            "Helix angle deviation: each flank turned about the vertical through its own mid-width point.",
        ),
        key("left", Kind::Length(DISPLACEMENT), "Left flank alone, along X, outward positive."),
        key("right", Kind::Length(DISPLACEMENT), "Right flank (facing +X) alone, along X, outward positive."),
    ],
};

pub(crate) const ECCENTRICITY: Section = Section {
    name: "pinion.deviation.eccentricity",
    doc: "The tooth system sits off the axis of rotation, towards a tooth.",
    keys: &[
        key("amount", Kind::Length(Domain::any("eccentricity", "f_e")), "How far."),
        key("tooth", Kind::Count(TOOTH), "Towards which tooth, 0 to z - 1."),
    ],
};

const TOOTH: Domain =
    Domain { name: "tooth number", symbol: "j", lower: Bound::Inclusive(0), upper: Bound::Inclusive(99_999) };

pub(crate) const PINION_DEVIATION: Section = Section {
    name: "pinion.deviation",
    doc: "What is wrong with some teeth of the pinion; lengths are arcs at the reference circle.",
    keys: &[
        key("teeth", Kind::Teeth, "The teeth concerned, 0 to z - 1. Default \"all\"."),
        key("shift", Kind::Length(DISPLACEMENT), "The teeth shifted towards higher index."),
        key("thickness", Kind::Length(DISPLACEMENT), "Change of the transverse tooth thickness."),
        key(
            "lead",
            Kind::Angle(Domain::any("lead deviation", "Δβ")),
            "Helix angle deviation; the section at mid-width stays.",
        ),
        key("left", Kind::Length(DISPLACEMENT), "Left flank (facing lower index) alone, outward positive."),
        key("right", Kind::Length(DISPLACEMENT), "Right flank (facing higher index) alone, outward positive."),
        key("radial", Kind::Length(DISPLACEMENT), "The space after each of these teeth sits higher by this."),
        key("eccentricity", Kind::Table(&ECCENTRICITY), "The whole part off its axis."),
    ],
};

pub(crate) const SUPPORT: Section = Section {
    name: "support",
    doc: "How the rack is held.",
    keys: &[
        key("roll", Kind::Word(&["fixed", "free"]), "Whether the rack may roll about its own axis. Default fixed."),
        key(
            "roll_axis_depth",
            Kind::Length(Domain::any("depth of the roll axis", "h_roll")),
            "How far the roll axis lies below the reference plane.",
        ),
    ],
};

pub(crate) const TOLERANCE: Section = Section {
    name: "tolerance",
    doc: "What an error given as { class = … } refers to.",
    keys: &[
        key("standard", Kind::Standard, "The accuracy standard and its edition, such as iso1328-1:1995."),
        key(
            "diameter",
            Kind::RackDiameter,
            "Which reference diameter stands for the rack: \"pinion\", \"developed\" (L/π), or a length. No default.",
        ),
    ],
};

/// What a column holds: the value itself, or its difference from nominal.
const COLUMN_KIND: Key = key(
    "kind",
    Kind::Word(&["measured", "deviation"]),
    "Whether the column holds measured values or deviations. Default: measured if there is a nominal value.",
);

const COLUMN_NAME: Key = key("name", Kind::Text, "The column's name in the header, if it is not the error's own.");

const LENGTH_UNIT: Key =
    key("unit", Kind::ColumnUnit { of_lead: false }, "Unit of its numbers. Default: the header's, or mm.");

const LENGTH_NOMINAL: Key =
    key("nominal", Kind::Length(Domain::any("nominal value", "M_nom")), "Nominal value of what was measured.");

const fn column_extent(unit: deviation::Unit) -> Key {
    key(
        EXTENT,
        Kind::Extent(unit),
        "On which teeth each value is. Default: as [errors] says, or as of any measured value.",
    )
}

pub(crate) const SIZE_COLUMN: Section = Section {
    name: "batch.columns.(size)",
    doc: "A column of sizes.",
    keys: &[COLUMN_NAME, LENGTH_UNIT, LENGTH_NOMINAL, COLUMN_KIND, column_extent(deviation::Unit::Space)],
};

pub(crate) const PITCH_COLUMN: Section = Section {
    name: "batch.columns.(pitch)",
    doc: "A column of pitches.",
    keys: &[COLUMN_NAME, LENGTH_UNIT, LENGTH_NOMINAL, COLUMN_KIND, column_extent(deviation::Unit::Pitch)],
};

pub(crate) const SLOPE_COLUMN: Section = Section {
    name: "batch.columns.pinion_lead",
    doc: "A column of helix slope deviations f_Hβ.",
    keys: &[COLUMN_NAME, LENGTH_UNIT, LENGTH_NOMINAL, COLUMN_KIND, column_extent(deviation::Unit::Tooth)],
};

pub(crate) const ANGLE_COLUMN: Section = Section {
    name: "batch.columns.rack_lead",
    doc: "A column of angles, or of helix slope deviations f_Hβ.",
    keys: &[
        COLUMN_NAME,
        key(
            "unit",
            Kind::ColumnUnit { of_lead: true },
            "Unit of its numbers; a unit of length means f_Hβ. Default: the header's, or degrees.",
        ),
        key("length", Kind::Length(domain::EVALUATION_LENGTH), "Evaluation length of f_Hβ."),
        key("nominal", Kind::Angle(Domain::any("nominal value", "β_nom")), "Nominal value of what was measured."),
        COLUMN_KIND,
        column_extent(deviation::Unit::Tooth),
    ],
};

pub(crate) const BATCH_COLUMNS: Section = Section {
    name: "batch.columns",
    doc: "Where a table with a row per part has what, if its header does not say so.",
    keys: &[
        key("part_id", Kind::Text, "Name of the column that names the part. Default part_id."),
        key("rack_over_roller", Kind::Table(&SIZE_COLUMN), "The rack's over-roller measure or error."),
        key("rack_pitch", Kind::Table(&PITCH_COLUMN), "The rack's pitch or pitch error."),
        key("rack_lead", Kind::Table(&ANGLE_COLUMN), "The rack's lead angle, its error, or f_Hβ."),
        key("pinion_radial", Kind::Table(&SIZE_COLUMN), "The pinion's radial measure or error."),
        key("pinion_pitch", Kind::Table(&PITCH_COLUMN), "The pinion's single pitch deviation."),
        key("pinion_lead", Kind::Table(&SLOPE_COLUMN), "The pinion's helix slope deviation f_Hβ."),
    ],
};

pub(crate) const BATCH: Section = Section {
    name: "batch",
    doc: "Tables with a row per part.",
    keys: &[
        key("columns", Kind::Table(&BATCH_COLUMNS), "Columns that are named or measured otherwise."),
        key(
            "ignore",
            Kind::Texts,
            "Names of columns that are not to be used: `*` stands for any characters, and case does not count.",
        ),
        key(
            "decimal",
            Kind::Word(&["comma", "point"]),
            "What stands before decimals in tables, those of teeth included. Default: found from their numbers.",
        ),
        key(
            "others",
            Kind::Word(&["ignore"]),
            "Once every error has its column: columns that are not understood are listed and not used.",
        ),
    ],
};

const FRACTION: Domain =
    Domain { name: "fraction", symbol: "P", lower: Bound::Exclusive(0), upper: Bound::Inclusive(1) };

pub(crate) const BUDGET: Section = Section {
    name: "budget",
    doc: "Which tolerances are fixed, which are sought, and how they add up; with extent = \"one\", \"part\", \"all\", \"each\" or \
          \"total\" beside one, on which teeth. Default each.",
    keys: &[
        key("stack", Kind::Word(&["worst", "rss", "simulation"]), "How tolerances add up. Default worst."),
        key("conforming", Kind::Number(FRACTION), "Fraction of random assemblies that must conform. Default 0.9973."),
        key(
            "distribution",
            Kind::Word(&["uniform", "normal", "triangular"]),
            "How errors spread within their tolerances. Default uniform.",
        ),
        key("rack_over_roller", Kind::Tolerance(DeviationKind::RackOverRoller), "Tolerance of the over-roller error."),
        key("rack_pitch", Kind::Tolerance(DeviationKind::RackPitch), "Tolerance of the rack's pitch error."),
        key("rack_lead", Kind::Tolerance(DeviationKind::RackLead), "Tolerance of the rack's lead angle error."),
        key("pinion_radial", Kind::Tolerance(DeviationKind::PinionRadial), "Tolerance of the pinion's radial error."),
        key("pinion_pitch", Kind::Tolerance(DeviationKind::PinionPitch), "Tolerance of the pinion's pitch error."),
        key(
            "pinion_lead",
            Kind::Tolerance(DeviationKind::PinionLead),
            "Tolerance of the pinion's helix slope deviation; not among those sought where none is named.",
        ),
    ],
};

/// The sections in the order in which they are documented.
pub(crate) const SECTIONS: &[Section] =
    &[PAIR, RACK, PINION, SUPPORT, TOLERANCE, BUDGET, ERRORS, LIMITS, DECISION, BATCH, SIMULATION, SCATTER];
