//! The numbers of a drawing, unchecked. Read by [`Pair::new`](super::Pair::new) only.

/// A rack and pinion as a drawing gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairData {
    /// Normal module m_n, mm.
    pub normal_module_mm: f64,
    /// Normal pressure angle α_n, rad.
    pub normal_pressure_angle_rad: f64,
    /// The rack.
    pub rack: RackData,
    /// The pinion.
    pub pinion: PinionData,
}

/// A rack as a drawing gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RackData {
    /// Helix angle β_r, right hand positive, rad.
    pub helix_angle_rad: f64,
    /// Face width k, across the rack along Y, mm.
    pub face_width_mm: f64,
    /// Addendum: height of the tip plane above the reference plane, mm.
    pub addendum_mm: f64,
    /// Normal tooth thickness s_n at the reference plane, mm; π m_n / 2 if not given.
    pub tooth_thickness_mm: Option<f64>,
}

/// A pinion as a drawing gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinionData {
    /// Number of teeth z.
    pub teeth: u32,
    /// Helix angle β_p at the reference cylinder, right hand positive, rad.
    pub helix_angle_rad: f64,
    /// Profile shift coefficient x, in units of m_n.
    pub profile_shift: f64,
    /// Tip diameter d_a, mm.
    pub tip_diameter_mm: f64,
    /// Root form diameter, at which the involute ends towards the root, mm; the base diameter if not given or smaller.
    pub root_form_diameter_mm: Option<f64>,
    /// Face width b along the axis, mm.
    pub face_width_mm: f64,
    /// Transverse tooth thickness at the reference circle less its nominal value, mm.
    pub tooth_thickness_deviation_mm: f64,
}
