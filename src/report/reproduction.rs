//! The report of `reproduce`: the paper's tables beside ours.

use serde_json::{Value, json};

use super::number::plain;
use super::{Block, Column, Report, Table};
use crate::formula::{Model, RackLead, RackPitch, over_roller};
use crate::quantity::{Angle, DomainError, Length};

/// One row of a table of the paper.
#[derive(Debug, Clone)]
struct Row {
    table: u8,
    error: &'static str,
    unit: &'static str,
    /// Analytic ΔCD as printed, mm.
    printed: &'static str,
    exact: Length,
    paper: Length,
}

/// The analytic columns of the paper's Tables 1 to 3, recomputed.
#[derive(Debug, Clone)]
pub struct Reproduction {
    rows: Vec<Row>,
}

/// Neither is printed in the paper; together they reproduce every analytic entry to the printed digit.
const PRESSURE_ANGLE: &str = "19.9°";
const FACE_WIDTH: &str = "19.7 mm";

/// Table, error, analytic ΔCD: the values that the paper prints.
const PRINTED: &[(u8, &str, &str)] = &[
    (1, "+0.01", "0.014"),
    (1, "+0.02", "0.028"),
    (1, "+0.03", "0.041"),
    (1, "-0.01", "0.014"),
    (1, "-0.02", "0.028"),
    (1, "-0.03", "0.041"),
    (2, "0", "0"),
    (2, "+0.25", "0.119"),
    (2, "+0.5", "0.237"),
    (2, "0", "0"),
    (2, "-0.25", "0.119"),
    (2, "-0.5", "0.237"),
    (3, "+0.01", "+0.010"),
    (3, "+0.02", "+0.020"),
    (3, "+0.03", "+0.030"),
    (3, "-0.01", "-0.010"),
    (3, "-0.02", "-0.020"),
    (3, "-0.03", "-0.030"),
];

impl Reproduction {
    /// Recomputes the tables.
    ///
    /// # Errors
    /// None that the constants above can cause; the formulas' own are passed on.
    pub fn new() -> Result<Self, DomainError> {
        let pressure_angle: Angle = PRESSURE_ANGLE.parse()?;
        let pitch = RackPitch::new(&pressure_angle, &Angle::ZERO)?;
        let lead = RackLead::new(&pressure_angle, &Angle::ZERO, &FACE_WIDTH.parse()?)?;
        let rows = PRINTED.iter().map(|(table, error, printed)| {
            let (exact, paper, unit) = match table {
                1 => {
                    let error = error.parse()?;
                    (pitch.delta_cd(&error, Model::Exact)?, pitch.delta_cd(&error, Model::Paper)?, "mm")
                }
                2 => {
                    let error = error.parse()?;
                    (lead.delta_cd(&error, Model::Exact)?, lead.delta_cd(&error, Model::Paper)?, "deg")
                }
                _ => {
                    let delta_cd = over_roller::delta_cd(&error.parse()?);
                    (delta_cd.clone(), delta_cd, "mm")
                }
            };
            Ok(Row { table: *table, error, unit, printed, exact, paper })
        });
        Ok(Self { rows: rows.collect::<Result<_, DomainError>>()? })
    }

    /// Whether every analytic entry agrees with the printed one to its last digit.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.rows.iter().all(Row::agrees)
    }
}

impl Row {
    fn rounded(&self) -> String {
        let decimals = self.printed.split_once('.').map_or(0, |(_, fraction)| fraction.len());
        let mm = self.paper.mm();
        if self.printed.starts_with('+') { format!("{mm:+.decimals$}") } else { format!("{mm:.decimals$}") }
    }

    fn agrees(&self) -> bool {
        self.rounded() == self.printed
    }
}

impl Report for Reproduction {
    fn json(&self) -> Value {
        let rows: Vec<_> = self
            .rows
            .iter()
            .map(|row| {
                let (mm, deg) = if row.unit == "mm" {
                    ("deviation_mm", "deviation_deg")
                } else {
                    ("deviation_deg", "deviation_mm")
                };
                json!({
                    "table": row.table,
                    mm: row.error.parse::<f64>().ok(),
                    deg: null,
                    "printed_delta_cd_mm": row.printed.parse::<f64>().ok(),
                    "delta_cd_paper_mm": row.paper.mm(),
                    "delta_cd_exact_mm": row.exact.mm(),
                    "agrees": row.agrees(),
                })
            })
            .collect();
        json!({
            "inferred": { "normal_pressure_angle_deg": 19.9, "rack_face_width_mm": 19.7, "rack_helix_angle_deg": 0 },
            "rows": rows,
            "agrees": self.agrees(),
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let header =
            ["table", "deviation", "unit", "printed_delta_cd_mm", "delta_cd_paper_mm", "delta_cd_exact_mm", "agrees"];
        let mut rows = vec![header.iter().map(|name| (*name).to_owned()).collect()];
        rows.extend(self.rows.iter().map(|row| {
            vec![
                row.table.to_string(),
                row.error.to_owned(),
                row.unit.to_owned(),
                row.printed.to_owned(),
                plain(row.paper.mm()),
                plain(row.exact.mm()),
                row.agrees().to_string(),
            ]
        }));
        rows
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = vec![Block::Title(
            "Effects of Gear Manufacturing Errors on Rack and Pinion Steering Meshing: analytic ΔCD".to_owned(),
        )];
        for (table, heading) in [(1, "Table 1: Δp [mm]"), (2, "Table 2: Δβ [deg]"), (3, "Table 3: ΔM [mm]")] {
            let rows = self.rows.iter().filter(|row| row.table == table).map(|row| {
                vec![
                    row.error.to_owned(),
                    row.printed.to_owned(),
                    row.rounded(),
                    format!("{:.6}", row.paper.mm()),
                    format!("{:.6}", row.exact.mm()),
                    if row.agrees() { "yes" } else { "NO" }.to_owned(),
                ]
            });
            blocks.push(Block::Table(Table {
                rows: rows.collect(),
                columns: vec![
                    Column::number(heading),
                    Column::number("printed"),
                    Column::number("ours"),
                    Column::number("paper model"),
                    Column::number("exact model"),
                    Column::text("agrees"),
                ],
            }));
        }
        blocks.push(Block::Note(format!(
            "ΔCD in mm. Inferred, not printed in the paper: α_n = {PRESSURE_ANGLE}, k = {FACE_WIDTH}. Any α_n above \
             19.872° and up to 19.983° with k / (2 tan α_n) between 27.158 and 27.215 mm gives the same digits; \
             α_n = 20° does not. The paper's models do not depend on its other unpublished data; the exact ones are for \
             a spur rack (β_r = 0)."
        )));
        blocks
    }
}
