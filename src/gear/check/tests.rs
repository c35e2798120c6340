use super::*;
use crate::gear::{PairData, PinionData, RackData};

/// A pair of module 2 with tan α_n = 1/2, so that the gain 1 / (2 tan α_n) is 1.
pub(crate) fn example(teeth: u32, rack_helix: f64, pinion_helix: f64) -> PairData {
    let diameter = 2.0 * f64::from(teeth) / trig::cos(pinion_helix);
    PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: trig::atan(0.5),
        rack: RackData { helix_angle_rad: rack_helix, face_width_mm: 20.0, addendum_mm: 1.9, tooth_thickness_mm: None },
        pinion: PinionData {
            teeth,
            helix_angle_rad: pinion_helix,
            profile_shift: 0.2,
            tip_diameter_mm: diameter + 4.6,
            root_form_diameter_mm: Some(diameter - 1.8),
            face_width_mm: 26.0,
            tooth_thickness_deviation_mm: 0.0,
        },
    }
}

fn near(value: f64, expected: f64) {
    assert!((value - expected).abs() < 1e-12 * expected.abs().max(1.0), "{value} {expected}");
}

fn pair(data: &PairData) -> Pair {
    Pair::new(data).expect("a valid pair")
}

/// A spur pair of α = 20° whose involute starts below the rack's tip.
fn spur() -> PairData {
    let mut data = PairData { normal_pressure_angle_rad: trig::atan(0.363_970_234_266_202_4), ..example(20, 0.0, 0.0) };
    data.pinion.root_form_diameter_mm = Some(37.8);
    data
}

#[test]
fn the_gain_and_the_undercut_limit() {
    // 3, 4 and 5 are the sides of the pressure angle's triangle
    let mut data = PairData { normal_pressure_angle_rad: trig::atan(0.75), ..example(20, 0.0, 0.0) };
    data.pinion.tip_diameter_mm = 43.6;
    data.pinion.root_form_diameter_mm = Some(37.0);
    near(pair(&data).gain(), 2.0 / 3.0);
    near(pair(&data).undercut_limit(), (1.9 - 20.0 * 0.36) / 2.0);
    assert_eq!(pair(&data).warnings(), []);
    // at the limit there is no undercut yet
    data = PairData { pinion: PinionData { teeth: 8, root_form_diameter_mm: None, ..data.pinion }, ..spur() };
    data.pinion.tip_diameter_mm = 20.6;
    let limit = pair(&data).undercut_limit();
    data.pinion.profile_shift = limit;
    assert!(!pair(&data).warnings().iter().any(|found| matches!(found, GeometryWarning::Undercut { .. })));
    data.pinion.profile_shift = limit - 0.01;
    let found = pair(&data).warnings();
    let expected = GeometryWarning::Undercut { profile_shift: limit - 0.01, limit };
    assert!(found.contains(&expected), "{found:?}");
}

/// The path of contact from where the rack's tip meets the line of action to the pinion's tip.
#[test]
fn the_contact_ratio_of_a_spur_pair() {
    let (data, (sin, cos)) = (spur(), (0.342_020_143_325_668_7, 0.939_692_620_785_908_4));
    let (r, r_a) = (20.0, 22.3);
    let r_b = r * cos;
    let above = f64::sqrt(r_a * r_a - r_b * r_b) - r * sin;
    let below = (1.9 - 0.2 * 2.0) / sin;
    let ratio = pair(&data).contact_ratio();
    let base_pitch = std::f64::consts::PI * 2.0 * cos;
    near(ratio.transverse, (above + below) / base_pitch);
    // a quarter pitch from the tooth's centre to its flank at the reference plane, x m_n below the pitch point
    near(ratio.offset, 0.25 + (0.5 * (above - below) - 0.2 * 2.0 * sin) / base_pitch);
    assert_eq!((ratio.overlap, ratio.total), (0.0, ratio.transverse));
    assert_eq!(pair(&data).warnings(), []);
    // flanks that end at the pitch line
    let mut low = data;
    low.rack.addendum_mm = 0.5;
    low.pinion.tip_diameter_mm = 41.0;
    let found = pair(&low).warnings();
    assert!(matches!(found[0], GeometryWarning::LowContactRatio { total, .. } if total > 0.0 && total < 1.0));
}

/// The pair with which the paper's tables are reproduced, β_r = 0, held against every point of its field of contact:
/// s/p_x = 1/4 + (−a_0 sin α_n + r_b τ cos β_b − w sin β_b) / (p_x cos α_n).
#[test]
fn the_path_of_contact_of_the_papers_pair() {
    let paper = crate::reproduction::pair().expect("a valid pair");
    let p = *paper.pinion();
    let (sin_n, cos_n) = trig::sin_cos(paper.normal_pressure_angle_rad());
    let (sin_b, cos_b) = trig::sin_cos(p.base_helix_angle_rad);
    let (sin_t, cos_t) = trig::sin_cos(p.transverse_pressure_angle_rad);
    let (sin_s, cos_s) = trig::sin_cos(paper.shaft_angle_rad());
    let (a, r_b, pitch) = (paper.nominal_center_distance_mm(), p.base_radius_mm, paper.rack().pitch_mm);
    let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
    for i in 0..=1000 {
        for j in -1000..=1000 {
            let (roll, w) = (p.tip_roll_rad * f64::from(i) / 1000.0, p.face_width_mm * f64::from(j) / 2000.0);
            let y = r_b * (roll * cos_t - sin_t) * sin_s + w * cos_s;
            let z = a - r_b * (cos_t + roll * sin_t);
            if y.abs() <= 0.5 * paper.rack().face_width_mm && z <= paper.rack().addendum_mm {
                let stroke = 0.25 + (-a * sin_n + r_b * roll * cos_b - w * sin_b) / (pitch * cos_n);
                (first, last) = (first.min(stroke), last.max(stroke));
            }
        }
    }
    let ratio = paper.contact_ratio();
    for (end, searched) in [(ratio.offset - 0.5 * ratio.total, first), (ratio.offset + 0.5 * ratio.total, last)] {
        assert!((end - searched).abs() < 3e-3, "{ratio:?} {first} {last}");
    }
}

/// A mirror that changes both hands leaves right flanks right and strokes as they are.
#[test]
fn a_mirrored_pair_has_the_same_path_of_contact() {
    for (rack, pinion) in [(-0.3, 0.4), (0.2, 0.3), (0.0, 0.4), (-0.35, 0.35)] {
        let ratio = pair(&example(20, rack, pinion)).contact_ratio();
        let mirrored = pair(&example(20, -rack, -pinion)).contact_ratio();
        near(mirrored.offset, ratio.offset);
        near(mirrored.total, ratio.total);
    }
}

/// On parallel axes the overlap is the narrower face width over p_t / tan β.
#[test]
fn the_overlap_of_a_helical_pair() {
    let helix = 0.35;
    for (rack, pinion) in [(12.0, 26.0), (30.0, 26.0)] {
        let mut data = PairData { normal_pressure_angle_rad: 0.35, ..example(20, -helix, helix) };
        (data.rack.face_width_mm, data.pinion.face_width_mm) = (rack, pinion);
        let ratio = pair(&data).contact_ratio();
        near(ratio.overlap, f64::min(rack, pinion) * trig::sin(helix) / (2.0 * std::f64::consts::PI));
        near(ratio.total, ratio.transverse + ratio.overlap);
    }
}

/// On crossed axes the ends of a narrow rack bound the contact instead: a point of contact moves along the rack by
/// r_b cos α_t sin Σ per rad of roll.
#[test]
fn a_narrow_rack_on_crossed_axes() {
    let mut data = PairData { normal_pressure_angle_rad: 0.35, ..example(20, 0.0, 0.4) };
    let wide = pair(&data).contact_ratio();
    data.rack.face_width_mm = 2.0;
    let narrow = pair(&data).contact_ratio();
    assert!(narrow.total < wide.total && narrow.total > 1.0, "{narrow:?} {wide:?}");
    // the ends of what a search finds; a narrow pinion bounds them, too
    for pinion_width in [26.0, 3.0] {
        data.pinion.face_width_mm = pinion_width;
        let narrow = pair(&data).contact_ratio();
        let p = *pair(&data).pinion();
        let (sin_t, cos_t) = trig::sin_cos(p.transverse_pressure_angle_rad);
        let (sin_s, cos_s) = trig::sin_cos(pair(&data).shaft_angle_rad());
        let low = pair(&data).rack_tip_roll_rad().max(p.start_roll_rad);
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..=2000 {
            let tau = low + (p.tip_roll_rad - low) * f64::from(i) / 2000.0;
            // |y| ≤ 1 and |w| ≤ b/2
            let shift = p.base_radius_mm * (tau * cos_t - sin_t) * sin_s;
            let first = ((-1.0 - shift) / cos_s).max(-0.5 * pinion_width);
            let last = ((1.0 - shift) / cos_s).min(0.5 * pinion_width);
            for w in [first, last] {
                if first <= last {
                    let phase = tau - trig::tan(p.helix_angle_rad) / p.reference_radius_mm * w;
                    (least, most) = (least.min(phase), most.max(phase));
                }
            }
        }
        let searched = (most - least) / p.angular_pitch_rad();
        assert!(searched > 0.1 && (narrow.total - searched).abs() < 2e-3, "{narrow:?} {searched}");
    }
}

#[test]
fn interference_is_as_deep_as_the_tip_lies_below_the_involute() {
    let mut data = spur();
    data.pinion.root_form_diameter_mm = Some(39.0);
    let found = pair(&data).warnings();
    let (sin, cos) = (0.342_020_143_325_668_7, 0.939_692_620_785_908_4);
    let start = f64::sqrt(19.5 * 19.5 - 400.0 * cos * cos);
    let lowest = 0.2 * 2.0 + 20.0 * sin * sin - start * sin;
    let [GeometryWarning::TipInterference { depth_mm, root_form_diameter_mm }] = found[..] else { panic!("{found:?}") };
    near(depth_mm, 1.9 - lowest);
    near(root_form_diameter_mm, 39.0);
}

#[test]
fn steep_flanks_and_thin_tips() {
    let mut data = PairData { normal_pressure_angle_rad: trig::atan(0.1), ..example(20, 0.0, 0.0) };
    data.pinion.root_form_diameter_mm = None;
    let found = pair(&data).warnings();
    let sensitive = found.iter().find_map(|found| match found {
        GeometryWarning::Sensitive { normal_pressure_angle_deg, gain } => Some((*normal_pressure_angle_deg, *gain)),
        _ => None,
    });
    let (degrees, gain) = sensitive.expect("steep flanks");
    near(gain, 5.0);
    assert!((degrees - 5.710_593_137_499_643).abs() < 1e-9);

    let mut data = PairData { normal_pressure_angle_rad: 0.35, ..example(20, 0.0, 0.4) };
    data.pinion.tip_diameter_mm += 2.2;
    let found = pair(&data).warnings();
    let thin = found.iter().find_map(|found| match found {
        GeometryWarning::NearlyPointed { tip_thickness_mm, limit_mm } => Some((*tip_thickness_mm, *limit_mm)),
        _ => None,
    });
    let (thickness, limit) = thin.unwrap_or_else(|| panic!("{found:?} {}", pair(&data).pinion().tip_thickness_mm()));
    // normal to the helix at the tip circle
    let p = *pair(&data).pinion();
    let tip_helix = trig::atan(p.tip_radius_mm / p.reference_radius_mm * trig::tan(0.4));
    near(thickness, p.tip_thickness_mm() * trig::cos(tip_helix));
    near(limit, 0.4);
}

/// The half plane x ≤ 1 leaves the left half of the square from 0 to 2; a corner on the line stays once.
#[test]
fn clipping_a_square() {
    let square = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)];
    assert_eq!(clip(&square, |(x, _)| 1.0 - x, between), [(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)]);
    assert_eq!(clip(&square, |(x, y)| 2.0 - x - y, between), [(0.0, 0.0), (2.0, 0.0), (0.0, 2.0)]);
    assert_eq!(clip(&square, |(x, y)| x - 2.0 * y, between), [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0)]);
    assert_eq!(clip(&square, |_| -1.0, between), []);
}
