//! Check values of public sources, known wrong variants, and the edges of ranges and rounding.

use super::*;

fn wheel(module: &str, diameter: &str, face_width: &str, teeth: u32) -> Wheel {
    Wheel {
        normal_module: Some(module.parse().unwrap()),
        diameter: Some(diameter.parse().unwrap()),
        face_width: Some(face_width.parse().unwrap()),
        teeth: Some(teeth),
        helix_angle: None,
    }
}

const ISO_1995: Standard = Standard::Iso1328Part1Of1995;
const ISO_1997: Standard = Standard::Iso1328Part2Of1997;
const ISO_2013: Standard = Standard::Iso1328Part1Of2013;
const DIN: Standard = Standard::Din3962;
const JIS: Standard = Standard::JisB1702Of1976;

fn rounded(standard: Standard, deviation: Deviation, grade: u8, wheel: &Wheel) -> f64 {
    standard.permissible(deviation, grade, wheel).unwrap().value_um()
}

fn unrounded(standard: Standard, deviation: Deviation, grade: u8, wheel: &Wheel) -> f64 {
    standard.permissible(deviation, grade, wheel).unwrap().unrounded_um()
}

/// Two wheels in the printed reports of a commercial gear program, grade 6.
#[test]
fn printed_reports_of_the_1995_and_1997_editions() {
    use Deviation as D;
    for (size, printed) in [
        (wheel("21", "378", "550", 18), [18, 28, 21, 17, 27, 21, 29, 54, 43, 133, 89]),
        (wheel("14", "341.183", "360", 24), [14, 26, 18, 15, 23, 18, 25, 50, 40, 101, 60]),
    ] {
        let deviations = [
            (ISO_1995, D::SinglePitch),
            (ISO_1995, D::SectorPitch),
            (ISO_1995, D::ProfileForm),
            (ISO_1995, D::ProfileSlope),
            (ISO_1995, D::TotalProfile),
            (ISO_1995, D::HelixForm),
            (ISO_1995, D::TotalHelix),
            (ISO_1995, D::TotalPitch),
            (ISO_1997, D::Runout),
            (ISO_1997, D::RadialComposite),
            (ISO_1997, D::ToothRadialComposite),
        ];
        for ((standard, deviation), printed) in deviations.into_iter().zip(printed) {
            let value = standard.permissible(deviation, 6, &size).unwrap();
            assert_eq!(value.value_um(), f64::from(printed), "{}", value.symbol());
            // the module of both lies outside the ranges of the composite deviations, and that is said
            let outside = Remark::ActualSizeOutsideRanges(Size::NormalModule);
            let composite = matches!(deviation, D::RadialComposite | D::ToothRadialComposite);
            assert_eq!(value.remarks.contains(&outside), composite, "{}", value.symbol());
        }
        assert_eq!(rounded(ISO_1995, D::HelixSlope, 6, &size), rounded(ISO_1995, D::HelixForm, 6, &size));
    }
}

#[test]
fn check_values_of_the_2013_edition() {
    use Deviation as D;
    let size = wheel("2", "100", "20", 50);
    for (deviation, value) in [
        (D::SinglePitch, 6.0),
        (D::TotalPitch, 19.0),
        (D::ProfileForm, 6.0),
        (D::TotalProfile, 8.0),
        (D::HelixSlope, 6.0),
        (D::HelixForm, 6.5),
        (D::TotalHelix, 9.0),
    ] {
        assert_eq!(rounded(ISO_2013, deviation, 5, &size), value, "{deviation}");
    }
    assert_eq!(rounded(ISO_2013, D::Runout, 8, &wheel("2.54", "81.28", "20", 32)), 48.0);
}

#[test]
fn cells_of_din_3962() {
    use Deviation as D;
    for (deviation, quality, size, value) in [
        (D::TotalHelix, 5, wheel("3", "60", "20", 20), 7.0),
        (D::HelixSlope, 7, wheel("3", "60", "20.001", 20), 13.0),
        (D::HelixForm, 8, wheel("3", "60", "100", 20), 18.0),
        (D::HelixForm, 5, wheel("3", "60", "4", 20), 4.5),
        (D::TotalHelix, 8, wheel("3", "60", "40", 20), 20.0),
        (D::SinglePitch, 4, wheel("1.9", "14.675", "30", 7), 3.5),
        (D::SinglePitch, 4, wheel("2", "10", "30", 7), 3.0),
        (D::SinglePitch, 6, wheel("1.0001", "125", "30", 7), 7.0),
        (D::TotalPitch, 6, wheel("1.9", "14.675", "30", 7), 18.0),
        (D::TotalPitch, 1, wheel("1.9", "10", "30", 7), 2.5),
    ] {
        let given = DIN.permissible(deviation, quality, &size).unwrap();
        assert_eq!(given.value_um(), value, "{deviation} {quality}");
        assert_eq!(given.unrounded_um(), given.value_um());
    }
    for (deviation, quality, size) in [
        (D::TotalHelix, 9, wheel("3", "60", "20", 20)),
        (D::TotalHelix, 4, wheel("3", "60", "20", 20)),
        (D::TotalHelix, 5, wheel("3", "60", "100.0001", 20)),
        (D::TotalHelix, 5, wheel("3", "60", "0", 20)),
        (D::SinglePitch, 7, wheel("1.9", "14.675", "30", 7)),
        (D::SinglePitch, 5, wheel("1", "14.675", "30", 7)),
        (D::SinglePitch, 5, wheel("2.0001", "14.675", "30", 7)),
        (D::SinglePitch, 5, wheel("2", "125.0001", "30", 7)),
        (D::TotalPitch, 5, wheel("2", "50.0001", "30", 7)),
    ] {
        let error = DIN.permissible(deviation, quality, &size).unwrap_err();
        assert!(matches!(error, StandardError::Unconfirmed { .. }), "{error}");
    }
}

#[test]
fn jis_is_a_line_in_its_tolerance_unit() {
    // ∛64 + 0.65 · 2 = 5.3
    let size = wheel("2", "64", "20", 32);
    for (grade, value) in [(0, 4.05), (1, 5.763), (2, 8.1), (3, 11.42), (4, 16.2), (6, 32.4), (7, 64.8), (8, 129.8)] {
        assert_eq!(unrounded(JIS, Deviation::SinglePitch, grade, &size), value);
    }
    assert_eq!(unrounded(JIS, Deviation::TotalPitch, 0, &size), 16.2);
    assert!(matches!(JIS.permissible(Deviation::SinglePitch, 9, &size), Err(StandardError::Grade { .. })));
    assert!(matches!(JIS.permissible(Deviation::TotalHelix, 4, &size), Err(StandardError::NoSuchDeviation { .. })));
}

/// Variants that circulate and are wrong; each differs from what is computed here.
#[test]
fn known_wrong_variants_are_not_computed() {
    use Deviation as D;
    let size = wheel("21", "378", "550", 18);
    // F_pk with the grade's factor applied to f_pt before it is applied to the sum: 18.1 + … instead of 28
    let single = unrounded(ISO_1995, D::SinglePitch, 6, &size);
    let sector = unrounded(ISO_1995, D::SectorPitch, 6, &size);
    let root_two = std::f64::consts::SQRT_2;
    let twice = (single + 1.6 * 20_f64.sqrt()) * root_two;
    assert!((twice - sector).abs() > 5.0);
    assert!((sector - (single + 1.6 * 20_f64.sqrt() * root_two)).abs() < 1e-8);
    // f_Hα of 2013 without 0.001 d
    let large = wheel("2", "4000", "20", 100);
    assert_eq!(unrounded(ISO_2013, D::ProfileSlope, 5, &large), 8.8);
    // f_Hβ of 2013 with the coefficients of f_fβ
    let square = wheel("2", "100", "16", 50);
    assert_eq!(unrounded(ISO_2013, D::HelixSlope, 5, &square), 5.9);
    assert_eq!(unrounded(ISO_2013, D::HelixForm, 5, &square), 6.5);
    // totals are made of unrounded parts
    let parts = wheel("1.5", "900", "20", 50);
    let (form, slope) =
        (unrounded(ISO_2013, D::ProfileForm, 5, &parts), unrounded(ISO_2013, D::ProfileSlope, 5, &parts));
    let total = unrounded(ISO_2013, D::TotalProfile, 5, &parts);
    assert!((total - (form * form + slope * slope).sqrt()).abs() < 1e-8);
}

#[test]
fn a_size_on_the_limit_of_a_range_is_in_the_lower_one() {
    use Deviation as D;
    let range = |deviation: D, size: Size, wheel: &Wheel| {
        let value = ISO_1995.permissible(deviation, 5, wheel).unwrap();
        let used = value.ranges.iter().find(|used| used.size == size).unwrap().clone();
        used.range.map(|range| (range.over, range.up_to))
    };
    for (module, expected) in
        [("0.5", (0.5, 2.0)), ("2", (0.5, 2.0)), ("2.0000000001", (2.0, 3.5)), ("70", (40.0, 70.0))]
    {
        assert_eq!(range(D::SinglePitch, Size::NormalModule, &wheel(module, "30", "20", 9)), Some(expected));
    }
    for (diameter, expected) in
        [("5", (5.0, 20.0)), ("20.0", (5.0, 20.0)), ("20.001", (20.0, 50.0)), ("10000", (8000.0, 1e4))]
    {
        assert_eq!(range(D::SinglePitch, Size::Diameter, &wheel("2", diameter, "20", 9)), Some(expected));
    }
    for (width, expected) in [("4", (4.0, 10.0)), ("40", (20.0, 40.0)), ("1000", (650.0, 1000.0))] {
        assert_eq!(range(D::TotalHelix, Size::FaceWidth, &wheel("2", "30", width, 9)), Some(expected));
    }
}

#[test]
fn outside_the_scope_is_an_error_that_names_the_bound() {
    use Deviation as D;
    let message = |standard: Standard, deviation, grade, wheel: &Wheel| {
        standard.permissible(deviation, grade, wheel).unwrap_err().to_string()
    };
    let good = wheel("2", "30", "20", 15);
    for (standard, deviation, size, expected) in [
        (
            ISO_1995,
            D::SinglePitch,
            wheel("0.49", "30", "20", 15),
            "the normal module m_n is 0.49 mm; ISO 1328-1:1995 covers 0.5 to 70 mm",
        ),
        (
            ISO_1995,
            D::TotalPitch,
            wheel("2", "10000.1", "20", 15),
            "the reference diameter d is 10000.1 mm; ISO 1328-1:1995 covers 5 to 10000 mm",
        ),
        (
            ISO_1995,
            D::TotalHelix,
            wheel("2", "30", "3.99", 15),
            "the face width b is 3.99 mm; ISO 1328-1:1995 covers 4 to 1000 mm",
        ),
        (
            ISO_1997,
            D::Runout,
            wheel("71", "30", "20", 15),
            "the normal module m_n is 71 mm; ISO 1328-2:1997 covers 0.5 to 70 mm",
        ),
        (
            ISO_2013,
            D::SinglePitch,
            wheel("2", "4.9", "20", 15),
            "the reference diameter d is 4.9 mm; ISO 1328-1:2013 covers 5 to 15000 mm",
        ),
        (
            ISO_2013,
            D::TotalHelix,
            wheel("2", "30", "1200.5", 15),
            "the face width b is 1200.5 mm; ISO 1328-1:2013 covers 4 to 1200 mm",
        ),
        (
            ISO_2013,
            D::SinglePitch,
            wheel("2", "30", "20", 4),
            "the number of teeth z is 4; ISO 1328-1:2013 covers 5 to 1000",
        ),
        (
            ISO_2013,
            D::SinglePitch,
            wheel("2", "30", "20", 1001),
            "the number of teeth z is 1001; ISO 1328-1:2013 covers 5 to 1000",
        ),
    ] {
        assert_eq!(message(standard, deviation, 7, &size), expected);
    }
    for angle in ["45.01", "-46"] {
        let helical = Wheel { helix_angle: Some(angle.parse().unwrap()), ..good.clone() };
        assert!(message(ISO_2013, D::SinglePitch, 7, &helical).starts_with("the helix angle β is "), "{angle}");
    }
    for angle in ["45", "-45"] {
        let helical = Wheel { helix_angle: Some(angle.parse().unwrap()), ..good.clone() };
        assert!(ISO_2013.permissible(D::SinglePitch, 7, &helical).is_ok());
    }
    for (standard, grade, expected) in [
        (ISO_1995, 13, "ISO 1328-1:1995 has grades 0 to 12, not 13"),
        (ISO_1997, 3, "ISO 1328-2:1997 has grades 4 to 12, not 3"),
        (ISO_2013, 0, "ISO 1328-1:2013 has grades 1 to 11, not 0"),
        (ISO_2013, 12, "ISO 1328-1:2013 has grades 1 to 11, not 12"),
    ] {
        assert_eq!(message(standard, standard.deviations()[0], grade, &good), expected);
    }
    let bare = Wheel { normal_module: Some("2".parse().unwrap()), ..Wheel::default() };
    assert_eq!(message(ISO_1995, D::SinglePitch, 7, &bare), "f_pt by ISO 1328-1:1995 needs the reference diameter d");
    assert_eq!(message(ISO_1995, D::RadialComposite, 7, &good), "ISO 1328-1:1995 gives no permissible value of F_i''");
    // composite deviations take the actual size outside the ranges, but never 0
    assert!(ISO_1997.permissible(D::RadialComposite, 7, &wheel("0", "30", "20", 15)).is_err());
}

/// Grade 5 is the formula itself, even steps are exact powers of two, and two odd ones make one of them.
#[test]
fn grades_are_steps_of_the_root_of_two() {
    use Deviation as D;
    let size = wheel("2.5", "100", "16", 40);
    for standard in [ISO_1995, ISO_1997, ISO_2013] {
        for deviation in standard.deviations() {
            let at = |grade| standard.permissible(deviation, grade, &size).unwrap().unrounded_um();
            for grade in standard.grades().filter(|grade| standard.grades().contains(&(grade + 2))) {
                let ratio = at(grade + 2) / at(grade);
                assert!((ratio - 2.0).abs() < 1e-8, "{standard} {deviation} {grade}: {ratio}");
            }
            assert!((at(6) / at(5) - std::f64::consts::SQRT_2).abs() < 1e-8);
        }
    }
    let exact = |deviation, grade| ISO_2013.permissible(deviation, grade, &size).unwrap().unrounded_um();
    let near = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-15, "{value} {expected}");
    // 0.1 + 1 + 5; 0.2 + 5.5 + 1.75 + 12
    near(exact(D::SinglePitch, 5), 6.1);
    near(exact(D::SinglePitch, 9), 24.4);
    near(exact(D::SinglePitch, 1), 1.525);
    near(exact(D::TotalPitch, 7), 38.9);
    near(exact(D::Runout, 7), 35.01);
}

/// Decimal values half way between two steps; most of them have no exact binary value.
#[test]
fn ties_are_rounded_up() {
    use Deviation as D;
    for (deviation, grade, size, unrounded, value) in [
        // 0.001 · 50 + 0.4 · 3 + 5 = 6.25
        (D::SinglePitch, 5, wheel("3", "50", "20", 20), 6.25, 6.5),
        // 0.001 · 150 + 0.4 · 4 + 5 = 6.75; a quarter of it is 1.6875
        (D::SinglePitch, 5, wheel("4", "150", "20", 40), 6.75, 7.0),
        // 0.001 · 300 + 0.4 · 13 + 5 = 10.5
        (D::SinglePitch, 5, wheel("13", "300", "20", 40), 10.5, 11.0),
        // 0.55 · 10 + 5 = 10.5
        (D::ProfileForm, 5, wheel("10", "300", "20", 40), 10.5, 11.0),
        // half of 0.001 · 500 + 0.4 · 9 + 5 = 9.1
        (D::SinglePitch, 3, wheel("9", "500", "20", 40), 4.55, 4.6),
        // a quarter of 0.001 · 200 + 0.4 · 10 + 5 = 9.2, doubled by two grades
        (D::SinglePitch, 1, wheel("10", "200", "20", 40), 2.3, 2.3),
        // 0.001 · 1000 + 0.4 · 10 + 5 = 10 exactly, where steps of 0.5 and of 1 give the same
        (D::SinglePitch, 5, wheel("10", "1000", "20", 40), 10.0, 10.0),
        // 20 and half of it
        (D::SinglePitch, 3, wheel("10", "1000", "20", 40), 5.0, 5.0),
        // 0.05 · 10 + 0.35 · 5 + 4
        (D::HelixSlope, 5, wheel("10", "100", "25", 40), 6.25, 6.5),
        // twice 6.25
        (D::HelixSlope, 7, wheel("10", "100", "25", 40), 12.5, 13.0),
    ] {
        let given = ISO_2013.permissible(deviation, grade, &size).unwrap();
        assert!((given.unrounded_um() - unrounded).abs() < 1e-14, "{deviation} {grade}");
        assert_eq!(given.value_um(), value, "{deviation} {grade}");
    }
    // √2 · √(f_Hα² + f_fα²) with equal parts of 10.5 is 21
    let equal = wheel("10", "2500", "20", 100);
    let total = ISO_2013.permissible(D::TotalProfile, 6, &equal).unwrap();
    assert!((total.unrounded_um() - 21.0).abs() < 1e-14);
}

#[test]
fn eighth_of_the_teeth() {
    let sector = |teeth| {
        let value = ISO_1995.permissible(Deviation::SectorPitch, 5, &wheel("2", "30", "20", teeth)).unwrap();
        value.ranges.iter().find(|used| used.size == Size::Teeth).unwrap().taken
    };
    for (teeth, pitches) in [(1, 2.0), (7, 2.0), (16, 2.0), (23, 2.0), (24, 3.0), (31, 3.0), (32, 4.0)] {
        assert_eq!(sector(teeth), pitches, "{teeth}");
    }
}

#[test]
fn names_are_read_however_they_are_written() {
    for (text, standard) in [
        ("iso1328-1:1995", ISO_1995),
        ("ISO 1328-1:1995", ISO_1995),
        ("ISO1328-1-1995", ISO_1995),
        ("ANSI/AGMA ISO 1328-1", ISO_1995),
        ("ANSI/AGMA ISO 1328-1-B14", ISO_2013),
        ("iso 1328-2:1997", ISO_1997),
        ("DIN ISO 1328-1:2018", ISO_2013),
        ("DIN 3962", DIN),
        ("jis b 1702-1976", JIS),
    ] {
        assert_eq!(text.parse::<Standard>(), Ok(standard), "{text}");
    }
    for standard in Standard::ALL {
        assert_eq!(standard.id().parse(), Ok(standard));
        assert_eq!(standard.name().parse(), Ok(standard));
    }
    for text in ["iso1328", "ISO 1328-1", "iso1328-1:2012", "din 3961", ""] {
        assert!(text.parse::<Standard>().is_err(), "{text}");
    }
}

/// Every formula can be evaluated at every grade, grows with the grade, and prints itself.
#[test]
fn every_value_has_a_formula_and_a_clause() {
    let size = wheel("1.9", "14.675", "30", 7);
    for standard in Standard::ALL {
        for deviation in standard.deviations() {
            let values: Vec<_> =
                standard.grades().filter_map(|grade| standard.permissible(deviation, grade, &size).ok()).collect();
            assert!(values.len() >= 4, "{standard} {deviation}");
            assert!(values.windows(2).all(|pair| pair[0].value_um() < pair[1].value_um()), "{standard} {deviation}");
            assert!(values.iter().all(|value| !value.clause.is_empty() && !value.formula.is_empty()));
        }
    }
    let formula = |standard: Standard, deviation| standard.permissible(deviation, 5, &size).unwrap().formula;
    assert_eq!(formula(ISO_1995, Deviation::SinglePitch), "0.3 m_n + 0.12 √d + 4");
    assert_eq!(formula(ISO_1997, Deviation::Runout), "0.8 (0.3 m_n + 1.25 √d + 7)");
    assert_eq!(formula(ISO_2013, Deviation::TotalProfile), "√((0.4 m_n + 0.001 d + 4)² + (0.55 m_n + 5)²)");
}

/// What `explain permissible` prints is what is computed.
#[test]
fn the_formulas_are_documented_as_they_are_computed() {
    let size = wheel("2.5", "100", "16", 40);
    for standard in [ISO_1995, ISO_1997, ISO_2013] {
        for deviation in standard.deviations() {
            let formula = standard.permissible(deviation, 5, &size).unwrap().formula;
            assert!(include_str!("method.md").contains(&formula), "{standard} {deviation}: {formula}");
        }
    }
}
