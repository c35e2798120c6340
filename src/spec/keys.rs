//! Every key of the spec, declared once: the reader, the JSON Schema and the suggestions for misspelt
//! keys all follow this table. It holds names, kinds of values and their domains, and reads nothing.

use std::marker::PhantomData;
use std::ops::Bound;

use crate::deviation::{Countable, DeviationKind, ToothRange};
use crate::formula::domain;
use crate::gear::MOST_TEETH;
use crate::judge::Rule;
use crate::judge::class::RackDiameter;
use crate::quantity::{Angle, Domain, Length};
use crate::standard::Standard;

/// The coarsest grade of any standard.
pub(super) const LARGEST_CLASS: u8 = 12;

/// What a key holds.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Kind {
    /// Any text.
    Text,
    /// Any text, or a date or number as it is written.
    Label,
    /// A length, mm.
    Length(Domain),
    /// An angle, degrees.
    Angle(Domain),
    /// A number without a unit.
    Number(Domain),
    /// A whole number.
    Count(Domain),
    /// A number in a unit, or text that names one of its other units.
    Measure(Domain, MeasureUnit),
    /// A deviation, or a table from which one follows.
    Error(DeviationKind),
    /// Limits of ΔCD, or of a play.
    Limit,
    /// Limits of what is measured in this unit.
    MeasureLimit(MeasureUnit),
    /// A stroke, or `"tightest"`.
    SetAt,
    /// The name of a file, relative to the spec.
    File,
    /// A list of texts.
    Texts,
    /// A list of patterns for lines, some of which say how many lines they may leave out.
    LineRules,
    /// The heading of a column with the parts' names, or a pattern of lines that have them.
    PartId,
    /// A list of whole numbers.
    Starts,
    /// A nominal value, or the heading of a column of them.
    NominalOrHeading {
        /// Whether it is an angle.
        is_angle: bool,
    },
    /// The unit of a column of lengths; of a column of lead errors, a unit of angle or, of f_Hβ, of length.
    ColumnUnit {
        /// Whether the column holds lead errors.
        of_lead: bool,
    },
    /// On which teeth an error is that counts these.
    Extent(Countable),
    /// One of these words.
    Word(&'static [&'static str]),
    /// True or false.
    Flag,
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
    /// The same, which means nothing without every key.
    Whole(&'static Section),
    /// Any number of such tables: `[[section.key]]`.
    Tables(&'static Section),
}

/// A unit that is neither a length nor an angle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeasureUnit {
    /// What bare numbers are in; empty for numbers without a unit.
    pub(crate) symbol: &'static str,
    /// The same after a number, with the space that goes between.
    pub(crate) after: &'static str,
    /// Other ways to write it, and other units: symbol, numerator and denominator of its size.
    pub(crate) others: &'static [(&'static str, f64, f64)],
}

impl MeasureUnit {
    const NONE: Self = Self { symbol: "", after: "", others: &[] };
    const SPEED: Self = Self { symbol: "mm/s", after: " mm/s", others: &[("m/s", 1000.0, 1.0)] };
    const FORCE: Self = Self { symbol: "N", after: " N", others: &[("kN", 1000.0, 1.0)] };
    const RATE: Self = Self {
        symbol: "N/mm",
        after: " N/mm",
        others: &[("kN/mm", 1000.0, 1.0), ("N/m", 1.0, 1000.0), ("N/um", 1000.0, 1.0)],
    };
    const TORQUE: Self = Self {
        symbol: "N m",
        after: " N m",
        others: &[
            ("Nm", 1.0, 1.0),
            ("N·m", 1.0, 1.0),
            ("N mm", 1.0, 1000.0),
            ("Nmm", 1.0, 1000.0),
            ("N·mm", 1.0, 1000.0),
        ],
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

/// A key, whatever it holds.
#[derive(Debug, Clone, Copy)]
pub struct AnyKey {
    /// Its name with the sections that it is in, `rack.face_width`; of a key that several tables have, the name alone.
    pub path: &'static str,
    pub(crate) kind: Kind,
    /// What it means.
    pub doc: &'static str,
}

impl AnyKey {
    /// Its name within its section.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }
}

/// A key that holds a `T`.
#[derive(Debug)]
pub struct Key<T> {
    /// The key.
    pub any: AnyKey,
    holds: PhantomData<fn() -> T>,
}

// whether or not a `T` is
impl<T> Copy for Key<T> {}

impl<T> Clone for Key<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Key<T> {
    const fn new(kind: Kind) -> Self {
        Self { any: AnyKey { path: "", kind, doc: "" }, holds: PhantomData }
    }

    const fn with(self, path: &'static str, doc: &'static str) -> Self {
        Self { any: AnyKey { path, doc, ..self.any }, ..self }
    }
}

/// One section; the one without a name holds the keys at the top.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Section {
    pub(crate) name: &'static str,
    pub(crate) doc: &'static str,
    pub(crate) keys: &'static [AnyKey],
}

const fn section(name: &'static str, doc: &'static str, keys: &'static [AnyKey]) -> Section {
    Section { name, doc, keys }
}

/// Declares a section with its keys. A key is declared once, here: what reads, describes, suggests and sets it follows.
/// Keys that are read by name have a constant with their type.
macro_rules! section {
    ($section:ident = $path:literal, $about:literal {
        $($($key:ident: $type:ty =)? $name:literal, $value:expr, $doc:literal;)*
    }) => {
        $($(
            #[doc = $doc]
            pub const $key: Key<$type> = $value.with(concat!($path, ".", $name), $doc);
        )?)*
        pub(crate) const $section: Section =
            section($path, $about, &[$($value.with(concat!($path, ".", $name), $doc).any),*]);
    };
}

mod scatter;
mod simulation;
mod yoke;

pub(crate) use scatter::SCATTER;
pub use simulation::*;
pub use yoke::*;

const fn text() -> Key<String> {
    Key::new(Kind::Text)
}

const fn label() -> Key<String> {
    Key::new(Kind::Label)
}

const fn file() -> Key<String> {
    Key::new(Kind::File)
}

const fn length(domain: Domain) -> Key<Length> {
    Key::new(Kind::Length(domain))
}

const fn angle(domain: Domain) -> Key<Angle> {
    Key::new(Kind::Angle(domain))
}

const fn number(domain: Domain) -> Key<f64> {
    Key::new(Kind::Number(domain))
}

const fn measure(domain: Domain, unit: MeasureUnit) -> Key<f64> {
    Key::new(Kind::Measure(domain, unit))
}

const fn count(domain: Domain) -> Key<u32> {
    Key::new(Kind::Count(domain))
}

const fn word(words: &'static [&'static str]) -> Key<&'static str> {
    Key::new(Kind::Word(words))
}

const fn flag() -> Key<bool> {
    Key::new(Kind::Flag)
}

const fn teeth() -> Key<ToothRange> {
    Key::new(Kind::Teeth)
}

/// A key that does not hold one value: what reads its section reads it.
const fn of(kind: Kind) -> Key<()> {
    Key::new(kind)
}

/// The same without a name of its own in the program.
const fn key(name: &'static str, kind: Kind, doc: &'static str) -> AnyKey {
    AnyKey { path: name, kind, doc }
}

const fn between(name: &'static str, symbol: &'static str, lower: i64, upper: i64) -> Domain {
    Domain { name, symbol, lower: Bound::Included(lower), upper: Bound::Included(upper) }
}

const fn from_zero(name: &'static str, symbol: &'static str) -> Domain {
    Domain { name, symbol, lower: Bound::Included(0), upper: Bound::Unbounded }
}

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

/// In an entry of `[errors]`, beside its value: whether that counts for every part of a table.
pub(crate) const EVERY_PART: &str = "every_part";

/// In an entry of `[errors]` for the pinion's pitch, beside its value or alone: the diameter at which it was measured.
pub(crate) const MEASURED_AT: &str = "measured_at";

/// In an entry of `[errors]`, beside its value or alone, of a column or of `[budget]`: on which teeth an error is.
pub(crate) const EXTENT: &str = "extent";

/// In place of a measured value: repeated readings, whose mean counts and whose spread is its uncertainty.
pub(crate) const READINGS: &str = "values";

/// The keys of an uncertainty, beside the value that it is of.
pub(crate) const UNCERTAINTY_KEYS: [&str; 6] = ["u", "U", "k", "half_width", "distribution", "dof"];

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

/// What a column holds: the value itself, or its difference from nominal.
pub(crate) const COLUMN_KIND: Key<&'static str> = word(&["measured", "deviation"]).with(
    "kind",
    "Whether the column holds measured values or deviations. Default: measured if there is a nominal value.",
);

pub(crate) const COLUMN_NAME: Key<String> =
    text().with("name", "The column's name in the header, if it is not the error's own.");

pub(crate) const LENGTH_NOMINAL: Key<Length> =
    length(Domain::any("nominal value", "M_nom")).with("nominal", "Nominal value of what was measured.");

pub(crate) const ANGLE_NOMINAL: Key<Angle> =
    angle(Domain::any("nominal value", "β_nom")).with("nominal", "Nominal value of what was measured.");

pub(crate) const EVALUATION_LENGTH: Key<Length> =
    length(domain::EVALUATION_LENGTH).with("length", "Evaluation length of f_Hβ.");

const fn column_extent(of: Countable) -> AnyKey {
    key(
        EXTENT,
        Kind::Extent(of),
        "On which teeth each value is. Default: as [errors] says, or as of any measured value.",
    )
}

/// The diameter at which a pitch of the pinion was measured.
pub(crate) const COLUMN_MEASURED_AT: Key<Length> = length(domain::MEASUREMENT_CIRCLE).with(
    MEASURED_AT,
    "Diameter of the circle on which f_p was measured; its values are scaled to the reference circle. Default: that circle.",
);

/// The keys that name columns beside that of an error's values, with what they hold.
pub(crate) const BESIDE: [&str; 5] = ["deviation", "upper", "lower", "uncertainty", "units"];

const fn beside(name: &'static str, doc: &'static str) -> AnyKey {
    key(name, Kind::Text, doc)
}

/// The keys of a column by contract, whose errors are on these.
const fn table_column(of: Countable, is_lead: bool) -> [AnyKey; 10] {
    [
        COLUMN_NAME.any,
        key("unit", Kind::ColumnUnit { of_lead: is_lead }, "Unit of its numbers, if its heading says none."),
        key(
            "nominal",
            Kind::NominalOrHeading { is_angle: is_lead },
            "Nominal value of what was measured, or the heading of a column of them.",
        ),
        beside("deviation", "Heading of a column of deviations, held against measured less nominal."),
        beside("upper", "Heading of a column of upper limits, not judged."),
        beside("lower", "Heading of a column of lower limits, not judged."),
        beside("uncertainty", "Heading of a column of uncertainties, not judged."),
        beside("units", "Heading of a column of units."),
        COLUMN_KIND.any,
        column_extent(of),
    ]
}

/// The same with one key more.
const fn and_key(keys: &[AnyKey; 10], last: AnyKey) -> [AnyKey; 11] {
    let mut all = [last; 11];
    let mut at = 0;
    while at < keys.len() {
        all[at] = keys[at];
        at += 1;
    }
    all
}

const TABLE_SIZE: Section =
    section("table.columns.(size)", "A column of sizes.", &table_column(Countable::Space, false));
const TABLE_PITCH: Section =
    section("table.columns.rack_pitch", "A column of pitches.", &table_column(Countable::Pitch, false));
const TABLE_PINION_PITCH: Section = section(
    "table.columns.pinion_pitch",
    "A column of the pinion's single pitch deviations.",
    &and_key(&table_column(Countable::Pitch, false), COLUMN_MEASURED_AT.any),
);
const TABLE_SLOPE: Section = section(
    "table.columns.pinion_lead",
    "A column of helix slope deviations f_Hβ.",
    &table_column(Countable::Tooth, false),
);
const TABLE_ANGLE: Section = section(
    "table.columns.rack_lead",
    "A column of angles, or of helix slope deviations f_Hβ.",
    &and_key(&table_column(Countable::Tooth, true), EVALUATION_LENGTH.any),
);

pub(crate) const TABLE_TOOTH: Section = section(
    "table.columns.(space or tooth)",
    "A column of spaces or teeth.",
    &[
        COLUMN_NAME.any,
        key("unit", Kind::ColumnUnit { of_lead: true }, "Unit of its numbers, if its heading says none."),
        COLUMN_KIND.any,
    ],
);

pub(crate) const TABLE_TRACE: Section = section(
    "table.columns.(stroke or ΔCD)",
    "A column of a measured curve.",
    &[
        COLUMN_NAME.any,
        key("unit", Kind::ColumnUnit { of_lead: false }, "Unit of its numbers, if its heading says none."),
    ],
);

pub(crate) const TABLE_STATUS: Section = section(
    "table.columns.status",
    "The decision of a measuring program: a part whose text is neither accepted nor rejected has no verdict.",
    &[
        COLUMN_NAME.any,
        key("accept", Kind::Texts, "Texts of parts that are judged by their values."),
        key("reject", Kind::Texts, "Texts of parts that fail."),
    ],
);

pub(crate) const TABLE_COLUMNS: Section = section(
    "table.columns",
    "What the columns of a table are, whose headings do not say it by themselves.",
    &[
        key(
            "part_id",
            Kind::PartId,
            "Heading of the column that names the part, or { line = \"Part: *\" } for a line above its rows.",
        ),
        key("status", Kind::Table(&TABLE_STATUS), "The column of the measuring program's decision."),
        key("rack_over_roller", Kind::Table(&TABLE_SIZE), "The rack's over-roller measure or error."),
        key("rack_pitch", Kind::Table(&TABLE_PITCH), "The rack's pitch or pitch error."),
        key("rack_lead", Kind::Table(&TABLE_ANGLE), "The rack's lead angle, its error, or f_Hβ."),
        key("pinion_radial", Kind::Table(&TABLE_SIZE), "The pinion's radial measure or error."),
        key("pinion_pitch", Kind::Table(&TABLE_PINION_PITCH), "The pinion's single pitch deviation."),
        key("pinion_lead", Kind::Table(&TABLE_SLOPE), "The pinion's helix slope deviation f_Hβ."),
        key("date", Kind::Text, "Heading of dates, for pages."),
        key("inspector", Kind::Text, "Heading of inspectors."),
        key("order", Kind::Text, "Heading of orders."),
        key("drawing", Kind::Text, "Heading of drawings."),
        key("name", Kind::Text, "Of characteristics: heading of the column of their names."),
        key("actual", Kind::Text, "Heading of the column of measured values."),
        key("nominal", Kind::Text, "Heading of the column of nominal values."),
        key("upper", Kind::Text, "Heading of the column of upper limits, not judged."),
        key("lower", Kind::Text, "Heading of the column of lower limits, not judged."),
        key("deviation", Kind::Text, "Heading of the column of deviations."),
        key("uncertainty", Kind::Text, "Heading of the column of uncertainties, not judged."),
        key("unit", Kind::Text, "Heading of the column of units."),
        key("space", Kind::Text, "Of a rack's spaces: heading of the column of their numbers."),
        key("tooth", Kind::Text, "Of a pinion's teeth: heading of the column of their numbers."),
        key("over_pin", Kind::Table(&TABLE_TOOTH), "The measure over the pin in a space, or its deviation."),
        key("position", Kind::Table(&TABLE_TOOTH), "The position of the pin in a space, or its deviation."),
        key("radial", Kind::Table(&TABLE_TOOTH), "The radial deviation of the space behind a tooth."),
        key("left_pitch", Kind::Table(&TABLE_TOOTH), "The single pitch deviation of a tooth's left flank."),
        key("right_pitch", Kind::Table(&TABLE_TOOTH), "The single pitch deviation of a tooth's right flank."),
        key("lead", Kind::Table(&TABLE_TOOTH), "The helix angle deviation of a space or tooth."),
        key("stroke", Kind::Table(&TABLE_TRACE), "Of a measured curve: the stroke."),
        key("delta_cd", Kind::Table(&TABLE_TRACE), "Of a measured curve: ΔCD."),
    ],
);

/// The keys of `[table.columns]` that are headings of what a page says of the parts.
pub(crate) const DETAILS: [&str; 4] = ["date", "inspector", "order", "drawing"];

/// The keys of `[table.columns]` that are headings.
pub(crate) const HEADINGS: [&str; 10] =
    ["name", "actual", "nominal", "upper", "lower", "deviation", "uncertainty", "unit", "space", "tooth"];

section! {
    TABLE = "table", "The contract of tables with values of parts." {
        "columns", of(Kind::Table(&TABLE_COLUMNS)), "What columns are, whose headings do not say it by themselves.";
        TABLE_PARTS: &'static str = "parts", word(&["rows", "columns", "characteristics", "spaces", "teeth"]),
            "What each row is, or columns if each part is one. Default: found from the headings.";
        TABLE_DECIMAL: &'static str = "decimal", word(&["comma", "point"]),
            "What stands before decimals. Default: the only mark by which every number can be read.";
        TABLE_SEPARATOR: String = "separator", text(),
            "What separates cells: a character, or tab. Default: the only one under which the headings are known.";
        TABLE_ENCODING: String = "encoding", text(),
            "The encoding of a text, such as windows-1252. Default: told by its bytes.";
        TABLE_SHEET: String = "sheet", text(), "The sheet of a workbook. Default: the only one with cells.";
        TABLE_RANGE: String = "range", text(), "The cells of a sheet that are the table, such as B4:F200. Default: all.";
        "ignore", of(Kind::Texts),
            "Headings of columns that are not used: `*` stands for any characters, and case counts.";
        "ignore_lines", of(Kind::LineRules),
            "Lines that belong to no part: `#` stands for a number or a date, too; cells stand between semicolons.";
        "comments", of(Kind::Texts), "Comments, text boxes and metadata of a file that are not used.";
        TABLE_OTHERS: &'static str = "others", word(&["ignore"]), "Every further column is not used.";
        TABLE_REPEATS: &'static str = "repeats", word(&["all", "last"]),
            "A part may be there more than once: each row is judged, or the last.";
        TABLE_UNITS: String = "units", text(),
            "The line of units, such as \"line 8\". Default: the one below the headings, if it has nothing but units.";
        "starts", of(Kind::Starts),
            "In which column of characters each cell of a text of fixed width starts: [0, 12, 24].";
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

/// What a page says of the parts, in its order.
pub const REPORT_KEYS: [Key<String>; 5] = [REPORT_PART, REPORT_DATE, REPORT_INSPECTOR, REPORT_ORDER, REPORT_DRAWING];

/// The sections in the order in which they are documented.
pub(crate) const SECTIONS: &[Section] = &[
    PAIR, RACK, PINION, SUPPORT, TOLERANCE, BUDGET, ERRORS, LIMITS, DECISION, TABLE, YOKE, SIMULATION, SCATTER, REPORT,
];
