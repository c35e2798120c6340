//! The paper's Tables 1 to 3 and its last figure, computed again: by its formulas, by the exact mesh, and by the
//! multibody model.
//!
//! Called by the report of `rackmesh reproduce`. Holds the values that the paper prints and the gear data that are chosen
//! here, and computes; the words are the report's.
//!
//! The paper publishes no gear data. α_n = 19.9° and k = 19.7 mm reproduce every analytic entry to its last digit. The
//! other data are those of one pair, found by a search for the multibody column of Table 1 ([`pair`]). Its accumulated pitch
//! errors agree with that column to 1.6 µm rms. The agreement confirms nothing: other pairs fit as well.

use std::sync::Mutex;

use crate::deviation::{
    DeviationError, DeviationValue, FIRST_ODD_TOOTH, PinionFlanks, RackDeviation, RackDeviationKind, RackFlanks,
    ToothRange,
};
use crate::formula::{Law, Model};
use crate::gear::{GeometryError, Pair, PairData, PinionData, RackData};
use crate::mesh::MeshError;
use crate::multibody::{Outcome, Parameters, Scene, SimulationError, Support, exact_mean_mm};
use crate::parallel;
use crate::quantity::{Angle, DomainError, Length};

/// Normal pressure angle α_n with which the formulas give the analytic columns; any above 19.872° and up to 19.983° does.
pub const PRESSURE_ANGLE: &str = "19.9°";
/// Face width k of the rack with which they do at that angle: k / (2 tan α_n) lies between 27.158 and 27.215 mm.
pub const FACE_WIDTH: &str = "19.7 mm";
/// Depth of the axis of the rack's cylindrical joint below the reference plane, mm; chosen here.
pub const ROLL_AXIS_DEPTH_MM: f64 = 8.0;

/// A table of the paper, by its error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PaperTable {
    /// Table 1: every pitch of the second rack part is off by Δp; its teeth are thicker by Δp/2.
    Pitch,
    /// Table 2: the lead of all teeth of the second part is off by Δβ.
    Lead,
    /// Table 3: the second part's measure over the roller is off by ΔM.
    OverRoller,
}

/// An entry as the paper prints it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Printed {
    /// Its table.
    pub table: PaperTable,
    /// The error, mm or degrees.
    pub error: &'static str,
    /// ΔCD by formula, mm.
    pub analytic: &'static str,
    /// ΔCD by the authors' multibody code, mm.
    pub multibody: &'static str,
}

const fn printed(table: PaperTable, error: &'static str, analytic: &'static str, multibody: &'static str) -> Printed {
    Printed { table, error, analytic, multibody }
}

/// Every entry of Tables 1 to 3, in the paper's order.
pub const PRINTED: [Printed; 18] = [
    printed(PaperTable::Pitch, "+0.01", "0.014", "0.017"),
    printed(PaperTable::Pitch, "+0.02", "0.028", "0.040"),
    printed(PaperTable::Pitch, "+0.03", "0.041", "0.059"),
    printed(PaperTable::Pitch, "-0.01", "0.014", "0.015"),
    printed(PaperTable::Pitch, "-0.02", "0.028", "0.034"),
    printed(PaperTable::Pitch, "-0.03", "0.041", "0.056"),
    printed(PaperTable::Lead, "0", "0", "0"),
    printed(PaperTable::Lead, "+0.25", "0.119", "0.115"),
    printed(PaperTable::Lead, "+0.5", "0.237", "0.231"),
    printed(PaperTable::Lead, "0", "0", "0"),
    printed(PaperTable::Lead, "-0.25", "0.119", "0.106"),
    printed(PaperTable::Lead, "-0.5", "0.237", "0.219"),
    printed(PaperTable::OverRoller, "+0.01", "+0.010", "+0.010"),
    printed(PaperTable::OverRoller, "+0.02", "+0.020", "+0.020"),
    printed(PaperTable::OverRoller, "+0.03", "+0.030", "+0.030"),
    printed(PaperTable::OverRoller, "-0.01", "-0.010", "-0.010"),
    printed(PaperTable::OverRoller, "-0.02", "-0.020", "-0.020"),
    printed(PaperTable::OverRoller, "-0.03", "-0.030", "-0.030"),
];

/// Why an entry has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReproductionError {
    /// A formula has no value.
    #[error(transparent)]
    Formula(#[from] DomainError),
    /// The pair is impossible.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The rack's deviations are impossible.
    #[error(transparent)]
    Deviation(#[from] DeviationError),
    /// The exact mesh has no solution.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The multibody model has no result.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

impl From<crate::quantity::QuantityError> for ReproductionError {
    fn from(error: crate::quantity::QuantityError) -> Self {
        Self::Formula(error.into())
    }
}

/// The pair chosen for the multibody column of Table 1: m_n = 2 mm, z = 8, β_p = 21°, β_r = 0, x = 0.3, rack addendum 1.7 mm,
/// pinion tip diameter 19.738 mm, pinion face width 23.5 mm.
///
/// # Errors
/// None that these numbers can cause.
pub fn pair() -> Result<Pair, ReproductionError> {
    let (pressure_angle, face_width): (Angle, Length) = (PRESSURE_ANGLE.parse()?, FACE_WIDTH.parse()?);
    Ok(Pair::new(&PairData {
        normal_module_mm: 2.0,
        normal_pressure_angle_rad: pressure_angle.radians(),
        rack: RackData {
            helix_angle_rad: 0.0,
            face_width_mm: face_width.mm(),
            addendum_mm: 1.7,
            tooth_thickness_mm: None,
        },
        pinion: PinionData {
            teeth: 8,
            helix_angle_rad: "21°".parse::<Angle>()?.radians(),
            profile_shift: 0.3,
            tip_diameter_mm: 19.738,
            root_form_diameter_mm: None,
            face_width_mm: 23.5,
            tooth_thickness_deviation_mm: 0.0,
        },
    })?)
}

impl Printed {
    /// ΔCD by the formula of the table.
    ///
    /// # Errors
    /// None that the printed values can cause.
    pub fn analytic(&self, model: Model) -> Result<Length, ReproductionError> {
        let pressure_angle: Angle = PRESSURE_ANGLE.parse()?;
        let (law, error): (Law, DeviationValue) = match self.table {
            PaperTable::Pitch => (Law::rack_pitch(pressure_angle, Angle::ZERO)?, self.error.parse::<Length>()?.into()),
            PaperTable::Lead => {
                let law = Law::rack_lead(pressure_angle, Angle::ZERO, FACE_WIDTH.parse()?)?;
                (law, self.error.parse::<Angle>()?.into())
            }
            PaperTable::OverRoller => (Law::rack_over_roller(), self.error.parse::<Length>()?.into()),
        };
        Ok(law.delta_cd(error, model)?)
    }

    /// The formula's value, mm, with the decimals of the paper's entry, and its plus sign where the paper prints one.
    ///
    /// # Errors
    /// As [`Printed::analytic`].
    pub fn rounded(&self) -> Result<String, ReproductionError> {
        let decimals = self.analytic.split_once('.').map_or(0, |(_, fraction)| fraction.len());
        let mm = self.analytic(Model::Paper)?.mm();
        Ok(if self.analytic.starts_with('+') { format!("{mm:+.decimals$}") } else { format!("{mm:.decimals$}") })
    }

    /// The rack of the entry: nominal teeth, then teeth with the error.
    fn rack(&self, pair: &Pair) -> Result<RackFlanks, ReproductionError> {
        let kinds = match self.table {
            PaperTable::Pitch => {
                let pitch = self.error.parse::<Length>()?.mm();
                vec![RackDeviationKind::Pitch(pitch), RackDeviationKind::Thickness(0.5 * pitch)]
            }
            PaperTable::Lead => vec![RackDeviationKind::Lead(self.error.parse::<Angle>()?.radians())],
            PaperTable::OverRoller => vec![RackDeviationKind::OverRoller(self.error.parse::<Length>()?.mm())],
        };
        let teeth = ToothRange::starting_at(FIRST_ODD_TOOTH);
        let deviations: Vec<_> = kinds.into_iter().map(|kind| RackDeviation { teeth, kind }).collect();
        Ok(RackFlanks::new(pair, &deviations)?)
    }

    /// The entry by the exact mesh and by the multibody model. `watch` gets the share of the work that each sample adds.
    ///
    /// # Errors
    /// [`ReproductionError`] if the mesh has no solution at a stroke or the simulation does not complete.
    pub fn simulate(&self, watch: &dyn Fn(f64)) -> Result<SimulatedRow, ReproductionError> {
        let pair = pair()?;
        let rack = self.rack(&pair)?;
        let pinion = PinionFlanks::nominal(&pair);
        let support = Support::FreeRoll { axis_depth_mm: ROLL_AXIS_DEPTH_MM };
        let parameters = Parameters { support, ..Parameters::default() };
        let scene = Scene::new(pair, rack, pinion, parameters)?.with_second_part(FIRST_ODD_TOOTH);
        let share = parameters.spacing_mm / parameters.stroke_mm;
        let outcome = scene.dynamic(&mut |_| {
            watch(share);
            std::ops::ControlFlow::Continue(())
        });
        let mean = |steady| exact_mean_mm(scene.mesh(), &steady);
        let means = outcome.nominal.and_then(mean).zip(outcome.deviating.and_then(mean));
        let exact_mm = means.map(|(nominal, deviating)| deviating - nominal);
        let multibody_mm = outcome.difference_mm();
        Ok(SimulatedRow { exact_mm, multibody_mm, outcome })
    }
}

/// An entry by the exact mesh and by the multibody model.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedRow {
    /// Mean ΔCD of the second rack part less that of the first, by the exact mesh, mm.
    pub exact_mm: Option<f64>,
    /// The same by the multibody model, mm.
    pub multibody_mm: Option<f64>,
    /// The whole run.
    pub outcome: Outcome,
}

/// Simulates every entry, on all cores; entries of the same error once. `watch` gets the share that is done, 0 to 1.
#[must_use]
pub fn simulate_all(watch: &(dyn Fn(f64) + Sync)) -> Vec<Result<SimulatedRow, ReproductionError>> {
    let first_alike =
        |row: &Printed| PRINTED.iter().position(|other| (other.table, other.error) == (row.table, row.error));
    let mut distinct: Vec<usize> = PRINTED.iter().filter_map(first_alike).collect();
    distinct.sort_unstable();
    distinct.dedup();
    // lead errors take longest, because the rack rolls: they start first
    distinct.sort_by_key(|index| PRINTED[*index].table != PaperTable::Lead);
    let done = Mutex::new(0.0);
    let add = |share: f64| {
        let mut done = parallel::lock(&done);
        *done += share / distinct.len() as f64;
        watch(*done);
    };
    let simulate = |(): &mut (), index: usize| PRINTED[distinct[index]].simulate(&add);
    let made = parallel::map(parallel::cores(), distinct.len(), || (), simulate).0;
    let of_row =
        |row| distinct.iter().position(|index| Some(*index) == first_alike(row)).map(|place| made[place].clone());
    PRINTED.iter().filter_map(of_row).collect()
}
