//! Random lots of parts, and lots of parts with their teeth.

use super::*;

const COLUMNS: [&[Column]; 5] = [
    &[
        ("rack_over_roller", "M [mm]", "M", 250_000, 10, 4),
        ("rack_over_roller", "rack_over_roller [um]", "", 0, 10, 1),
        ("rack_over_roller", "Rollenmaß [mm]", "", 25_000_000, 1000, 6),
    ],
    &[
        ("rack_pitch", "dp [µm]", "dp", 0, 10, 1),
        ("rack_pitch", "rack_pitch_mm", "", 0, 100, 5),
        ("rack_pitch", "Teilungsabweichung Zahnstange [µm]", "", 0, 100, 2),
    ],
    &[
        ("rack_lead", "rack_lead [arcmin]", "", 0, 10, 2),
        ("rack_lead", "lead (deg)", "lead", 0, 15, 4),
        ("rack_lead", "lead [mrad]", "lead", 0, 30, 3),
    ],
    &[("pinion_radial", "r [mm]", "r", 85_000, 10, 4), ("pinion_radial", "pinion_radial_um", "", 0, 100, 2)],
    &[("pinion_pitch", "pinion_pitch [um]", "", 0, 10, 1), ("pinion_pitch", "fp [mm]", "fp", 0, 10, 4)],
];

/// A number of units of the last digit.
fn decimal(units: i32, decimals: u32) -> String {
    format!("{:.*}", decimals as usize, f64::from(units) / f64::from(10_i32.pow(decimals)))
}

/// Writes a spec, a table with a row per part, and one with the first 250 rows. Some parts are exactly on a limit, some
/// cells are not numbers. The kind says which separator the table has; kind 3 has decimal commas. True if the values
/// have uncertainties.
pub(super) fn write_lot(inputs: &Inputs, name: &str, kind: usize, parts: usize) -> bool {
    let mut random = Random::of(name);
    let separator = [",", ";", "\t", ";"][kind];
    let mut columns = vec![random.pick(COLUMNS[0])];
    for more in &COLUMNS[1..] {
        if !random.one_in(3) {
            columns.push(random.pick(more));
        }
    }
    let limits = [random.integer(-40, -20), random.integer(30, 60)];
    let uncertain = random.one_in(3);
    inputs.write(&format!("{name}.toml"), &spec_of_lot(&mut random, &columns, limits, uncertain));
    let headings: Vec<_> = columns.iter().map(|column| column.1).collect();
    let mut rows = vec![format!("part_id{separator}{}{separator}remark\n", headings.join(separator))];
    for part in 0..parts {
        let on_limit = if random.one_in(25) { Some(random.pick(&limits)) } else { None };
        let cells: Vec<_> = columns.iter().map(|column| cell(&mut random, column, on_limit)).collect();
        let cells = if kind == 3 { cells.join(separator).replace('.', ",") } else { cells.join(separator) };
        let remark = if random.one_in(50) { "\"re-cut, 2nd shift; see note\"" } else { "" };
        rows.push(format!("P{part:04}{separator}{cells}{separator}{remark}\n"));
    }
    inputs.write(&format!("{name}.csv"), &rows.concat());
    inputs.write(&format!("{name}-few.csv"), &rows[..parts.min(251)].concat());
    uncertain
}

/// A cell; with a limit in µm the rack's over-roller error is exactly that and nothing else deviates.
fn cell(random: &mut Random, &(key, _, _, nominal, micrometre, decimals): &Column, on_limit: Option<i32>) -> String {
    if random.one_in(400) {
        return random.pick(&["", "-", "abc", "24.99?", "nan", "1e999", "12 parsec", "--3", "0x1f"]).to_owned();
    }
    let bell = random.integer(-15, 15) * micrometre + random.integer(-10 * micrometre, 10 * micrometre);
    let deviation = match on_limit {
        Some(limit) if key == "rack_over_roller" => limit * micrometre,
        Some(_) => 0,
        None => bell,
    };
    decimal(nominal + deviation, decimals)
}

fn spec_of_lot(random: &mut Random, columns: &[Column], [lower, upper]: [i32; 2], uncertain: bool) -> String {
    let (rack_helix, pinion_helix) = (random.pick(&[0, 0, 5, -12]), random.pick(&[0, 15, 25, -21]));
    let mut spec = format!("title = \"a lot\"\n[pair]\nnormal_pressure_angle = {}\n", random.hundredths(1700, 2300));
    spec += &format!("[rack]\nhelix_angle = {rack_helix}\nface_width = 19.7\n[pinion]\nhelix_angle = {pinion_helix}\n");
    spec += &format!("[limits]\ncenter_distance = {{ lower = \"{lower} um\", upper = \"{upper} um\" }}\n");
    if random.one_in(3) {
        spec += "rack_over_roller = \"±0.02\"\n";
    }
    let (mut errors, mut names) = ("[errors]\n".to_owned(), "[table.columns]\npart_id = \"part_id\"\n".to_owned());
    for &(key, _, name, nominal, _, decimals) in columns {
        let u = if uncertain && key != "rack_lead" {
            format!("u = \"{} um\"", random.hundredths(20, 200))
        } else {
            String::new()
        };
        let nominal = if nominal == 0 { String::new() } else { format!("nominal = {}", decimal(nominal, decimals)) };
        let comma = if u.is_empty() || nominal.is_empty() { "" } else { ", " };
        if !(u.is_empty() && nominal.is_empty()) {
            errors += &format!("{key} = {{ {nominal}{comma}{u} }}\n");
        }
        if !name.is_empty() {
            names += &format!("{key} = {{ name = \"{name}\" }}\n");
        }
    }
    spec + &errors + &names
}

/// 5000 parts, and 250 of them with all digits.
pub(super) fn lot(inputs: &Inputs, index: usize) -> Subject {
    let name = format!("lot-{index:02}");
    let uncertain = write_lot(inputs, &name, index % 4, 5000);
    let (stack, model) = (["range", "worst", "rss"][index % 3], ["exact", "paper"][index / 3 % 2]);
    let rule = if uncertain { " --rule iso14253" } else { ["", " --rule guard=5um"][index % 2] };
    let comma = if index % 4 == 3 { " --decimal comma" } else { "" };
    let how = format!("--stack {stack} --model {model}{rule}{comma}");
    let runs = [
        format!("batch {name}.toml {name}.csv {how}"),
        format!("batch {name}.toml {name}.csv {how} --summary --format json"),
        format!("batch {name}.toml {name}-few.csv {how} --decimals full"),
        format!("batch {name}.toml {name}-few.csv {how} --only-failures --format jsonl"),
        format!(
            "batch {name}.toml {name}-few.csv {how} --rejects {name}-rejects.csv --format tsv --columns part_id,verdict"
        ),
    ];
    (name, runs.into())
}

/// 25 racks with a row per space, through the exact mesh.
pub(super) fn lot_of_teeth(inputs: &Inputs, index: usize) -> Subject {
    let name = format!("teeth-{index}");
    let mut random = Random::of(&name);
    inputs.write(&format!("{name}.toml"), &(gear(&mut random, false).0 + &limits(&mut random)));
    let mut table =
        "part_id,space,over_pin_deviation [um],position_deviation [um],lead_deviation [arcmin]\n".to_owned();
    for part in 0..25 {
        for space in -4..=8 {
            let lead = if index % 2 == 1 { random.hundredths(-100, 100) } else { 0.0 };
            let (over_pin, position) = (random.hundredths(-1000, 1000), random.hundredths(-500, 500));
            table += &format!("R{part},{space},{over_pin},{position},{lead}\n");
        }
    }
    inputs.write(&format!("{name}.csv"), &table);
    let batch = format!("batch {name}.toml {name}.csv --teeth --to 10");
    (name, vec![format!("{batch} --decimals full"), format!("{batch} --summary --format json")])
}
