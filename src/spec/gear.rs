//! `[rack]`, `[pinion]` and `[support]` as written, and what `[pair]` comes to. Read by [`Spec::parse`](super::Spec::parse);
//! what they mean together is decided where it is asked for.

use std::ops::Range;

use super::Located;
use super::deviations::{self, TipRelief, WrittenPinionDeviation};
use super::reader::SectionReader;
use crate::deviation::RackDeviation;
use crate::quantity::{Angle, Length};

/// `[pair]`: what rack and pinion have in common.
#[derive(Debug, Clone, Default)]
pub struct PairSection {
    /// m_n, given or from m_t of the pinion.
    pub normal_module: Option<Located<Length>>,
    /// α_n
    pub normal_pressure_angle: Option<Located<Angle>>,
    /// Where it is stated that a tooth of either part always carries with both flanks.
    pub both_flanks: Option<Range<usize>>,
}

/// `[rack]`: nominal geometry of the rack.
#[derive(Debug, Clone, Default)]
pub struct RackSection {
    /// β_r
    pub helix_angle: Option<Located<Angle>>,
    /// k
    pub face_width: Option<Located<Length>>,
    /// h_a
    pub addendum: Option<Located<Length>>,
    /// s_n
    pub tooth_thickness: Option<Located<Length>>,
    /// K
    pub datum: Option<Located<Length>>,
    /// L
    pub toothed_length: Option<Located<Length>>,
    /// Diameter of the pin behind measured over-pin values.
    pub pin: Option<Located<Length>>,
    /// Table of measured spaces.
    pub measured: Option<Located<String>>,
    /// `[[rack.deviation]]`
    pub deviations: Vec<Located<RackDeviation>>,
    /// Lead crowning.
    pub crowning: Option<Located<Length>>,
    /// Tip relief.
    pub tip_relief: Option<Located<TipRelief>>,
}

/// `[pinion]`: nominal geometry of the pinion.
#[derive(Debug, Clone, Default)]
pub struct PinionSection {
    /// z
    pub teeth: Option<Located<u32>>,
    /// β_p
    pub helix_angle: Option<Located<Angle>>,
    /// x
    pub profile_shift: Option<Located<f64>>,
    /// b
    pub face_width: Option<Located<Length>>,
    /// d_a
    pub tip_diameter: Option<Located<Length>>,
    /// d_Ff
    pub root_form_diameter: Option<Located<Length>>,
    /// Deviation of the transverse tooth thickness at the reference circle.
    pub tooth_thickness_deviation: Option<Located<Length>>,
    /// Table of measured teeth.
    pub measured: Option<Located<String>>,
    /// `[[pinion.deviation]]`
    pub deviations: Vec<Located<WrittenPinionDeviation>>,
    /// Lead crowning.
    pub crowning: Option<Located<Length>>,
    /// Profile slope.
    pub profile_slope: Option<Located<Length>>,
}

/// `[support]`: how the rack is held.
#[derive(Debug, Clone, Default)]
pub struct SupportSection {
    /// `fixed` or `free`.
    pub roll: Option<Located<&'static str>>,
    /// How far the roll axis lies below the reference plane.
    pub roll_axis_depth: Option<Located<Length>>,
}

/// Reads `[rack]`.
pub(super) fn rack(reader: &mut SectionReader<'_>) -> RackSection {
    RackSection {
        helix_angle: reader.angle("helix_angle"),
        face_width: reader.length("face_width"),
        addendum: reader.length("addendum"),
        tooth_thickness: reader.length("tooth_thickness"),
        datum: reader.length("datum"),
        toothed_length: reader.length("toothed_length"),
        pin: reader.length("pin"),
        measured: reader.file("measured"),
        deviations: deviations::rack(reader),
        crowning: reader.length("crowning"),
        tip_relief: deviations::tip_relief(reader),
    }
}

/// Reads `[pinion]`.
pub(super) fn pinion(reader: &mut SectionReader<'_>) -> PinionSection {
    PinionSection {
        teeth: reader.count("teeth"),
        helix_angle: reader.angle("helix_angle"),
        profile_shift: reader.number("profile_shift"),
        face_width: reader.length("face_width"),
        tip_diameter: reader.length("tip_diameter"),
        root_form_diameter: reader.length("root_form_diameter"),
        tooth_thickness_deviation: reader.length("tooth_thickness_deviation"),
        measured: reader.file("measured"),
        deviations: deviations::pinion(reader),
        crowning: reader.length("crowning"),
        profile_slope: reader.length("profile_slope"),
    }
}

/// Reads `[support]`.
pub(super) fn support(reader: &mut SectionReader<'_>) -> SupportSection {
    SupportSection { roll: reader.word("roll"), roll_axis_depth: reader.length("roll_axis_depth") }
}
