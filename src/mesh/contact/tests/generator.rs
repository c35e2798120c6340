//! One generator, where it runs along the rack or nearly so.

use super::*;

/// A generator that runs along the rack lies over it or beside it as a whole, by a gap that only δ can close.
#[test]
fn a_generator_along_the_rack_is_over_it_or_not() {
    let (sin_nu, cos_nu) = trig::sin_cos(0.35);
    let contact = FlankContact {
        base_radius: 20.0,
        kappa: 0.01,
        tip_roll: 0.6,
        half_face: 10.0,
        across: Across { t: 0.0, w: 0.0, z: 1.0, half_width: 5.0 },
        nu: 0.35,
        sin_nu,
        cos_nu,
        ..FlankContact::default()
    };
    // of the whole generator at γ = 0, ζ = −r_b
    let pose = |across: f64| Pose {
        c: 0.1,
        shift: 0.0,
        offset: (0.0, 0.0),
        offset_rate: (0.0, 0.0),
        across: contact.base_radius + across,
    };
    let gap = |across: f64, delta: f64| {
        let pose = pose(across);
        let at = contact.coordinates(&pose, delta);
        contact.edges(&pose, &at)[1].map(|(low, high)| (high.w - low.w, high.slope - low.slope))
    };
    for side in [1.0, -1.0] {
        assert_eq!(gap(side * 4.9, -0.35), None);
        let (missed, slope) = gap(side * 5.5, -0.35).expect("it lies beside the rack");
        assert!((missed + 0.5).abs() < 1e-12, "{missed}");
        // with a generator a little further, which runs along the rack too but for the second order
        let h = 1e-14;
        let (further, _) = gap(side * 5.5, -0.35 + h).expect("it lies beside the rack");
        assert!(((further - missed) / h - slope).abs() < 1.0, "{slope}");
        assert!((slope - side * 20.0 * contact.coordinates(&pose(0.0), -0.35).t0).abs() < 1e-9, "{slope}");
    }
}

/// Whether a generator crosses the rack at all hangs on how far it gets over the pinion's whole face. If it does not, the
/// gap to the rack's face is all that is said of it, whatever else ends it.
#[test]
fn what_crosses_the_rack_by_rounding_runs_along_it() {
    let (sin_nu, cos_nu) = trig::sin_cos(0.35);
    for (half_face, half_width) in [(10.0, 5.0), (0.1, 5.0), (10.0, 0.2)] {
        for (share, crosses) in [(0.9, false), (1.1, true)] {
            let contact = FlankContact {
                base_radius: 20.0,
                kappa: 0.01,
                tip_roll: 0.6,
                half_face,
                across: Across { w: share * 1e-12 * half_width / half_face, half_width, ..Across::default() },
                nu: 0.35,
                sin_nu,
                cos_nu,
                ..FlankContact::default()
            };
            let pose = |across: f64| Pose { c: 0.25, shift: 0.0, offset: (0.0, 0.0), offset_rate: (0.0, 0.0), across };
            let over = pose(0.0);
            assert_eq!(contact.edges(&over, &contact.coordinates(&over, 0.0))[1].is_some(), crosses, "{half_face}");
            // though the involute begins at w = 5
            let beside = pose(half_width + 0.03);
            if !crosses && let Generator::None { gap, .. } = contact.demand(&beside, -0.15) {
                assert!((gap + 0.03).abs() < 1e-12, "{gap}");
            } else {
                assert!(crosses);
            }
        }
    }
}
