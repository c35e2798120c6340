//! What is known about a pair: its path of contact, its own error-free curve, how much of the faces carries. Made once for
//! a pair and a size of errors; knows no single error.

use std::f64::consts::PI;
use std::ops::Range as Strokes;
use std::sync::OnceLock;

use super::counts::{Counts, StepDirection};
use super::field::{
    ContactPath, Field, line_distance, mm_per_rad, shift_rad, skew, thickness_deviation, thickness_offset,
};
use super::lead_tables::LeadTables;
use super::levels::Levels;
use super::profile::{Profile, Rolls};
use super::undercut::UndercutTable;
use super::{NoBound, Range};
use crate::deviation::{Part, PinionFlanks, PinionForm, RackFlanks, RackForm};
use crate::gear::{GeometryError, Pair, PairData, PinionData, RackData};
use crate::mesh::{Mesh, MeshPoint, SOLVED_MM, Support};
use crate::trig;

/// Everything that is given of a pair except its errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenPair {
    /// Its nominal geometry.
    pub pair: Pair,
    /// Form of the rack's flanks.
    pub rack_form: RackForm,
    /// Form of the pinion's flanks.
    pub pinion_form: PinionForm,
    /// How the rack is held.
    pub support: Support,
}

/// A pair whose geometry is known, and what follows from it for errors up to a reach.
#[derive(Debug)]
pub struct KnownPair {
    pub(super) given: GivenPair,
    /// The errors for which this holds.
    pub(super) reach: Reach,
    /// The path without errors.
    pub(super) nominal: ContactPath,
    /// Where lines of contact carry whatever the errors.
    pub(super) line: ContactPath,
    /// Where flanks that stand out carry, by how much they stand out, in rising order.
    pub(super) levels: Levels,
    pub(super) own: Own,
    /// How many steps act at once, of each [`StepDirection`].
    counts: Vec<Counts>,
    /// By how much less one space of the rack, and of the pinion, lifts because edges stand back.
    space_stands_back: [f64; 2],
    /// What flanks of two teeth lift together, where some are undercut: computed when it is first asked for.
    pub(super) undercut: Option<OnceLock<UndercutTable>>,
    /// Leads at the nodes that were needed so far.
    pub(super) leads: LeadTables,
    /// Half the rack's width, and half the pinion's, over which profiles alone always carry; `None` if they do not.
    pub(super) rack_sections: Option<f64>,
    pub(super) pinion_sections: Option<f64>,
}

/// The curve of error-free parts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Own {
    pub(super) range: Range,
    /// Where only lines of contact carry, mm.
    pub(super) of_lines: f64,
    /// The upper end if no error of the pinion shifts the sides against each other, mm.
    pub(super) unshifted_upper: f64,
    /// The upper end with rack tips that stand out as much more as errors lower a flank, mm.
    pub(super) upper_of_sunk_flanks: f64,
}

impl Own {
    /// The curve of a pair that stays at a ΔCD, mm.
    pub(super) fn at(delta_cd_mm: f64) -> Self {
        let range = Range { lower: delta_cd_mm, upper: delta_cd_mm };
        Self { range, of_lines: delta_cd_mm, unshifted_upper: delta_cd_mm, upper_of_sunk_flanks: delta_cd_mm }
    }
}

/// Teeth that are known one by one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownTeeth {
    /// The extremes of the exact mesh of these teeth with a part that has no errors.
    pub range: Range,
    /// Whether the mesh solved every stroke; otherwise there is no bound.
    pub solved: bool,
}

impl KnownTeeth {
    /// The range of ΔCD without other errors.
    ///
    /// # Errors
    /// [`NoBound::NotSolved`] if the mesh has no solution at a stroke.
    pub(super) const fn alone(self) -> Result<Range, NoBound> {
        if self.solved { Ok(self.range) } else { Err(NoBound::NotSolved) }
    }
}

/// How far all errors together may move ΔCD.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// By how much they may lower and raise ΔCD at most.
    pub range: Range,
    /// How far the errors of the pinion alone may move ΔCD either way, mm.
    pub of_pinion_mm: f64,
}

impl Reach {
    /// The larger of both directions, mm.
    pub(super) fn largest(&self) -> f64 {
        self.range.upper.max(-self.range.lower)
    }

    /// The reach together with known teeth of either part.
    pub(super) fn with(self, teeth: Option<KnownTeeth>) -> Self {
        let Some(KnownTeeth { range, .. }) = teeth else { return self };
        let of_teeth = range.upper.max(-range.lower).max(0.0);
        let Range { lower, upper } = self.range;
        Self {
            range: Range { lower: lower - of_teeth, upper: upper + of_teeth },
            of_pinion_mm: self.of_pinion_mm + of_teeth,
        }
    }

    /// Whether this reach contains another one.
    pub(super) fn holds(&self, other: &Self) -> bool {
        other.range.lower >= self.range.lower
            && other.range.upper <= self.range.upper
            && other.of_pinion_mm <= self.of_pinion_mm
    }
}

/// Tolerances of an own curve, mm: for a curve by sides, and for a rack that may roll, which is slow.
const ROLLING_CURVE_MM: f64 = 1e-5;
const SIDES_CURVE_MM: f64 = 1e-6;
/// Flanks are shortened this many times as far as they shift; this also covers that a shorter tip falls off less steeply.
const SHORTENING: f64 = 2.0;
/// Where teeth take over from each other errors hold them apart, so that both sides sink further than either curve shows: by
/// this many times the change of a side along a shift. Found by trials, not proven.
const SWINGS: f64 = 4.0;

impl GivenPair {
    /// A pair with plain flanks and a rack that does not roll.
    #[must_use]
    pub fn plain(pair: Pair) -> Self {
        let (rack_form, pinion_form) = (RackForm::default(), PinionForm::default());
        Self { pair, rack_form, pinion_form, support: Support::Fixed }
    }

    /// The pair with some of its sizes changed.
    ///
    /// # Errors
    /// [`GeometryError`] if that leaves no pair.
    pub(crate) fn varied(&self, change: impl FnOnce(&mut PairData)) -> Result<Self, GeometryError> {
        let mut data = data_of(&self.pair);
        change(&mut data);
        Ok(Self { pair: Pair::new(&data)?, ..*self })
    }

    fn has_form(&self) -> bool {
        !(self.rack_form.is_plain() && self.pinion_form.is_plain())
    }

    pub(super) fn rolls(&self) -> bool {
        self.support != Support::Fixed
    }
}

impl KnownPair {
    /// What is known of a pair for errors within a reach. Solves the error-free mesh over a pitch
    /// where lines of contact alone do not say what its curve is: undercut, a contact ratio near 1 and below, flank form, a
    /// rack that may roll.
    ///
    /// # Errors
    /// [`NoBound`] if errors of this size leave no flanks, or the pair does not mesh.
    pub fn new(given: GivenPair, reach: Reach) -> Result<Self, NoBound> {
        let mut known = Self::of_lines(given, reach);
        if known.nominal.ratio <= 0.0 {
            return Err(NoBound::EdgesOnly);
        }
        let of_pinion_mm = known.reach.of_pinion_mm;
        let range = Range { lower: known.lowest()?, upper: known.highest(0.0, of_pinion_mm)? };
        known.own = Own {
            range,
            of_lines: known.of_lines_mm(),
            unshifted_upper: known.highest(0.0, 0.0)?,
            upper_of_sunk_flanks: known.highest(-known.reach.range.lower, of_pinion_mm)?,
        };
        known.count();
        Ok(known)
    }

    /// What follows from lines of contact alone, before the curve and the counts of what acts at once.
    fn of_lines(given: GivenPair, reach: Reach) -> Self {
        let pair = &given.pair;
        let range = Range { lower: reach.range.lower.min(0.0), upper: reach.range.upper.max(0.0) };
        let reach = Reach { range, ..reach };
        let raised = range.upper + excess(pair, -range.lower);
        let shift = SHORTENING * shift_rad(pair, raised.max(-range.lower));
        let shorter = Profile::new(pair, line_distance(pair), -raised);
        let rolls = Rolls { low: shorter.lowest_line() + shift, high: pair.pinion().tip_roll_rad - shift };
        let narrower = skew(pair, shift);
        let line = Field::new(pair, rolls, -narrower).path();
        let levels = Levels::new(pair, -reach.range.lower, reach.largest());
        let mut known = Self {
            given,
            reach,
            nominal: ContactPath::nominal(pair),
            line,
            levels,
            own: Own::default(),
            counts: Vec::new(),
            space_stands_back: [0.0; 2],
            undercut: None,
            leads: LeadTables::default(),
            rack_sections: None,
            pinion_sections: None,
        };
        known.set_sections(rolls, narrower);
        known
    }

    /// Counts how many steps act at once, from the levels.
    fn count(&mut self) {
        self.counts =
            StepDirection::ALL.into_iter().map(|way| Counts::new(way, &self.levels, &self.line, self.gap())).collect();
        let space = |part| self.levels.stands_back(|path| path.ratio - flanks_apart(part, path), 0.0);
        self.space_stands_back = [space(Part::Rack), space(Part::Pinion)];
        self.leads = LeadTables::new(&self.given.pair, self.reach.largest());
        self.undercut = self.is_undercut().then(OnceLock::new);
    }

    pub(super) fn counts(&self, way: StepDirection) -> &Counts {
        &self.counts[way as usize]
    }

    /// By how much less one space of a part lifts because edges stand back, mm.
    pub(super) const fn space_stands_back(&self, part: Part) -> f64 {
        self.space_stands_back[part as usize]
    }

    /// Whether lines of contact carry on both sides at every stroke, whatever the errors.
    pub(super) fn carries_lines(&self) -> bool {
        self.line.ratio >= 1.0 && !self.given.has_form() && !self.given.rolls()
    }

    /// The lowest ΔCD of the pair with flanks shortened by what errors may shift them.
    fn lowest(&self) -> Result<f64, NoBound> {
        let GivenPair { pair, mut rack_form, pinion_form, support } = self.given;
        let offset = thickness_offset(&pair);
        if self.carries_lines() {
            return Ok(offset);
        }
        let raised = self.reach.range.upper + excess(&pair, -self.reach.range.lower);
        let less = shortened(&pair, raised, raised.max(-self.reach.range.lower));
        let pair = Pair::new(&less).map_err(|_| NoBound::NoFlanks)?;
        rack_form.tip_relief_start_mm -= raised;
        let rack = RackFlanks::nominal(&pair).with_form(&pair, rack_form).map_err(|_| NoBound::NoFlanks)?;
        let pinion = PinionFlanks::nominal(&pair).with_form(pinion_form).map_err(|_| NoBound::NoFlanks)?;
        let mesh = Mesh::new(pair, rack, pinion, support).map_err(|_| NoBound::NoFlanks)?;
        if !self.given.rolls() {
            let sides = both_sides(&mesh, shift_rad(&pair, self.reach.of_pinion_mm))?;
            return Ok(offset + sides.lower.min(0.0) - self.form_moved());
        }
        let points = own_curve(&mesh, 0.0..pair.rack().pitch_mm, ROLLING_CURVE_MM)?;
        let lowest = points.iter().map(|point| point.delta_cd_mm).fold(offset, f64::min);
        if self.line.ratio >= 1.0 && !self.given.has_form() && lowest > offset - SOLVED_MM {
            // flanks on lines ask for the least where the rack does not roll, and nothing lies between points
            return Ok(offset);
        }
        Ok(lowest - ROLLING_CURVE_MM - self.form_moved())
    }

    /// How much more of a flank's form a point of contact may meet when errors move it, in mm of ΔCD.
    fn form_moved(&self) -> f64 {
        let GivenPair { pair, rack_form, pinion_form, .. } = &self.given;
        let (rack, pinion) = (pair.rack(), pair.pinion());
        let sin_t = trig::sin(pinion.transverse_pressure_angle_rad);
        let turned = SHORTENING * shift_rad(pair, self.reach.largest());
        let (across, up) = (skew(pair, turned), self.reach.largest() + pinion.base_radius_mm * sin_t * turned);
        let relief = rack_form.tip_relief_mm * up / (rack.addendum_mm - rack_form.tip_relief_start_mm);
        let slope = pinion_form.profile_slope_mm.abs() * turned / (pinion.tip_roll_rad - pinion.start_roll_rad);
        // a crowning rises by 4c per width at its ends
        let crowning = rack_form.crowning_mm / rack.face_width_mm + pinion_form.crowning_mm / pinion.face_width_mm;
        let relief = if rack_form.tip_relief_mm == 0.0 { 0.0 } else { relief };
        (relief + slope + 4.0 * crowning * across) / trig::sin(pair.normal_pressure_angle_rad())
    }

    /// ΔCD without errors where only lines of contact carry, with the form that adds material: a negative profile slope.
    fn of_lines_mm(&self) -> f64 {
        let GivenPair { pair, pinion_form, .. } = &self.given;
        let added = (-pinion_form.profile_slope_mm).max(0.0) / trig::sin(pair.normal_pressure_angle_rad());
        thickness_offset(pair) + added
    }

    /// Whether undercut lifts the pair at some strokes, and lines carry at every one.
    fn is_undercut(&self) -> bool {
        self.own.unshifted_upper > self.own.of_lines && self.carries_lines()
    }

    /// The highest ΔCD without errors, with rack teeth whose tips stand out more by `deeper_mm`, and both sides shifted
    /// against each other by what errors of the pinion do that move ΔCD by `of_pinion_mm`.
    fn highest(&self, deeper_mm: f64, of_pinion_mm: f64) -> Result<f64, NoBound> {
        let pair = &self.given.pair;
        let offset = self.of_lines_mm();
        let excess = excess(pair, deeper_mm);
        if excess == 0.0 {
            return Ok(offset);
        }
        let mut data = data_of(pair);
        data.rack.addendum_mm += deeper_mm;
        let Ok(deeper) = Pair::new(&data) else { return Ok(offset + excess) };
        let mesh = Mesh::nominal(deeper).map_err(|_| NoBound::NoFlanks)?;
        let both = both_sides(&mesh, shift_rad(pair, of_pinion_mm))?;
        Ok(offset + excess.min(both.upper.max(0.0)))
    }

    /// How far the pair alone sinks at most because lines of contact leave gaps, mm.
    pub(super) fn gap(&self) -> f64 {
        (thickness_offset(&self.given.pair) - self.own.range.lower).max(0.0)
    }

    fn set_sections(&mut self, rolls: Rolls, narrower: f64) {
        if self.given.has_form() || self.given.rolls() || rolls.low >= rolls.high {
            return;
        }
        let pair = &self.given.pair;
        let (rack, pinion) = (pair.rack(), pair.pinion());
        let (sin_s, cos_s) = trig::sin_cos(pair.shaft_angle_rad());
        let (sin_t, cos_t) = trig::sin_cos(pinion.transverse_pressure_angle_rad);
        let off_axis = |roll: f64| (pinion.base_radius_mm * (roll * cos_t - sin_t)).abs();
        let skew = sin_s.abs() * off_axis(rolls.low).max(off_axis(rolls.high));
        let transverse = (rolls.high - rolls.low) / pinion.angular_pitch_rad();
        // along the rack a section's place on the pinion moves with the roll angle
        let along = 1.0 + trig::tan(pinion.helix_angle_rad) * cos_t * cos_t * sin_s / cos_s;
        let half = |own: f64, other: f64| Some(own.min(other)).filter(|&half| half >= 0.0);
        if transverse * along.abs() >= 1.0 {
            self.rack_sections =
                half(0.5 * rack.face_width_mm - narrower, 0.5 * pinion.face_width_mm * cos_s.abs() - skew);
        }
        if transverse >= 1.0 {
            let covered = (0.5 * rack.face_width_mm - narrower - skew) / cos_s.abs();
            self.pinion_sections = half(0.5 * pinion.face_width_mm, covered);
        }
    }
}

/// The strokes between the middles of the paths of both flanks of a space, in pitches: its right flank carries around the
/// stroke c, its left one a whole pitch (of a rack space) or none (of a pinion space) after −c.
pub(super) const fn flanks_apart(part: Part, path: &ContactPath) -> f64 {
    match part {
        Part::Rack => (1.0 - 2.0 * path.offset).abs(),
        Part::Pinion => (2.0 * path.offset).abs(),
    }
}

/// The most that one side can ask for beyond its contact lines, with rack tips that stand out more by `deeper_mm`; mm.
fn excess(pair: &Pair, deeper_mm: f64) -> f64 {
    Profile::new(pair, line_distance(pair), deeper_mm).largest_excess()
}

/// The own curve of the pair, without errors.
fn own_curve(mesh: &Mesh, strokes: Strokes<f64>, tolerance_mm: f64) -> Result<Vec<MeshPoint>, NoBound> {
    let points = mesh.curve(strokes.start, strokes.end, tolerance_mm).map_err(|_| NoBound::NoFlanks)?.points;
    if points.iter().all(MeshPoint::is_solved) { Ok(points) } else { Err(NoBound::NotSolved) }
}

/// The least and the most that both sides together ask for beyond their contact lines, if errors shift one against the other
/// by up to an angle of the pinion. Each stroke says what each side asks for: ΔCD ± the transmission error's share.
fn both_sides(mesh: &Mesh, shift_rad: f64) -> Result<Range, NoBound> {
    let pair = mesh.pair();
    let (teeth, pitch) = (f64::from(pair.pinion().teeth), pair.rack().pitch_mm);
    let per_rad = mm_per_rad(pair);
    let window = pitch * shift_rad * teeth / (2.0 * PI);
    let offset = thickness_offset(pair);
    // a pitch, and on either side as much as a shift brings in
    let points = own_curve(mesh, -window..pitch + window, SIDES_CURVE_MM)?;
    let side =
        |point: &MeshPoint, sign: f64| point.delta_cd_mm - offset + sign * per_rad * point.transmission_error_rad;
    let mut both = Range { lower: f64::INFINITY, upper: f64::NEG_INFINITY };
    // how much a side changes within the window: by so much the other side's flanks touch higher or lower
    let mut swing = 2.0 * SIDES_CURVE_MM;
    for point in &points {
        // between points the curve is straight, so the points next to the window count, too
        let near = points.partition_point(|other| other.stroke_mm < point.stroke_mm - window).saturating_sub(1);
        let end = points.partition_point(|other| other.stroke_mm <= point.stroke_mm + window) + 1;
        for other in &points[near..end.min(points.len())] {
            let sum = 0.5 * (side(point, 1.0) + side(other, -1.0));
            both = Range { lower: both.lower.min(sum), upper: both.upper.max(sum) };
            if (other.stroke_mm - point.stroke_mm).abs() <= window {
                swing = swing.max((side(point, 1.0) - side(other, 1.0)).abs());
            }
        }
    }
    Ok(Range { lower: both.lower - SWINGS * swing, upper: both.upper + SIDES_CURVE_MM })
}

/// The pair with shorter flanks: the part of them that is left when errors raise the pinion and move ΔCD by this reach.
fn shortened(pair: &Pair, raised: f64, moved: f64) -> PairData {
    let pinion = pair.pinion();
    let shift = SHORTENING * shift_rad(pair, moved);
    let diameter = |roll: f64| 2.0 * pinion.base_radius_mm * (1.0 + roll * roll).sqrt();
    let mut data = data_of(pair);
    data.rack.face_width_mm -= 2.0 * skew(pair, shift);
    data.rack.addendum_mm -= raised;
    data.pinion.tip_diameter_mm = diameter(pinion.tip_roll_rad - shift);
    data.pinion.root_form_diameter_mm = Some(diameter(pinion.start_roll_rad + shift));
    data
}

/// The data from which this pair is made.
fn data_of(pair: &Pair) -> PairData {
    let (rack, pinion) = (pair.rack(), pair.pinion());
    PairData {
        normal_module_mm: pair.normal_module_mm(),
        normal_pressure_angle_rad: pair.normal_pressure_angle_rad(),
        rack: RackData {
            helix_angle_rad: rack.helix_angle_rad,
            face_width_mm: rack.face_width_mm,
            addendum_mm: rack.addendum_mm,
            tooth_thickness_mm: Some(rack.tooth_thickness_mm),
        },
        pinion: PinionData {
            teeth: pinion.teeth,
            helix_angle_rad: pinion.helix_angle_rad,
            profile_shift: pinion.profile_shift,
            tip_diameter_mm: 2.0 * pinion.tip_radius_mm,
            root_form_diameter_mm: Some(2.0 * pinion.root_form_radius_mm),
            face_width_mm: pinion.face_width_mm,
            tooth_thickness_deviation_mm: thickness_deviation(pair),
        },
    }
}
