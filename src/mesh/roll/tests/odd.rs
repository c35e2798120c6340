//! Pairs that nobody would build, whose racks balance at few rolls or none.

use super::*;

/// Pairs that nobody would build: flanks of 2° to 4°, helices that do not fit, form, lead errors of the pinion, and faces
/// of 136 modules on which those are three teeth.
pub(in crate::mesh) fn pairs() -> [Mesh; 4] {
    let odd = |data: &PairData, lead: f64, [rack_crowning, relief, pinion_crowning, slope]: [f64; 4], depth: f64| {
        let pair = Pair::new(data).expect("a valid pair");
        let form = RackForm { crowning_mm: rack_crowning, tip_relief_mm: relief, tip_relief_start_mm: 0.0 };
        let rack = RackFlanks::nominal(&pair).with_form(&pair, form).expect("small");
        let form = PinionForm { crowning_mm: pinion_crowning, profile_slope_mm: slope };
        let lead = PinionDeviation { teeth: ToothRange::ALL, kind: PinionDeviationKind::Lead(lead) };
        let pinion = PinionFlanks::new(&pair, &[lead]).and_then(|pinion| pinion.with_form(form)).expect("small");
        Mesh::new(pair, rack, pinion, Support::FreeRoll { axis_depth_mm: depth }).expect("teeth in order")
    };
    let rack = |helix_angle_rad, face_width_mm, addendum_mm| RackData {
        helix_angle_rad,
        face_width_mm,
        addendum_mm,
        tooth_thickness_mm: None,
    };
    let overhanging = PairData {
        normal_module_mm: 0.4212,
        normal_pressure_angle_rad: 0.03436,
        rack: rack(0.409, 16.4, 0.088),
        pinion: PinionData {
            teeth: 63,
            helix_angle_rad: 0.767,
            profile_shift: -0.88,
            tip_diameter_mm: 37.26,
            root_form_diameter_mm: None,
            face_width_mm: 22.9,
            tooth_thickness_deviation_mm: -0.117,
        },
    };
    let few_teeth = PairData {
        normal_module_mm: 0.872,
        normal_pressure_angle_rad: 0.0688,
        rack: rack(-0.714, 34.4, 1.203),
        pinion: PinionData {
            teeth: 5,
            helix_angle_rad: -0.188,
            profile_shift: -0.0986,
            tip_diameter_mm: 5.898,
            root_form_diameter_mm: None,
            face_width_mm: 48.3,
            tooth_thickness_deviation_mm: 0.064,
        },
    };
    let wide = PairData {
        normal_module_mm: 0.33,
        normal_pressure_angle_rad: 0.03,
        rack: rack(-0.2327, 57.2, 0.3305),
        pinion: PinionData {
            teeth: 32,
            helix_angle_rad: 0.5554,
            profile_shift: -0.3386,
            tip_diameter_mm: 13.23,
            root_form_diameter_mm: None,
            face_width_mm: 52.7,
            tooth_thickness_deviation_mm: -0.051,
        },
    };
    let fine = PairData {
        normal_module_mm: 0.12,
        normal_pressure_angle_rad: 0.1354,
        rack: rack(0.632, 16.3, 0.104),
        pinion: PinionData {
            teeth: 119,
            helix_angle_rad: 0.5637,
            profile_shift: 0.685,
            tip_diameter_mm: 17.2,
            root_form_diameter_mm: None,
            face_width_mm: 55.9,
            tooth_thickness_deviation_mm: -0.095,
        },
    };
    [
        odd(&overhanging, 0.0, [0.0267, 0.0468, 0.0, 0.0], 15.1),
        odd(&few_teeth, 0.0, [0.0107, 0.0062, 0.0284, -0.0131], 12.5),
        odd(&wide, 0.02, [0.0084, 0.0275, 0.0118, -0.0177], 18.9),
        odd(&fine, 0.022, [0.0, 0.0, 0.0, 0.0], 13.1),
    ]
}

/// Where the rack rolls, flat demands need long steps of the rotation, and rolls at which no rotation balances both sides
/// are given up soon.
#[test]
fn rolls_of_odd_pairs_are_solved_in_few_rotations() {
    for (mesh, (most, settled)) in pairs().iter().zip([(1220, 52), (1200, 83), (6600, 78)]) {
        let Support::FreeRoll { axis_depth_mm } = mesh.support() else { unreachable!() };
        let mut sampler = Sampler::new(mesh);
        let (mut solved, mut found, mut given_up) = (0, 0, 0);
        for stroke in [0.0, 1.3, 5.7, 31.4] {
            for step in -10..=10 {
                let Ok(here) = sampler.at_roll(stroke, 0.0071 * f64::from(step), axis_depth_mm) else { continue };
                solved += 1;
                found += usize::from(here.point.converged());
                given_up += usize::from(here.point.ending == Ending::Unbalanced);
            }
        }
        let rotations = sampler.work().rotations;
        println!("{rotations} rotations at {solved} rolls, {found} converged, {given_up} given up");
        assert!(solved == 84 && rotations <= most && found >= settled, "{rotations} {solved} {found}");
        assert!(found + given_up >= 80, "{found} {given_up}");
    }
}

/// Of flanks that overhang when the rack rolls, no rotation balances both sides at most rolls: that asks for no centre
/// distance, and the lowest of the others is found.
#[test]
fn a_search_among_rolls_without_balance_finds_one_with() {
    let [mesh, ..] = pairs();
    let mut converged = 0;
    for step in 0..8 {
        let stroke = 0.5 * f64::from(step);
        let mut sampler = Sampler::new(&mesh);
        let point = sampler.at(stroke).expect("something is found");
        assert!(point.residual_mm.abs() < 1e-12 && point.delta_cd_mm.abs() < 2.0, "{point:?}");
        assert!(sampler.work().searched < MAX_SEARCHES, "{}", sampler.work().searched);
        converged += usize::from(point.converged());
    }
    println!("{converged} converged");
    assert!(converged >= 6, "{converged}");
}

/// Where no roll has a balance, and an unrolled rack carries the pinion on its tips, that is what is wrong.
#[test]
fn teeth_that_enter_at_no_roll_are_said_to() {
    let [.., mesh] = pairs();
    for step in 0..4 {
        let mut sampler = Sampler::new(&mesh);
        let found = sampler.at(0.11 * f64::from(step));
        assert!(matches!(found, Err(MeshError::TipOnTip { .. })), "{found:?}");
        let searched = sampler.work().searched;
        assert!(searched < MAX_SEARCHES / 2, "{searched}");
    }
}

/// The slope of a rack that is hardly rolled is that at the centre distance that follows, whatever was assumed first.
#[test]
fn the_slope_at_the_smallest_rolls_does_not_depend_on_what_was_assumed() {
    let (mut compared, mut largest) = (0, 0.0_f64);
    for mesh in pairs() {
        let Support::FreeRoll { axis_depth_mm } = mesh.support() else { unreachable!() };
        for (step, angle) in (0..12).flat_map(|step| [0.0, -5e-9, 5e-9].map(|angle| (step, angle))) {
            let (stroke, mut sampler) = (1.3 * f64::from(step), Sampler::new(&mesh));
            let Ok(fresh) = sampler.at_roll(stroke, angle, axis_depth_mm) else { continue };
            let Ok(again) = sampler.at_roll(stroke, angle, axis_depth_mm) else { continue };
            if fresh.point.converged() && again.point.converged() && fresh.rolling.at == again.rolling.at {
                compared += 1;
                largest = largest.max((fresh.slope - again.slope).abs() / fresh.slope.abs().max(1.0));
            }
        }
    }
    println!("{compared} slopes, largest difference {largest:e}");
    assert!(compared > 60 && largest < 0.01, "{compared} {largest}");
}

/// Thick teeth and wide faces, an eccentric pinion: the rack meshes where it is hardly rolled, and where it is rolled so far
/// that it carries at one end of its face, but not, or higher, in between.
#[test]
fn a_rack_that_meshes_when_hardly_rolled_is_found() {
    let large = PairData {
        normal_module_mm: 2.832,
        normal_pressure_angle_rad: 0.117,
        rack: RackData {
            helix_angle_rad: 0.0,
            face_width_mm: 45.9,
            addendum_mm: 4.147,
            tooth_thickness_mm: Some(7.227),
        },
        pinion: PinionData {
            teeth: 99,
            helix_angle_rad: 0.2038,
            profile_shift: 0.5327,
            tip_diameter_mm: 290.03,
            root_form_diameter_mm: Some(285.65),
            face_width_mm: 42.1,
            tooth_thickness_deviation_mm: 0.013,
        },
    };
    let flat = PairData {
        normal_module_mm: 1.343,
        normal_pressure_angle_rad: 0.5872,
        rack: RackData {
            helix_angle_rad: 0.0566,
            face_width_mm: 18.68,
            addendum_mm: 0.23,
            tooth_thickness_mm: Some(3.968),
        },
        pinion: PinionData {
            teeth: 39,
            helix_angle_rad: 0.4128,
            profile_shift: -0.3429,
            tip_diameter_mm: 57.69,
            root_form_diameter_mm: Some(52.226),
            face_width_mm: 12.12,
            tooth_thickness_deviation_mm: -0.184,
        },
    };
    for (data, depth, amount_mm, strokes) in
        [(large, 9.479, 0.12, [22.656, 39.648]), (flat, 4.711, 0.174, [10.744, 40.29])]
    {
        let pair = Pair::new(&data).expect("a valid pair");
        let pinion = PinionFlanks::new(&pair, &[PinionDeviation::eccentricity(amount_mm, 0)]);
        let support = Support::FreeRoll { axis_depth_mm: depth };
        let mesh = Mesh::new(pair, RackFlanks::nominal(&pair), pinion.expect("small"), support).expect("in order");
        for stroke in strokes {
            let mut sampler = Sampler::new(&mesh);
            let point = sampler.at(stroke).expect("contact");
            assert!(point.converged() && point.roll_rad.abs() < 5e-3, "{point:?}");
            // two rotations may hold so odd a pair: where one gives way to the other the centre distance bends down, which
            // no bound expects, and up to 3 µm are missed; without the unrolled rack 90 µm and more would be
            for step in -40..=40 {
                let Ok(here) = sampler.at_roll(stroke, 2e-4 * f64::from(step), depth) else { continue };
                let lower = point.center_distance_mm - here.value;
                assert!(!here.point.converged() || lower < 2e-3, "{lower} at {}: {point:?}", here.angle);
            }
        }
    }
}
