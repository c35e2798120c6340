//! A pair with its deviations, and each flank pair's constants made from them. Called by the solver once per
//! tooth; does no search.

use super::contact::{Across, FlankContact, Form, FormRates, Plane, Pose, RollRates};
use super::{FlankSide, MeshError};
use crate::deviation::{PinionFlanks, RackFlanks};
use crate::gear::Pair;
use crate::trig;

/// How the rack is held.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Support {
    /// It cannot roll.
    #[default]
    Fixed,
    /// It may roll freely about an axis parallel to X, at Y = 0 and this far below the reference plane, as a rack
    /// in a cylindrical joint does; it takes the roll with the smallest centre distance, of those up to
    /// [`LARGEST_ROLL_RAD`](super::LARGEST_ROLL_RAD).
    FreeRoll {
        /// Depth of the axis below the reference plane, mm.
        axis_depth_mm: f64,
    },
}

/// A rack and pinion with their deviations, ready to be solved at any stroke.
#[derive(Debug, Clone)]
pub struct Mesh {
    pair: Pair,
    rack: RackFlanks,
    pinion: PinionFlanks,
    support: Support,
}

impl Mesh {
    /// Puts a pair and its deviations together.
    ///
    /// # Errors
    /// [`MeshError::PinionToothOrder`] if the pinion's flanks are not in the order of their teeth;
    /// [`MeshError::RollAxis`] if the roll axis is not at a finite depth.
    pub fn new(pair: Pair, rack: RackFlanks, pinion: PinionFlanks, support: Support) -> Result<Self, MeshError> {
        if let Support::FreeRoll { axis_depth_mm } = support
            && (axis_depth_mm.is_nan() || axis_depth_mm.abs() > 1e6)
        {
            return Err(MeshError::RollAxis { depth_mm: axis_depth_mm });
        }
        let p = pair.pinion();
        let (width, pitch) = (2.0 * p.base_half_angle_rad * p.reference_radius_mm, p.transverse_pitch_mm);
        let teeth = pinion.teeth();
        for (tooth, j) in (0..p.teeth).zip(0_usize..) {
            let next = &teeth[(j + 1) % teeth.len()];
            let thickness = width + teeth[j].right.arc_mm - teeth[j].left.arc_mm;
            let step = pitch + next.left.arc_mm - teeth[j].left.arc_mm;
            if thickness <= 0.0 || step <= 0.0 {
                return Err(MeshError::PinionToothOrder { tooth });
            }
        }
        Ok(Self { pair, rack, pinion, support })
    }

    /// The pair without deviations, on a fixed support.
    ///
    /// # Errors
    /// None for a valid pair; the type is that of [`Mesh::new`].
    pub fn nominal(pair: Pair) -> Result<Self, MeshError> {
        Self::new(pair, RackFlanks::nominal(&pair), PinionFlanks::nominal(&pair), Support::Fixed)
    }

    /// The nominal geometry.
    #[must_use]
    pub const fn pair(&self) -> &Pair {
        &self.pair
    }

    /// The rack's deviations.
    #[must_use]
    pub const fn rack(&self) -> &RackFlanks {
        &self.rack
    }

    /// The pinion's deviations.
    #[must_use]
    pub const fn pinion(&self) -> &PinionFlanks {
        &self.pinion
    }

    /// How the rack is held.
    #[must_use]
    pub const fn support(&self) -> Support {
        self.support
    }
}

/// A flank pair with what places it.
#[derive(Debug, Clone)]
pub(super) struct Prepared {
    pub(super) contact: FlankContact,
    /// For a flank with form: the flank without form, and by how much less that may ask for at most.
    pub(super) plain: Option<Box<(FlankContact, f64)>>,
    /// The flank's start angle less the tooth's.
    pub(super) start: f64,
    /// Demand per displacement of the tooth, away from its own side.
    pub(super) per_shift: f64,
    /// How these constants change with the rack's roll.
    pub(super) rates: RollRates,
    /// Mean displacement of the rack tooth along X, mm.
    pub(super) center: f64,
    /// Whether the tooth has thickness and lies before the next one.
    pub(super) in_order: bool,
}

/// A flank of a rack tooth that is not rolled, and the pinion's flank that meets it; both mirrored if it is a left one.
pub(crate) struct MatingFlanks {
    /// The outward normal of the rack's flank, and its distance from the tooth's nominal place.
    pub(crate) normal: [f64; 3],
    pub(crate) offset: f64,
    pub(crate) rack_lead_rad: f64,
    /// Half of the rack tooth's nominal thickness along X, mm.
    pub(crate) half_x: f64,
    /// Number of the pinion's tooth, counted on over turns.
    pub(crate) pinion_tooth: i64,
    pub(crate) pinion_lead_rad: f64,
    /// The start angle of the pinion's flank less its tooth's.
    pub(crate) start: f64,
}

/// Roll of the rack with what depends on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Roll {
    pub(super) angle: f64,
    pub(super) sin: f64,
    pub(super) cos: f64,
    pub(super) depth: f64,
}

impl Roll {
    pub(super) const NONE: Self = Self { angle: 0.0, sin: 0.0, cos: 1.0, depth: 0.0 };

    pub(super) fn new(angle: f64, depth: f64) -> Self {
        let (sin, cos) = trig::sin_cos(angle);
        Self { angle, sin, cos, depth }
    }
}

/// One side of a rack tooth as the roll has it.
struct RolledTooth {
    flank: Plane,
    tip: Plane,
    across: Across,
    /// Centre distance per distance along the flank's normal.
    per_height: f64,
    rates: RollRates,
}

/// Helices below this turn over the whole face (rad) are none: the flank moves by less than 1e-12 of its radius.
const NO_HELIX: f64 = 1e-12;

impl Prepared {
    /// Whether this pair certainly asks for no more than the mark.
    pub(super) fn stays_below(&self, pose: &Pose, mark: f64) -> bool {
        match &self.plain {
            Some(plain) => plain.0.stays_below(pose, mark - plain.1),
            None => self.contact.stays_below(pose, mark),
        }
    }
}

impl FlankSide {
    pub(crate) const fn sign(self) -> f64 {
        match self {
            Self::Right => 1.0,
            Self::Left => -1.0,
        }
    }
}

impl Mesh {
    /// One side of rack tooth `index`, and what meets it.
    pub(crate) fn mating_flanks(&self, side: FlankSide, index: i64) -> MatingFlanks {
        let (rack, pinion) = (self.pair.rack(), self.pair.pinion());
        let (tooth, sign) = (self.rack.tooth(index), side.sign());
        let (flank, pinion_tooth) = match side {
            FlankSide::Right => (tooth.right, index),
            FlankSide::Left => (tooth.left, index - 1),
        };
        let partner = usize::try_from(pinion_tooth.rem_euclid(i64::from(pinion.teeth))).unwrap_or(0);
        let partner = &self.pinion.teeth()[partner];
        let partner = if side == FlankSide::Right { partner.left } else { partner.right };
        let (sin_n, cos_n) = trig::sin_cos(self.pair.normal_pressure_angle_rad());
        let (sin_b, cos_b) = trig::sin_cos(sign * (rack.helix_angle_rad + flank.lead_rad));
        let normal = [cos_b * cos_n, -sin_b * cos_n, sin_n];
        let half_x = 0.5 * rack.tooth_thickness_mm / trig::cos(rack.helix_angle_rad);
        MatingFlanks {
            normal,
            offset: normal[0] * (sign * flank.along_x_mm + half_x) + normal[2] * flank.along_z_mm,
            rack_lead_rad: flank.lead_rad,
            half_x,
            pinion_tooth,
            pinion_lead_rad: partner.lead_rad,
            start: sign * partner.arc_mm / pinion.reference_radius_mm - pinion.base_half_angle_rad,
        }
    }

    /// The constants of one side of rack tooth `index`.
    pub(super) fn prepare(&self, side: FlankSide, index: i64, roll: &Roll) -> Prepared {
        let sign = side.sign();
        let (rack, pinion) = (self.pair.rack(), self.pair.pinion());
        let tooth = self.rack.tooth(index);
        let next = self.rack.tooth(index.saturating_add(1));
        let MatingFlanks { normal, offset, rack_lead_rad, half_x, pinion_lead_rad, start, .. } =
            self.mating_flanks(side, index);
        let RolledTooth { flank: plane, tip, across, per_height, rates } =
            self.rolled_tooth(sign, normal, offset, roll);
        let half_face = 0.5 * pinion.face_width_mm;
        let helix = pinion.helix_angle_rad + pinion_lead_rad;
        let kappa = sign * trig::tan(helix) / pinion.reference_radius_mm;
        let kappa = if kappa.abs() * pinion.face_width_mm < NO_HELIX { 0.0 } else { kappa };
        let nu = trig::atan2(1.0, plane.t);
        let (sin_nu, cos_nu) = trig::sin_cos(nu);
        // what |y| ≤ k/2 leaves of w within this radius, at any centre distance up to it
        let radius = pinion.tip_radius_mm + self.eccentricity();
        let off_axis = across.t.abs() * radius + roll.sin.abs() * (roll.depth.abs() + 2.0 * radius);
        let w_extent = half_face.min((across.half_width + off_axis) / across.w.abs());
        let fits = rack_lead_rad == 0.0 && pinion_lead_rad == 0.0 && roll.angle == 0.0;
        let form = self.form(roll, normal, per_height);
        let of_form = |form: Option<Form>| {
            FlankContact {
                base_radius: pinion.base_radius_mm,
                kappa,
                start_roll: pinion.start_roll_rad,
                tip_roll: pinion.tip_roll_rad,
                half_face,
                flank: plane,
                tip,
                across,
                nu,
                sin_nu,
                cos_nu,
                fits: fits && form.is_none(),
                w_extent,
                tilt: if fits { 0.0 } else { pinion.base_radius_mm * kappa / sin_nu - plane.w },
                form,
                ..FlankContact::default()
            }
            .completed(pinion.tip_radius_mm, self.eccentricity())
        };
        let plain = form.map(|form| Box::new((of_form(None), form.most_added())));
        let middle = |tooth: &crate::deviation::RackTooth| 0.5 * (tooth.left.along_x_mm + tooth.right.along_x_mm);
        let thickness = 2.0 * half_x + tooth.right.along_x_mm - tooth.left.along_x_mm;
        Prepared {
            contact: of_form(form),
            plain,
            start,
            per_shift: sign * normal[0] * per_height,
            rates,
            center: middle(&tooth),
            in_order: thickness > 0.0 && rack.pitch_mm + middle(&next) - middle(&tooth) > 0.0,
        }
    }

    /// The planes of one side of a rack tooth, whose flank has a normal at a distance from the tooth's place, rolled about
    /// the rack's axis.
    fn rolled_tooth(&self, sign: f64, normal: [f64; 3], d: f64, roll: &Roll) -> RolledTooth {
        let rack = self.pair.rack();
        let rolled_y = normal[1] * roll.cos - normal[2] * roll.sin;
        let rolled_z = normal[1] * roll.sin + normal[2] * roll.cos;
        let rolled_d = d + (normal[2] - rolled_z) * roll.depth;
        let (sin_s, cos_s) = trig::sin_cos(sign * self.pair.shaft_angle_rad());
        let inverse = 1.0 / rolled_z;
        let plane = Plane {
            d: rolled_d * inverse,
            t: (normal[0] * cos_s - rolled_y * sin_s) * inverse,
            w: (normal[0] * sin_s + rolled_y * cos_s) * inverse,
        };
        let tan_roll = roll.sin / roll.cos;
        let tip = Plane {
            d: (rack.addendum_mm + roll.depth) / roll.cos - roll.depth,
            t: tan_roll * sin_s,
            w: -tan_roll * cos_s,
        };
        let across =
            Across { t: -sin_s * roll.cos, w: cos_s * roll.cos, z: roll.sin, half_width: 0.5 * rack.face_width_mm };
        // derivatives by the roll: the normal turns, y' = −z and z' = y
        let inverse_rate = -inverse * inverse * rolled_y;
        let level = 1.0 / (roll.cos * roll.cos);
        let rates = RollRates {
            flank: Plane {
                d: -rolled_y * roll.depth * inverse + rolled_d * inverse_rate,
                t: rolled_z * sin_s * inverse + (normal[0] * cos_s - rolled_y * sin_s) * inverse_rate,
                w: -rolled_z * cos_s * inverse + (normal[0] * sin_s + rolled_y * cos_s) * inverse_rate,
            },
            tip: Plane { d: (rack.addendum_mm + roll.depth) * roll.sin * level, t: sin_s * level, w: -cos_s * level },
            across: Across { t: sin_s * roll.sin, w: -cos_s * roll.sin, z: roll.cos, half_width: 0.0 },
            per_shift: sign * normal[0] * inverse_rate,
            form: FormRates { per_normal: inverse_rate, per_normal_on_tip: normal[2] * roll.sin * level },
        };
        RolledTooth { flank: plane, tip, across, per_height: inverse, rates }
    }

    pub(super) fn has_form(&self) -> bool {
        !self.rack.form().is_plain() || !self.pinion.form().is_plain()
    }

    pub(super) fn eccentricity(&self) -> f64 {
        let (along, across) = self.pinion.eccentricity_mm();
        (along * along + across * across).sqrt()
    }

    /// The amounts of flank form, if there are any.
    fn form(&self, roll: &Roll, normal: [f64; 3], per_height: f64) -> Option<Form> {
        let (rack, pinion) = (self.rack.form(), self.pinion.form());
        (!rack.is_plain() || !pinion.is_plain()).then(|| Form {
            rack: *rack,
            pinion: *pinion,
            tip: self.pair.rack().addendum_mm,
            per_normal: per_height,
            per_normal_on_tip: normal[2] / roll.cos,
            fall: normal[1] / normal[2],
            roll: (roll.sin, roll.cos),
            depth: roll.depth,
        })
    }
}

#[cfg(test)]
mod tests;
