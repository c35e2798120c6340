//! A virtual measuring machine: a ball in the spaces of the deviated rack and pinion. Called by `measure` and by tests
//! that feed its readings back; it looks at flanks only, never at the mesh.

use super::{Mesh, MeshError};
use crate::deviation::{PinionToothRow, RackSpaceRow};
use crate::trig;

/// A ball in one space of the rack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RackReading {
    /// The space, between the teeth of this index and the next.
    pub space: i64,
    /// Height M of the ball's top above the reference plane, mm.
    pub over_pin_mm: f64,
    /// Position X of the ball's centre from tooth 0's nominal centre line, mm, at mid-width.
    pub position_mm: f64,
    /// M − M_nom, mm.
    pub height_deviation_mm: f64,
    /// X − X_nom, mm.
    pub position_deviation_mm: f64,
    /// Helix angle of the ball's path across the face less β_r, rad.
    pub lead_rad: f64,
}

/// A ball in the space after a pinion tooth, and the tooth's flanks at the reference circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinionReading {
    /// The tooth.
    pub tooth: u32,
    /// Distance of the ball's centre from the tooth system's axis, mm, in the space after the tooth.
    pub radius_mm: f64,
    /// How much higher the space sits, mm: half of the missing width over tan α_t, by the involute from the radius. To first
    /// order it is the radius less its nominal value, for a ball that touches at the reference circle.
    pub radial_mm: f64,
    /// Position of the ball's centre less its nominal one, as arc at the reference circle towards higher index, mm.
    pub position_mm: f64,
    /// Single pitch deviation of left flanks from the tooth before to this one, mm.
    pub left_pitch_mm: f64,
    /// Single pitch deviation of right flanks from the tooth before to this one, mm.
    pub right_pitch_mm: f64,
}

impl RackReading {
    /// The row of measured data that says the same.
    #[must_use]
    pub const fn row(&self) -> RackSpaceRow {
        RackSpaceRow {
            space: self.space,
            height_mm: self.height_deviation_mm,
            position_mm: self.position_deviation_mm,
            lead_rad: Some(self.lead_rad),
        }
    }
}

impl PinionReading {
    /// The reading as a row of measured data, without left and right pitches: the position has part of them already.
    #[must_use]
    pub fn row(&self) -> PinionToothRow {
        PinionToothRow {
            tooth: i64::from(self.tooth),
            radial_mm: Some(self.radial_mm),
            position_mm: Some(self.position_mm),
            left_pitch_mm: None,
            right_pitch_mm: None,
            lead_rad: None,
        }
    }
}

impl Mesh {
    /// Puts a ball into spaces of the rack, resting on the right flank of tooth j and the left flank of tooth j + 1.
    ///
    /// With the flanks' planes n·p = d the centre c satisfies n_R·c = d_R + D/2 and n_L·c = d_L + D/2. It is read at Y
    /// = 0, and again at Y = ±k/4 for the helix. The readings fed back as measured data give the same flanks if both
    /// flanks of each space have the nominal helix; a lead error changes the flanks' angle in the X-Z plane, which a
    /// ball sees as height, a second-order effect on a straight rack.
    ///
    /// # Errors
    /// [`MeshError::NotPositive`] unless the diameter is positive and finite.
    pub fn measure_rack(
        &self,
        diameter_mm: f64,
        spaces: impl IntoIterator<Item = i64>,
    ) -> Result<Vec<RackReading>, MeshError> {
        let radius = 0.5 * positive(diameter_mm)?;
        let rack = self.pair().rack();
        let nominal_beta = rack.helix_angle_rad;
        let half = 0.5 * rack.tooth_thickness_mm / trig::cos(nominal_beta);
        let (sin_n, cos_n) = trig::sin_cos(self.pair().normal_pressure_angle_rad());
        // X and Z of the centre relative to the middle of the nominal space, at a given Y
        let rest = |right: crate::deviation::RackFlank, left: crate::deviation::RackFlank, y: f64| {
            let plane = |side: f64, flank: crate::deviation::RackFlank, foot: f64| {
                let (sin_b, cos_b) = trig::sin_cos(nominal_beta + flank.lead_rad);
                let x = side * cos_b * cos_n;
                let d = x * (foot + flank.along_x_mm) + sin_n * flank.along_z_mm;
                (x, d + radius + side * sin_b * cos_n * y)
            };
            let (ra, rd) = plane(1.0, right, -0.5 * rack.pitch_mm + half);
            let (la, ld) = plane(-1.0, left, 0.5 * rack.pitch_mm - half);
            // ra x + sin z = rd, la x + sin z = ld
            let x = (rd - ld) / (ra - la);
            (x, (rd - ra * x) / sin_n)
        };
        let none = crate::deviation::RackFlank::default();
        let (_, nominal_height) = rest(none, none, 0.0);
        let quarter = 0.25 * rack.face_width_mm;
        Ok(spaces
            .into_iter()
            .map(|space| {
                let right = self.rack().tooth(space).right;
                let left = self.rack().tooth(space.saturating_add(1)).left;
                let (x, z) = rest(right, left, 0.0);
                let slope = (rest(right, left, quarter).0 - rest(right, left, -quarter).0) / (2.0 * quarter);
                let place = (space as f64 + 0.5) * rack.pitch_mm;
                RackReading {
                    space,
                    over_pin_mm: z + radius,
                    position_mm: place + x,
                    height_deviation_mm: z - nominal_height,
                    position_deviation_mm: x,
                    lead_rad: trig::atan(slope) - nominal_beta,
                }
            })
            .collect())
    }

    /// Puts a ball into every space of the pinion and reads the flanks' pitches at the reference circle.
    ///
    /// The centre lies at r_b / cos α_K with inv α_K = D/(2 r_b cos β_b) − η_b, η_b half the space's angle at the base
    /// circle. It is read relative to the tooth system's own axis, at mid-width. The radial value follows from the radius by
    /// the same relation, so it does not depend on the ball: fed back as measured data with the position, it gives the same
    /// flanks.
    ///
    /// # Errors
    /// [`MeshError::NotPositive`] unless the diameter is positive, finite, and large enough not to fall
    /// through to the base circle.
    pub fn measure_pinion(&self, diameter_mm: f64) -> Result<Vec<PinionReading>, MeshError> {
        let diameter = positive(diameter_mm)?;
        let pinion = self.pair().pinion();
        let teeth = self.pinion().teeth();
        let z = teeth.len();
        let r = pinion.reference_radius_mm;
        let ball = diameter / (2.0 * pinion.base_radius_mm * trig::cos(pinion.base_helix_angle_rad));
        let half_space = 0.5 * pinion.angular_pitch_rad() - pinion.base_half_angle_rad;
        let center = |narrower: f64| -> Result<f64, MeshError> {
            let inv = ball - (half_space - narrower);
            if inv > 0.0 && inv < 100.0 {
                let roll = roll_of_involute(inv);
                Ok(pinion.base_radius_mm * (1.0 + roll * roll).sqrt())
            } else {
                Err(MeshError::NotPositive { what: "pin", value_mm: diameter_mm })
            }
        };
        center(0.0)?;
        let tan_t = trig::tan(pinion.transverse_pressure_angle_rad);
        let evaluated = |radius_mm: f64| {
            let ratio = radius_mm / pinion.base_radius_mm;
            let roll = ((ratio - 1.0) * (ratio + 1.0)).max(0.0).sqrt();
            r * (half_space - ball + (roll - trig::atan(roll))) / tan_t
        };
        (0..pinion.teeth)
            .zip(0_usize..)
            .map(|(tooth, j)| {
                let (before, here, after) = (&teeth[(j + z - 1) % z], &teeth[j], &teeth[(j + 1) % z]);
                let radius_mm = center((here.right.arc_mm - after.left.arc_mm) / (2.0 * r))?;
                Ok(PinionReading {
                    tooth,
                    radius_mm,
                    radial_mm: evaluated(radius_mm),
                    position_mm: 0.5 * (here.right.arc_mm + after.left.arc_mm),
                    left_pitch_mm: here.left.arc_mm - before.left.arc_mm,
                    right_pitch_mm: here.right.arc_mm - before.right.arc_mm,
                })
            })
            .collect()
    }

    /// Diameter of the ball whose centre lies at the radius r_b / cos α_K with α_K = α_t, where it reads radial
    /// deviations as the mesh feels them, mm: D = 2 r_b cos β_b (inv α_t + η_b).
    #[must_use]
    pub fn pinion_ball_mm(&self) -> f64 {
        let pinion = self.pair().pinion();
        let alpha = pinion.transverse_pressure_angle_rad;
        let half_space = 0.5 * pinion.angular_pitch_rad() - pinion.base_half_angle_rad;
        let base = pinion.base_radius_mm * trig::cos(pinion.base_helix_angle_rad);
        2.0 * base * ((trig::tan(alpha) - alpha) + half_space)
    }
}

fn positive(value_mm: f64) -> Result<f64, MeshError> {
    if value_mm > 0.0 && value_mm.is_finite() {
        Ok(value_mm)
    } else {
        Err(MeshError::NotPositive { what: "pin", value_mm })
    }
}

/// The roll angle τ with τ − atan τ = `inv`, by Newton from above, where the function is convex in the other
/// direction; six steps give every digit, more do no harm.
fn roll_of_involute(inv: f64) -> f64 {
    let cube = libm::cbrt(3.0 * inv);
    let mut roll = cube.max(inv);
    for _ in 0..40 {
        let next = roll - (roll - trig::atan(roll) - inv) * (1.0 + roll * roll) / (roll * roll);
        if (next - roll).abs() <= 1e-16 * roll {
            break;
        }
        roll = next;
    }
    roll
}
