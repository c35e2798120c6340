//! A virtual measuring machine closes the loop.

use super::*;

/// What a pin sees of the rack, fed back as measured, gives the same curve.
#[test]
fn the_virtual_measuring_machine_closes_the_loop() {
    let pair = table_pair();
    let list = [
        RackDeviation { teeth: from(2), kind: RackDeviationKind::Pitch(0.02) },
        RackDeviation { teeth: ToothRange::single(4).unwrap(), kind: RackDeviationKind::Thickness(-0.03) },
        RackDeviation { teeth: ToothRange::single(5).unwrap(), kind: RackDeviationKind::OverRoller(0.015) },
        RackDeviation { teeth: ToothRange::single(3).unwrap(), kind: RackDeviationKind::Left(0.01) },
    ];
    let pinion = PinionFlanks::nominal(&pair);
    let original = mesh(&pair, RackFlanks::new(&pair, &list).unwrap(), pinion.clone());
    let rows: Vec<_> = original.measure_rack(3.5, -6..16).unwrap().iter().map(|reading| reading.row()).collect();
    let measured = rack_flanks_from_spaces(&pair, &rows).unwrap();
    let again = mesh(&pair, RackFlanks::nominal(&pair).with_measured(&measured).unwrap(), pinion);
    for i in 0..200 {
        let s = f64::from(i) * 0.2;
        let (a, b) = (original.at(s).unwrap(), again.at(s).unwrap());
        assert_abs_diff_eq!(a.delta_cd_mm, b.delta_cd_mm, epsilon = 1e-12);
    }
    assert!(original.curve(0.0, 40.0, 1e-5).unwrap().summary(&original).unwrap().peak_to_peak_mm > 0.03);
}

/// Deviations of 20 to 50 µm on both parts of a helical pair, with pins that touch anywhere on the flanks.
#[test]
fn large_deviations_of_both_parts_close_the_loop() {
    for seed in 1..25 {
        let mut random = Random(seed);
        let pair = random::pair(&mut random);
        let z = i64::from(pair.pinion().teeth);
        let value = |random: &mut Random| random.range(0.02, 0.05) * if random.chance(0.5) { -1.0 } else { 1.0 };
        let single = |tooth: i64| ToothRange::single(tooth).unwrap();
        let rack: Vec<_> = (0..8)
            .map(|tooth| {
                let value = value(&mut random);
                let kind = match tooth % 5 {
                    0 => RackDeviationKind::Pitch(value),
                    1 => RackDeviationKind::Thickness(value),
                    2 => RackDeviationKind::OverRoller(value),
                    3 => RackDeviationKind::Left(value),
                    _ => RackDeviationKind::Right(value),
                };
                RackDeviation { teeth: single(tooth), kind }
            })
            .collect();
        let pinion: Vec<_> = (0..z)
            .map(|tooth| {
                let value = value(&mut random);
                let kind = match tooth % 5 {
                    0 => PinionDeviationKind::Radial(value),
                    1 => PinionDeviationKind::Shift(value),
                    2 => PinionDeviationKind::Thickness(value),
                    3 => PinionDeviationKind::Left(value),
                    _ => PinionDeviationKind::Right(value),
                };
                PinionDeviation { teeth: single(tooth), kind }
            })
            .collect();
        let original = mesh(&pair, RackFlanks::new(&pair, &rack).unwrap(), PinionFlanks::new(&pair, &pinion).unwrap());
        let m = pair.normal_module_mm();
        let pin = random.range(1.4, 2.0) * m;
        let rows: Vec<_> = original.measure_rack(pin, -20..30).unwrap().iter().map(|reading| reading.row()).collect();
        let rack = RackFlanks::nominal(&pair).with_measured(&rack_flanks_from_spaces(&pair, &rows).unwrap()).unwrap();
        let ball = original.pinion_ball_mm() * random.range(0.95, 1.2);
        let rows: Vec<_> = original.measure_pinion(ball).unwrap().iter().map(|reading| reading.row()).collect();
        let measured = pinion_flanks_from_rows(&pair, &rows).unwrap();
        let again = mesh(&pair, rack, PinionFlanks::nominal(&pair).with_measured(&measured).unwrap());
        let mut height: f64 = 0.0;
        for i in 0..60 {
            let s = f64::from(i) * 0.15 * pair.rack().pitch_mm;
            let (a, b) = (original.at(s).unwrap(), again.at(s).unwrap());
            // over-roller deviations move a flank along Z; the same flank moved along X is known to rounding
            assert!((a.delta_cd_mm - b.delta_cd_mm).abs() < 1e-10, "seed {seed}, stroke {s}: {a:?} {b:?}");
            height = height.max(a.delta_cd_mm.abs());
        }
        assert!(height > 0.03, "seed {seed}: {height}");
    }
}
