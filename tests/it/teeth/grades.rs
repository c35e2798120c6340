//! The grades that measured teeth reach.

use super::*;

/// What `class --obtained` says of a table, by what was measured.
fn obtained(folder: &Folder, part: &str, table: &str) -> serde_json::Value {
    let (spec_path, table_path) = (folder.path("obtained.toml"), folder.path("table.csv"));
    let measured = format!("[{part}]\nmeasured = \"table.csv\"\n");
    let spec = PAIR.replace(&format!("[{part}]\n"), &measured);
    std::fs::write(&spec_path, spec).unwrap();
    std::fs::write(table_path, table).unwrap();
    let ended = run(
        &[
            "class",
            "--obtained",
            &spec_path,
            "--standard",
            "iso1328-1:1995",
            "--diameter",
            "pinion",
            "--format",
            "json",
        ],
        "",
    );
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.json()
}

fn amount_mm(obtained: &serde_json::Value, what: &str) -> f64 {
    let rows = obtained["values"].as_array().unwrap_or_else(|| panic!("{obtained}"));
    let found = rows.iter().find(|row| row["origin"].as_str().is_some_and(|origin| origin.starts_with(what)));
    1e-3 * found.and_then(|row| row["measured_um"].as_f64()).unwrap_or_else(|| panic!("{what}: {obtained}"))
}

/// f_Hβ lies along the base tangent: b cos α_t (tan(β + Δβ) − tan β).
#[test]
fn the_grade_of_a_pinions_lead_is_that_of_its_helix_slope() {
    let folder = Folder::new("obtained-lead");
    let found = amount_mm(&obtained(&folder, "pinion", "tooth,lead [deg]\n0,0.02\n1,-0.01\n"), "largest lead");
    // α_t of 19.9° at 21°, and 0.02° more than 21°
    let expected = 0.011_203_880_9;
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
}

/// Positions of pins have pitches, whether they are measured from an end or from their nominal places; those of a pinion too.
#[test]
fn positions_have_a_grade_of_pitches() {
    let folder = Folder::new("obtained-positions");
    let pitch = std::f64::consts::PI * 2.0;
    let off = [0.0, 0.01, -0.005, 0.0];
    let mut absolute = "space,position [mm]\n".to_owned();
    let mut pinion = "tooth,position [um]\n".to_owned();
    for (space, off) in (0..4_u32).zip(off) {
        let _ = writeln!(absolute, "{space},{:.9}", (f64::from(space) + 0.5) * pitch + off);
    }
    for tooth in 0..8 {
        let _ = writeln!(pinion, "{tooth},{}", 2 * tooth);
    }
    let of_rack = obtained(&folder, "rack", &absolute);
    let of = |what| amount_mm(&of_rack, what);
    assert!((of("differences of neighbouring") - 0.015).abs() < 1e-8, "{of_rack}");
    assert!((of("position deviations") - 0.015).abs() < 1e-8, "{of_rack}");
    // from tooth 7 to tooth 0
    let of_pinion = obtained(&folder, "pinion", &pinion);
    assert!((amount_mm(&of_pinion, "largest single pitch") - 0.014).abs() < 1e-9, "{of_pinion}");
}
