//! Pairs that several tests use.

use rackmesh::gear::{PairData, PinionData, RackData};

/// A spur pair with full depth.
pub fn spur() -> PairData {
    PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: 20.0_f64.to_radians(),
        rack: RackData { helix_angle_rad: 0.0, face_width_mm: 20.0, addendum_mm: 2.0, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 20,
            helix_angle_rad: 0.0,
            profile_shift: 0.2,
            tip_diameter_mm: 44.8,
            root_form_diameter_mm: Some(38.2),
            face_width_mm: 20.0,
            tooth_thickness_deviation_mm: 0.0,
        },
    }
}

/// The steering pair that reproduces the paper's Table 1; its contact ratio is above 2.
pub fn steering() -> PairData {
    PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: 19.9_f64.to_radians(),
        rack: RackData { helix_angle_rad: 0.0, face_width_mm: 19.7, addendum_mm: 1.70, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth: 8,
            helix_angle_rad: 21.0_f64.to_radians(),
            profile_shift: 0.3,
            tip_diameter_mm: 19.738,
            root_form_diameter_mm: None,
            face_width_mm: 30.0,
            tooth_thickness_deviation_mm: 0.0,
        },
    }
}
