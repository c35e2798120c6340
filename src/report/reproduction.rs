//! The report of `reproduce`: the paper's tables beside the computed ones.

use serde_json::{Value, json};

use super::number::{signed, tidy};
use super::{Block, Report, Table, fact};
use crate::deviation::FIRST_ODD_TOOTH;
use crate::formula::Model;
use crate::reproduction::{
    FACE_WIDTH, PRESSURE_ANGLE, PRINTED, PaperTable, Printed, ROLL_AXIS_DEPTH_MM, ReproductionError, SimulatedRow,
    pair, simulate_all,
};

/// The source of the pair, which the paper does not publish.
const FITTED: &str = "fitted to Table 1's multibody column";

/// One row of a table of the paper, computed again.
#[derive(Debug, Clone)]
struct Row {
    printed: Printed,
    /// The value by the paper's model, rounded as it is printed.
    rounded: String,
    paper_mm: f64,
    exact_mm: f64,
    simulated: Result<SimulatedRow, ReproductionError>,
}

/// The paper's Tables 1 to 3, recomputed.
#[derive(Debug, Clone)]
pub struct Reproduction {
    rows: Vec<Row>,
    contact_ratio: f64,
}

impl Reproduction {
    /// Recomputes the tables; `watch` gets the share that is done, 0 to 1.
    ///
    /// # Errors
    /// None that the printed values can cause; the formulas' own are passed on.
    pub fn new(watch: &(dyn Fn(f64) + Sync)) -> Result<Self, ReproductionError> {
        let rows = PRINTED.iter().zip(simulate_all(watch)).map(|(printed, simulated)| {
            Ok(Row {
                printed: *printed,
                rounded: printed.rounded()?,
                paper_mm: printed.analytic(Model::Paper)?.mm(),
                exact_mm: printed.analytic(Model::Exact)?.mm(),
                simulated,
            })
        });
        let rows = rows.collect::<Result<_, ReproductionError>>()?;
        Ok(Self { rows, contact_ratio: pair()?.contact_ratio().total })
    }

    /// Whether every analytic entry agrees with the printed one to its last digit, and every row was simulated.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.rows.iter().all(|row| row.agrees() && row.simulated.as_ref().is_ok_and(|run| run.outcome.completed()))
    }

    /// The curves of a table's rows with that sign, for a picture: the error as printed, stroke and centre distance.
    pub fn curves(&self, table: PaperTable, sign: char) -> impl Iterator<Item = (&'static str, Vec<(f64, f64)>)> {
        let rows =
            self.rows.iter().filter(move |row| row.printed.table == table && row.printed.error.starts_with(sign));
        rows.filter_map(|row| {
            let samples = &row.simulated.as_ref().ok()?.outcome.samples;
            let curve = samples.iter().map(|sample| (sample.stroke_mm, sample.center_distance_mm)).collect();
            Some((row.printed.error, curve))
        })
    }
}

impl Row {
    fn agrees(&self) -> bool {
        self.rounded == self.printed.analytic
    }

    fn mesh_mm(&self) -> Option<f64> {
        self.simulated.as_ref().ok()?.exact_mm.map(tidy)
    }

    fn multibody_mm(&self) -> Option<f64> {
        let run = self.simulated.as_ref().ok()?;
        // the means of a run that stopped are not those of the row
        run.multibody_mm.filter(|_| run.outcome.completed()).map(tidy)
    }

    /// Why formula, exact mesh and simulation differ in this row, in numbers; `None` where one is missing.
    fn why(&self) -> Option<String> {
        let (mesh, multibody) = (self.mesh_mm()?, self.multibody_mm()?);
        let outcome = &self.simulated.as_ref().ok()?.outcome;
        let micrometres = |mm: f64| {
            if mm.abs() < 5e-6 { "less than 0.01 µm".to_owned() } else { format!("{} µm", signed(1000.0 * mm, 2)) }
        };
        // the difference of the elastic parts of both rack parts
        let elastic = outcome.difference_mm().zip(outcome.rigid_difference_mm()).map(|(all, rigid)| all - rigid);
        let left = outcome.rigid_difference_mm().map(|rigid| rigid - mesh);
        let gives_way = match elastic.zip(left) {
            Some((elastic, left)) => format!(
                "the simulated teeth give way by {} more than nominal ones do, and {} are left to the spheres' distance",
                micrometres(-elastic),
                micrometres(left)
            ),
            None => format!("the simulation, its indentation added back, is off by {}", micrometres(multibody - mesh)),
        };
        let formula = self.exact_mm;
        Some(match self.printed.table {
            _ if formula == 0.0 => format!("no tooth deviates; {gives_way}"),
            PaperTable::Pitch => format!(
                "{:.2} pitch errors add up in the contact zone on average, so the exact mesh is that many times the formula's \
                 single one; {gives_way}",
                mesh / formula
            ),
            PaperTable::Lead => format!(
                "flanks meet at the ends of the face width on a rack that rolls to meet them, {} from the formula; at those ends \
                 {gives_way}",
                micrometres(mesh - formula)
            ),
            PaperTable::OverRoller => {
                format!("every flank of the second part moves with ΔM, so formula and exact mesh agree; {gives_way}")
            }
        })
    }
}

/// Number, heading and unit of a table, and why formula, mesh and simulation differ there.
const fn of_table(table: PaperTable) -> (u8, &'static str, &'static str, &'static str) {
    match table {
        PaperTable::Pitch => (
            1,
            "Table 1\nΔp [mm]",
            "mm",
            "Table 1: the formula counts one pitch error. In the model every pitch of the rack's second part is off, the teeth \
             in contact add their errors up, and the teeth are thicker by Δp/2, so that ΔCD switches \
             between multiples of half the formula's value; the mean is what is listed. Printed and simulated values are near each \
             other because the pair is fitted to them. Elastic teeth share the load, which takes \
             1 to 2 µm off the exact mesh.",
        ),
        PaperTable::Lead => (
            2,
            "Table 2\nΔβ [deg]",
            "deg",
            "Table 2: flanks touch at the ends of the face width. The rack may roll on its cylindrical joint, which lowers ΔCD \
             by half a percent, and the corner that carries the whole load gives way by some µm, which lowers it by 2 to 3 % more. \
             The printed values for negative Δβ are lower still, and what makes them so is not known. A pinion that does not \
             reach one end of the rack's face lowers the values of both signs alike, by 2 µm at most, and one that is offset \
             along its axis does not do it either. Of some 700 pairs and discretisations tried, the best is a helical \
             rack with 16 × 36 coarse spheres, which comes to 1.1 µm rms with 16 free parameters against four numbers. \
             Corners that sink in between the points of a coarse lattice are the likely cause, which that does not prove.",
        ),
        PaperTable::OverRoller => (
            3,
            "Table 3\nΔM [mm]",
            "mm",
            "Table 3: the flanks of the second part are shifted along Z as a whole, so formula, mesh and simulation say the same.",
        ),
    }
}

/// The paper's multibody values less the computed ones, for each error.
fn residuals<'a>(rows: impl Iterator<Item = &'a Row>) -> String {
    let each = rows.filter(|row| row.exact_mm != 0.0).filter_map(|row| {
        let printed: f64 = row.printed.multibody.parse().ok()?;
        Some(format!("{} µm ({})", signed(1000.0 * (printed - row.multibody_mm()?), 1), row.printed.error))
    });
    format!(" Printed less simulated: {}.", each.collect::<Vec<_>>().join(", "))
}

const TABLES: [PaperTable; 3] = [PaperTable::Pitch, PaperTable::Lead, PaperTable::OverRoller];

impl Report for Reproduction {
    fn json(&self) -> Value {
        let rows: Vec<_> = self
            .rows
            .iter()
            .map(|row| {
                let (number, _, unit, _) = of_table(row.printed.table);
                let (given, other) =
                    if unit == "mm" { ("deviation_mm", "deviation_deg") } else { ("deviation_deg", "deviation_mm") };
                json!({
                    "table": number,
                    given: row.printed.error.parse::<f64>().ok(),
                    other: null,
                    "printed_delta_cd_mm": row.printed.analytic.parse::<f64>().ok(),
                    "delta_cd_paper_mm": row.paper_mm,
                    "delta_cd_exact_mm": row.exact_mm,
                    "agrees": row.agrees(),
                    "printed_multibody_mm": row.printed.multibody.parse::<f64>().ok(),
                    "multibody_mm": row.multibody_mm(),
                    "exact_mesh_mm": row.mesh_mm(),
                    "why": row.why(),
                    "problem": row.simulated.as_ref().err().map(ToString::to_string),
                })
            })
            .collect();
        json!({
            "inferred": { "normal_pressure_angle_deg": 19.9, "rack_face_width_mm": 19.7, "rack_helix_angle_deg": 0 },
            "pair": FITTED,
            "contact_ratio": self.contact_ratio,
            "elastic_part": "stiffness as given, not a material's: of one sphere",
            "chosen": {
                "normal_module_mm": 2, "teeth": 8, "pinion_helix_angle_deg": 21, "profile_shift": 0.3,
                "rack_addendum_mm": 1.7, "tip_diameter_mm": 19.738, "pinion_face_width_mm": 23.5,
                "roll_axis_depth_mm": ROLL_AXIS_DEPTH_MM, "first_tooth_with_error": FIRST_ODD_TOOTH,
            },
            "rows": rows,
            "agrees": self.agrees(),
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        const NAMES: &str = "table deviation unit printed_delta_cd_mm delta_cd_paper_mm delta_cd_exact_mm agrees \
                             printed_multibody_mm multibody_mm exact_mesh_mm why pair";
        let mut json = self.json();
        // the paper's values, to the last printed digit
        for (record, Row { printed, .. }) in json["rows"].as_array_mut().into_iter().flatten().zip(&self.rows) {
            record["deviation"] = printed.error.into();
            record["unit"] = of_table(printed.table).2.into();
            record["printed_delta_cd_mm"] = printed.analytic.into();
            record["printed_multibody_mm"] = printed.multibody.into();
        }
        fact::rows(&json, "rows", NAMES)
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks =
            vec![Block::Title("Effects of Gear Manufacturing Errors on Rack and Pinion Steering Meshing".to_owned())];
        blocks.push(Block::Note("ΔCD in mm, as the paper prints it and as it is computed here".to_owned()));
        let mm = |value| signed(value, 5);
        for table in TABLES {
            let (_, heading, _, why) = of_table(table);
            let rows = self.rows.iter().filter(|row| row.printed.table == table);
            let listed = Table::of(rows.clone())
                .number(heading, |row| row.printed.error)
                .number("analytic,\nprinted", |row| row.printed.analytic)
                .number("\nours", |row| row.rounded.clone())
                .number("exact\nmodel", |row| format!("{:.6}", row.exact_mm))
                .text("\nagrees", |row| if row.agrees() { "yes" } else { "NO" })
                .number("multibody,\nprinted", |row| row.printed.multibody)
                .number("\nours", |row| row.multibody_mm().map(mm))
                .number("exact\nmesh", |row| row.mesh_mm().map(mm));
            let left = if table == PaperTable::Lead { residuals(rows.clone()) } else { String::new() };
            blocks.extend([listed.block(), Block::Note(format!("{why}{left}"))]);
            blocks.extend(rows.filter_map(|row| Some(Block::Note(format!("{}: {}", row.printed.error, row.why()?)))));
        }
        let problems = self.rows.iter().filter_map(|row| {
            let problem = match &row.simulated {
                Err(error) => error.to_string(),
                Ok(run) if !run.outcome.completed() => format!("{:?}", run.outcome.end),
                Ok(_) => return None,
            };
            Some(Block::Note(format!("{} was not simulated: {problem}", row.printed.error)))
        });
        blocks.extend(problems);
        blocks.push(Block::Note(format!(
            "Inferred, not printed in the paper: α_n = {PRESSURE_ANGLE}, k = {FACE_WIDTH}. Any α_n above 19.872° and up to \
             19.983° with k / (2 tan α_n) between 27.158 and 27.215 mm gives the same analytic digits; α_n = 20° does not. \
             The pair of mesh and multibody is {FITTED}, so its agreement there confirms nothing: m_n = 2, z = 8, β_p = 21°, β_r = 0, x = 0.3, rack addendum 1.7 mm, pinion tip \
             diameter 19.738 mm and face width 23.5 mm; its contact ratio in the mesh is {:.2}. Chosen: roll axis {ROLL_AXIS_DEPTH_MM} mm below the reference plane, errors from \
             tooth {FIRST_ODD_TOOTH} on, the simulation's defaults. ΔCD by mesh and multibody is the mean over the second part \
             less that over the first. What teeth give way by: stiffness as given, not a \
             material's.",
            self.contact_ratio
        )));
        blocks
    }
}
