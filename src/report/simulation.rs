//! The report of `simulate`: extremes, forces and positions in time, the steady values of both rack parts with the exact
//! mesh beside them, and what rigid teeth of the same errors are judged.

use serde_json::{Map, Value, json};

use super::number::{millimetres, plain, signed, stroke_text, tidy};
use super::{Block, Report, Screen, Table, fact, mesh, sketch, titled, worst_last};
use crate::evaluation::Evaluation;
use crate::judge::Verdict;
use crate::multibody::{
    ContactModel, Energy, Outcome, ParameterName, Parameters, RunEnd, RunForces, Sample, Steady, Support,
};

/// A simulated stroke.
#[derive(Debug)]
pub struct SimulationReport<'a> {
    /// The spec's title.
    pub title: Option<&'a str>,
    /// The scene.
    pub parameters: &'a Parameters,
    /// Inertia of the pinion's rotation, mass of what moves along Z, inertia of the rack's roll, in N s²/mm and N mm
    /// s², as the scene took or computed them.
    pub inertias: [f64; 3],
    /// Whether it was solved as an equilibrium at each stroke.
    pub quasi_static: bool,
    /// The result.
    pub outcome: &'a Outcome,
    /// The exact mesh, averaged over the same strokes as the steady value of the nominal and of the
    /// deviating teeth, mm.
    pub exact_mm: [Option<f64>; 2],
    /// The errors judged by the limits: rigid teeth on all strokes, as in [`MeshReport`](super::MeshReport).
    pub evaluation: Evaluation,
    /// The limits that this command does not judge, in words.
    pub open: Option<String>,
    /// Remarks.
    pub notes: Vec<String>,
    /// Room for the sketch, which is drawn on a screen only.
    pub screen: Screen,
}

/// A column of the listing: its name, and the value at a position.
type Listed = (&'static str, fn(&Sample) -> Value);

const COLUMNS: &[Listed] = &[
    ("time_s", |s| number(s.time_s)),
    ("stroke_mm", |s| number(s.stroke_mm)),
    ("delta_cd_mm", |s| number(s.delta_cd_mm)),
    ("center_distance_mm", |s| number(s.center_distance_mm)),
    ("pinion_angle_deg", |s| number(s.pinion_angle_rad.to_degrees())),
    ("roll_deg", |s| number(s.roll_rad.to_degrees())),
    ("normal_force_right_n", |s| number(s.normal_force_right_n)),
    ("normal_force_left_n", |s| number(s.normal_force_left_n)),
    ("contacts", |s| s.contacts.into()),
    ("penetration_mm", |s| number(s.penetration_mm)),
    ("indentation_mm", |s| number(s.indentation_mm)),
    ("rack_force_n", |s| number(s.rack_force_n)),
    ("pinion_torque_n_m", |s| number(s.pinion_torque_n_m)),
    ("driven_n_mm", |s| number(s.driven_n_mm)),
    ("right_tooth", |s| s.carrying[0].into()),
    ("left_tooth", |s| s.carrying[1].into()),
    ("yoke_travel_mm", |s| s.yoke.map(|yoke| number(yoke.travel_mm)).into()),
    ("yoke_force_n", |s| s.yoke.map(|yoke| number(yoke.force_n)).into()),
    ("bush_force_n", |s| s.yoke.map(|yoke| number(yoke.bush_force_n)).into()),
];

/// How many of them, the last ones, are of a yoke.
const OF_YOKE: usize = 3;

fn number(value: f64) -> Value {
    json!(tidy(value))
}

/// A force for people, without a sign where it is zero.
fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(size) if size.bytes().all(|byte| matches!(byte, b'0' | b'.')) => size.to_owned(),
        _ => text,
    }
}

/// A number for people: a given one as it was written, a computed one to five digits.
fn short(value: f64) -> String {
    let text = plain(value);
    if text.len() <= 9 { text } else { plain(format!("{value:.4e}").parse().unwrap_or(value)) }
}

/// A computed number for people, to three digits.
fn three_digits(value: f64) -> String {
    plain(format!("{value:.2e}").parse().unwrap_or(value))
}

/// Largest error of the energy balance with short enough steps, as a share of its largest part.
const CLOSED_BALANCE: f64 = 0.1;

impl SimulationReport<'_> {
    /// The source of the elastic part of ΔCD.
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
        let mm = |value: f64| millimetres(tidy(value));
        let micrometres = |mm: f64| signed(1000.0 * mm, 3);
        // the simulated ΔCD, that with the indentation added back, and the exact mesh
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

    /// Where ΔCD is largest and smallest, and which teeth carry there.
    fn extremes_table(&self) -> Option<Block> {
        let [smallest, largest] = self.outcome.extremes()?;
        let tooth = |tooth: Option<i64>| tooth.map(|tooth| tooth.to_string()).unwrap_or_default();
        let rows = [("largest ΔCD", largest), ("smallest ΔCD", smallest)];
        let table = Table::of(rows)
            .text("over the stroke", |(name, _)| *name)
            .number("simulated\n[mm]", |(_, at)| millimetres(tidy(at.delta_cd_mm)))
            .number("elastic part\n[µm]", |(_, at)| signed(-1000.0 * at.indentation_mm, 3))
            .number("at stroke\n[mm]", |(_, at)| stroke_text(at.stroke_mm))
            .number("right flank\nof rack tooth", |(_, at)| tooth(at.carrying[0]))
            .number("left flank\nof rack tooth", |(_, at)| tooth(at.carrying[1]));
        Some(table.block())
    }

    /// The forces there, and back if the rack comes back.
    fn forces_tables(&self) -> impl Iterator<Item = Block> {
        let back = self.outcome.forces_back();
        let there = self.outcome.forces().map(|forces| {
            let from = plain(tidy(forces.from_mm));
            (
                if back.is_some() { "forces, stroke rising".to_owned() } else { format!("forces, from {from} mm on") },
                forces,
            )
        });
        let back = back.map(|forces| ("forces, stroke falling".to_owned(), forces));
        there.into_iter().chain(back).map(|(heading, forces)| Self::forces_table(heading, forces))
    }

    fn forces_table(heading: String, forces: RunForces) -> Block {
        let rows = [
            ("normal, right flanks [N]", forces.normal_right_n, 1),
            ("normal, left flanks [N]", forces.normal_left_n, 1),
            ("drive of the rack [N]", forces.rack_n, 1),
            ("torque at the pinion [N m]", forces.pinion_torque_n_m, 4),
        ];
        Table::of(rows)
            .text(heading, |(name, ..)| *name)
            .number("mean", |(_, force, decimals)| fixed(force.mean, *decimals))
            .number("smallest", |(_, force, decimals)| fixed(force.smallest, *decimals))
            .number("at stroke\n[mm]", |(_, force, _)| stroke_text(force.smallest_stroke_mm))
            .number("largest", |(_, force, decimals)| fixed(force.largest, *decimals))
            .number("at stroke\n[mm]", |(_, force, _)| stroke_text(force.largest_stroke_mm))
            .block()
    }

    /// The columns of the listing that the run has.
    fn columns(&self) -> &'static [Listed] {
        let has_yoke = matches!(self.parameters.support, Support::Yoke(_));
        &COLUMNS[..COLUMNS.len() - if has_yoke { 0 } else { OF_YOKE }]
    }

    fn point(&self, sample: &Sample) -> Value {
        self.columns().iter().map(|(name, value)| ((*name).to_owned(), value(sample))).collect()
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
        format!("{support}; {contact}; {time}{}", if p.returns { "; there and back" } else { "" })
    }

    /// The parameters of the run and its masses, as text.
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
        let parameters: Map<_, _> = self
            .given()
            .into_iter()
            .map(|(name, value)| (name.name().to_owned(), json!({ "value": value, "unit": name.unit() })))
            .collect();
        let [(_, nominal, exact_nominal), (_, deviating, exact_deviating)] = self.parts();
        let [smallest, largest] = self.outcome.extremes().map(|two| two.map(|at| self.point(at))).unwrap_or_default();
        let energy = self.outcome.energy.map(|energy| {
            let mut fact = json!(energy);
            fact["drift_share"] = energy.drift_share().into();
            fact
        });
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
            "smallest": smallest,
            "largest": largest,
            "forces": self.outcome.forces(),
            "forces_falling": self.outcome.forces_back(),
            "judged_mm": self.evaluation.judged.ok(),
            "judged_by": self.evaluation.judged_by.name(),
            "verdict": self.evaluation.verdict.map(Verdict::name),
            "reason": self.evaluation.open_because(),
            "energy_n_mm": energy,
            "parameters": parameters,
            "work": self.outcome.counters,
            "points": self.outcome.samples.iter().map(|sample| self.point(sample)).collect::<Vec<_>>(),
            "notes": self.notes,
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let names: Vec<_> = self.columns().iter().map(|(name, _)| *name).collect();
        fact::rows(&self.json(), "points", &names.join(" "))
    }

    fn blocks(&self) -> Vec<Block> {
        let mut blocks = titled(self.title);
        blocks.extend(self.steady_table());
        blocks.extend(self.extremes_table());
        blocks.extend(self.forces_tables());
        blocks.push(Block::Note(format!("elastic part: {}", self.elastic_part())));
        if let Some(width) = self.screen.drawing_width() {
            let there = &self.outcome.samples[..self.outcome.there];
            let points: Vec<_> = there.iter().map(|s| (s.stroke_mm, tidy(s.delta_cd_mm))).collect();
            blocks.extend(sketch::sketch(&points, "ΔCD [mm]", [width, 8]).map(Block::Drawing));
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
        blocks.extend(mesh::verdicts(&self.evaluation));
        let ended = self.ending().1.map(|why| match self.outcome.end {
            RunEnd::Failed(_) => Block::Verdict(None, why),
            _ => Block::Note(why),
        });
        blocks.extend(self.open.iter().map(|open| Block::Verdict(None, open.clone())).chain(ended));
        worst_last(blocks)
    }
}
