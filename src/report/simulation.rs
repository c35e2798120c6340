//! The report of `simulate`: positions in time, the steady values of both rack parts, and the exact mesh beside them.

use serde_json::{Map, Value, json};

use super::number::{plain, signed, tidy};
use super::{Block, Report, Screen, Table, fact, sketch, titled};
use crate::multibody::{ContactModel, Energy, Outcome, ParameterName, Parameters, RunEnd, Sample, Steady, Support};

/// A simulated stroke.
#[derive(Debug)]
pub struct SimulationReport<'a> {
    /// The spec's title.
    pub title: Option<&'a str>,
    /// What was simulated.
    pub parameters: &'a Parameters,
    /// Inertia of the pinion's rotation, mass of what moves along Z, inertia of the rack's roll, in N s²/mm and N mm
    /// s², as the scene took or computed them.
    pub inertias: [f64; 3],
    /// Whether it was solved as an equilibrium at each stroke.
    pub quasi_static: bool,
    /// What came out.
    pub outcome: &'a Outcome,
    /// The exact mesh, averaged over the same strokes as the steady value of the nominal and of the
    /// deviating teeth, mm.
    pub exact_mm: [Option<f64>; 2],
    /// Remarks.
    pub notes: Vec<String>,
    /// Room for the sketch, which is drawn on a screen only.
    pub screen: Screen,
}

/// A column of the listing: its name, and the value at a position.
type Listed = (&'static str, fn(&Sample) -> f64);

const COLUMNS: &[Listed] = &[
    ("time_s", |s| s.time_s),
    ("stroke_mm", |s| s.stroke_mm),
    ("delta_cd_mm", |s| s.delta_cd_mm),
    ("center_distance_mm", |s| s.center_distance_mm),
    ("pinion_angle_deg", |s| s.pinion_angle_rad.to_degrees()),
    ("roll_deg", |s| s.roll_rad.to_degrees()),
    ("normal_force_right_n", |s| s.normal_force_right_n),
    ("normal_force_left_n", |s| s.normal_force_left_n),
    ("contacts", |s| f64::from(s.contacts)),
    ("penetration_mm", |s| s.penetration_mm),
    ("indentation_mm", |s| s.indentation_mm),
];

/// The columns of a yoke, after the others.
const YOKE_COLUMNS: [&str; 3] = ["yoke_travel_mm", "yoke_force_n", "bush_force_n"];

fn yoke_cells(sample: &Sample) -> Option<[f64; 3]> {
    sample.yoke.map(|yoke| [yoke.travel_mm, yoke.force_n, yoke.bush_force_n])
}

/// A given number for people: as it was written, a computed one to five digits.
fn short(value: f64) -> String {
    let text = plain(value);
    if text.len() <= 9 { text } else { plain(format!("{value:.4e}").parse().unwrap_or(value)) }
}

/// A computed number for people, to three digits.
fn three_digits(value: f64) -> String {
    plain(format!("{value:.2e}").parse().unwrap_or(value))
}

/// What steps that are short enough leave of the balance of energy at most, of its largest part.
const CLOSED_BALANCE: f64 = 0.1;

impl SimulationReport<'_> {
    /// Where the elastic part of ΔCD comes from.
    fn elastic_part(&self) -> &'static str {
        match self.parameters.contact {
            ContactModel::Spheres(_) => "stiffness as given, not a material's: of one sphere",
            ContactModel::Analytic(_) => "stiffness as given, not a material's: of 1 mm of contact line",
        }
    }

    fn energy(&self, energy: &Energy) -> String {
        let [driven, stored, lost, settling] =
            [energy.driven, energy.stored, energy.dissipated, energy.settling].map(three_digits);
        let losses = if self.quasi_static {
            format!("{lost} N mm lost to friction")
        } else {
            format!(
                "{lost} N mm lost to damping and friction, {settling} N mm to settling while the rack reaches its speed"
            )
        };
        let balance = energy.drift_share().map_or_else(String::new, |share| {
            let advice =
                if share > CLOSED_BALANCE { " (forces change within a step: a shorter --step closes it)" } else { "" };
            format!(", balance off by {share:.1e} of the largest of these{advice}")
        });
        format!("energy: {driven} N mm driven in, {stored} N mm stored, {losses}{balance}")
    }

    /// The steady value of each rack part with the exact mesh's over the same strokes.
    fn parts(&self) -> [(&'static str, Option<Steady>, Option<f64>); 2] {
        let [nominal, deviating] = self.exact_mm;
        [("nominal teeth", self.outcome.nominal, nominal), ("teeth with deviations", self.outcome.deviating, deviating)]
    }

    /// ΔCD of the exact mesh between the two parts, mm.
    fn exact_difference_mm(&self) -> Option<f64> {
        Some(self.exact_mm[1]? - self.exact_mm[0]?)
    }

    fn steady_table(&self) -> Option<Block> {
        let mm = |value: f64| signed(tidy(value), 5);
        let micrometres = |mm: f64| signed(1000.0 * mm, 3);
        // what was simulated, the same with the indentation added back, and the exact mesh
        let parts = self.parts().into_iter().filter_map(|(name, steady, exact)| {
            let of = steady?;
            Some((name, steady, of.delta_cd_mm, Some(of.delta_cd_mm + of.indentation_mm), exact))
        });
        let difference = self.outcome.difference_mm().map(|difference| {
            ("difference", None, difference, self.outcome.rigid_difference_mm(), self.exact_difference_mm())
        });
        let of_part =
            |steady: &Option<Steady>, text: fn(&Steady) -> String| steady.as_ref().map(text).unwrap_or_default();
        Table::of(parts.chain(difference))
            .text("mean ΔCD", |(name, ..)| *name)
            .number("stroke\n[mm]", |(_, steady, ..)| of_part(steady, |s| format!("{:.2} … {:.2}", s.from_mm, s.to_mm)))
            .number("simulated\n[mm]", |(_, _, simulated, ..)| mm(*simulated))
            .number("exact mesh\n[mm]", |(.., exact)| exact.map(mm))
            .number("elastic part\n[µm]", |(_, steady, ..)| of_part(steady, |s| signed(-1000.0 * s.indentation_mm, 3)))
            .number("what is left\n[µm]", |(.., rigid, exact)| {
                rigid.zip(*exact).map(|(rigid, exact)| micrometres(rigid - exact))
            })
            .number("ripple, rms\n[µm]", |(_, steady, ..)| of_part(steady, |s| format!("{:.4}", 1000.0 * s.ripple_mm)))
            .block_if_any()
    }

    fn how(&self) -> String {
        let p = self.parameters;
        let contact = match p.contact {
            ContactModel::Spheres(grid) => {
                format!("{} × {} spheres a flank against triangles", grid.profile_nodes, grid.width_nodes)
            }
            ContactModel::Analytic(grid) => format!("exact surfaces in {} strips over the width", grid.strips),
        };
        let time = if self.quasi_static {
            "equilibrium at each stroke, no inertia and no damping".to_owned()
        } else {
            format!("implicit steps in time to {} mm", plain(p.tolerance_mm))
        };
        let support = match p.support {
            Support::Fixed => "pinion on a slider, rack cannot roll",
            Support::FreeRoll { .. } => "pinion on a slider, rack may roll",
            Support::Yoke(_) => "pinion axis fixed, rack carried by bush and yoke",
        };
        format!("{support}; {contact}; {time}")
    }

    /// The parameters that the run follows, and masses, as they are told.
    fn given(&self) -> Vec<(ParameterName, f64)> {
        use ParameterName as Name;
        let p = self.parameters;
        let is_yoke = matches!(p.support, Support::Yoke(_));
        let is_told = |name: &Name| match name {
            Name::Start => p.start_mm != 0.0,
            Name::Preload => !is_yoke,
            Name::Damping | Name::DampingExponent | Name::IndentationExponent => !self.quasi_static,
            Name::FrictionSpeed => p.friction > 0.0,
            Name::Ramp | Name::ProfileNodes | Name::WidthNodes => false,
            name => (*name as usize) <= Name::SphereRadius as usize,
        };
        let told = Name::ALL.into_iter().filter(is_told);
        let mut given: Vec<_> = told.filter_map(|name| Some((name, name.value(p)?))).collect();
        if !self.quasi_static {
            // from N s²/mm, which is a tonne
            let [turning, moving, rolling] = self.inertias.map(|value| tidy(1000.0 * value));
            let moves = if is_yoke { Name::RackMass } else { Name::PinionMass };
            given.extend([(moves, moving), (Name::PinionInertia, turning)]);
            if self.outcome.counters.coordinates > 2 {
                given.push((Name::RackInertia, rolling));
            }
        }
        given
    }

    fn work(&self) -> String {
        let counters = &self.outcome.counters;
        let mut text = format!(
            "{} positions, {} coordinates, {} Newton iterations, {} elements tested",
            self.outcome.samples.len(),
            counters.coordinates,
            counters.iterations,
            counters.spheres_tested
        );
        if counters.steps > 0 {
            text.push_str(&format!(", {} steps ({} rejected)", counters.steps, counters.rejected));
        }
        text
    }

    fn ending(&self) -> (&'static str, Option<String>) {
        match self.outcome.end {
            RunEnd::Completed => ("completed", None),
            RunEnd::Interrupted => {
                let reached = self.outcome.samples.last().map_or(self.parameters.start_mm, |sample| sample.stroke_mm);
                let text = format!("interrupted at a stroke of {reached:.1} mm; the positions up to there are right");
                ("interrupted", Some(text))
            }
            RunEnd::Failed(error) => ("failed", Some(format!("stopped: {error}"))),
        }
    }
}

impl Report for SimulationReport<'_> {
    fn json(&self) -> Value {
        let steady = |steady: Option<Steady>, exact: Option<f64>| {
            steady.map(|steady| {
                json!({
                    "delta_cd_mm": tidy(steady.delta_cd_mm),
                    "exact_mesh_mm": exact.map(tidy),
                    "indentation_mm": tidy(steady.indentation_mm),
                    "ripple_rms_mm": steady.ripple_mm,
                    "from_mm": steady.from_mm,
                    "to_mm": steady.to_mm,
                    "pitches": steady.pitches,
                })
            })
        };
        let points: Vec<_> = self
            .outcome
            .samples
            .iter()
            .map(|sample| {
                let cells = COLUMNS.iter().map(|(name, value)| ((*name).to_owned(), json!(tidy(value(sample)))));
                let mut point: Map<_, _> = cells.collect();
                point["contacts"] = json!(sample.contacts);
                let yoke = yoke_cells(sample).into_iter().flat_map(|cells| YOKE_COLUMNS.into_iter().zip(cells));
                point.extend(yoke.map(|(name, value)| (name.to_owned(), json!(tidy(value)))));
                Value::Object(point)
            })
            .collect();
        let parameters: Map<_, _> = self
            .given()
            .into_iter()
            .map(|(name, value)| (name.name().to_owned(), json!({ "value": value, "unit": name.unit() })))
            .collect();
        let [(_, nominal, exact_nominal), (_, deviating, exact_deviating)] = self.parts();
        json!({
            "title": self.title,
            "model": self.how(),
            "quasi_static": self.quasi_static,
            "end": self.ending().0,
            "problem": self.ending().1,
            "nominal": steady(nominal, exact_nominal),
            "deviating": steady(deviating, exact_deviating),
            "difference_mm": self.outcome.difference_mm().map(tidy),
            "elastic_part": self.elastic_part(),
            "rigid_difference_mm": self.outcome.rigid_difference_mm().map(tidy),
            "exact_difference_mm": self.exact_difference_mm().map(tidy),
            "energy_n_mm": self.outcome.energy.map(|energy| json!({
                "stored": energy.stored,
                "driven": energy.driven,
                "dissipated": energy.dissipated,
                "settling": energy.settling,
                "exchanged": energy.exchanged,
                "drift": energy.drift,
                "drift_share": energy.drift_share(),
            })),
            "parameters": parameters,
            "work": self.outcome.counters,
            "points": points,
            "notes": self.notes,
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let has_yoke = self.outcome.samples.iter().any(|sample| sample.yoke.is_some());
        let yoke_header = has_yoke.then_some(YOKE_COLUMNS).into_iter().flatten();
        let names: Vec<_> = COLUMNS.iter().map(|(name, _)| *name).chain(yoke_header).collect();
        fact::rows(&self.json(), "points", &names.join(" "))
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = titled(self.title);
        if let Some(table) = self.steady_table() {
            blocks.extend([table, Block::Note(format!("elastic part: {}", self.elastic_part()))]);
        }
        if let Some(width) = self.screen.drawing_width() {
            let points: Vec<_> = self.outcome.samples.iter().map(|s| (s.stroke_mm, tidy(s.delta_cd_mm))).collect();
            blocks.extend(sketch::sketch(&points, width, 8).map(Block::Drawing));
        }
        let given = self.given();
        let given: Vec<_> = given
            .iter()
            .map(|(name, value)| format!("{name} {} {}", short(*value), name.unit()).trim_end().to_owned())
            .collect();
        blocks.push(Block::Note(format!("model: {}", self.how())));
        blocks.push(Block::Note(format!("parameters: {}", given.join(", "))));
        blocks.push(Block::Note(format!("work: {}", self.work())));
        if let Some(energy) = self.outcome.energy.filter(|_| self.outcome.samples.len() > 1) {
            blocks.push(Block::Note(self.energy(&energy)));
        }
        blocks.extend(self.notes.iter().cloned().map(Block::Remark));
        blocks.extend(self.ending().1.map(Block::Note));
        blocks
    }
}
