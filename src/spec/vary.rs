//! The exact mesh of a spec where nothing is left to place, and its uncertainty, from meshes in which one uncertain value is
//! off.

use std::ops::Range;
use std::sync::Arc;

use super::value::Value;
use super::{MeasuredTables, MeshInput, Origin, Spec, WrittenError};
use crate::deviation::{DeviationKind, DeviationValue, Part, PinionDeviationKind, RackDeviationKind};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::PartDeviation;
use crate::formula::law::RADIANS_PER_DEGREE;
use crate::judge::bound::{ExtendedError, KnownTeeth, NoBound, pinion_lead_angle_rad};
use crate::judge::strokes::{extremes, tolerance_mm};
use crate::mesh::{Mesh, MeshError};
use crate::quantity::{Angle, DomainError, Length};
use crate::table::{Measured, PinionTooth, RackSpace};
use crate::trig;
use crate::uncertainty::{Influence, TeethSensitivity, VariedTeeth, WITHIN, teeth_sensitivities};

/// The least change of a value, mm or degrees, that shows in a curve.
const LEAST: f64 = 1e-3;

/// The exact mesh of teeth that are known.
#[derive(Debug, Clone)]
pub struct SolvedTeeth {
    /// The extremes of the mesh.
    pub teeth: KnownTeeth,
    /// The derivatives of the extremes by uncertain values.
    pub sensitivities: Vec<TeethSensitivity>,
}

impl SolvedTeeth {
    /// The extremes of a mesh over some strokes, and how they change where values are off.
    fn new(mesh: &Mesh, strokes: &[Range<f64>], varied: &[VariedTeeth]) -> Result<Self, MeshError> {
        let tolerance_mm = tolerance_mm(mesh);
        let extremes = extremes(mesh, strokes, tolerance_mm)?;
        let sensitivities = teeth_sensitivities(mesh, &extremes, strokes, tolerance_mm, varied)?;
        Ok(Self { teeth: extremes.judged(mesh), sensitivities })
    }
}

/// A spec and its tables, one value of which may be changed.
#[derive(Clone)]
struct Whole {
    spec: Spec,
    tables: MeasuredTables,
}

/// One value of a spec or of its tables.
enum Variable<'a> {
    Length(&'a mut Length),
    Angle(&'a mut Angle),
    Mm(&'a mut f64),
    Rad(&'a mut f64),
    Slope(&'a mut f64),
}

impl Variable<'_> {
    /// Adds mm or degrees.
    ///
    /// # Errors
    /// If the value is too large.
    fn add(self, by: f64) -> Result<(), DomainError> {
        match self {
            Self::Length(value) => *value = Length::from_mm(value.mm() + by)?,
            Self::Angle(value) => *value = Angle::from_degrees(value.degrees() + by)?,
            Self::Mm(value) => *value += by,
            Self::Rad(value) => *value += by * RADIANS_PER_DEGREE,
            Self::Slope(value) => *value = trig::tan(trig::atan(*value) + by * RADIANS_PER_DEGREE),
        }
        Ok(())
    }
}

impl Spec {
    /// The spec with the effect of the teeth that it or `tables` give one by one, without any other error: over `strokes`, by
    /// `mesh`, which has both; and with the derivatives of that effect by uncertain values.
    ///
    /// # Errors
    /// Diagnostics as [`mesh`](Self::mesh), or if a stroke has no solution.
    pub fn with_known_teeth(
        mut self,
        tables: &MeasuredTables,
        mesh: &Mesh,
        strokes: &[Range<f64>],
    ) -> Result<Self, Diagnostics> {
        let mesh_of = |whole: &Whole| whole.spec.mesh(&whole.tables).map(Some);
        let varied = self.varied(tables, &[1.0], mesh_of)?;
        let SolvedTeeth { teeth, sensitivities } = SolvedTeeth::new(mesh, strokes, &varied)?;
        let known = self.known_of_teeth(tables).into_iter();
        self.teeth_taken_as_exact = known.filter(|kind| !self.is_uncertain(*kind)).collect();
        (self.known_teeth, self.teeth_sensitivities) = (Some(teeth), sensitivities);
        self.measured = Arc::new(tables.clone());
        Ok(self)
    }

    /// The errors of a part, if every one of them is on all teeth alike and the geometry is known: nothing is left to place.
    ///
    /// # Errors
    /// Diagnostics as [`part_deviations`](Self::part_deviations).
    fn on_all_teeth(&self) -> Result<Option<Vec<PartDeviation>>, Diagnostics> {
        if !self.missing_geometry().is_empty() || (self.errors.is_empty() && self.has_deviations()) {
            return Ok(None);
        }
        let errors = self.part_errors_or_none()?;
        let is_placed = |error| ExtendedError::of(error).is_ok_and(|error| error.is_on_all_teeth());
        Ok(errors.iter().all(is_placed).then_some(errors))
    }

    /// The mesh with every error of `[errors]` on all teeth, and the single teeth of `tables` and the spec; `None` where an error
    /// is left to place.
    ///
    /// # Errors
    /// Diagnostics as [`mesh`](Self::mesh).
    pub fn mesh_of_all_teeth(&self, tables: &MeasuredTables) -> Result<Option<MeshInput>, Diagnostics> {
        let Some(errors) = self.on_all_teeth()? else { return Ok(None) };
        let origin = if errors.is_empty() { Origin::Teeth } else { Origin::AllTeeth };
        self.mesh_with(self.pair("the exact mesh")?, &errors, origin, tables).map(Some)
    }

    /// The exact mesh of a part with nothing left to place, over all strokes at which deviated teeth can carry; `None` where an
    /// error is left to place, or why the mesh has no solution.
    #[must_use]
    pub fn solved(&self) -> Option<Result<SolvedTeeth, String>> {
        let solved = self.mesh_of_all_teeth(&self.measured).transpose()?.and_then(|input| {
            let mesh_of = |whole: &Whole| whole.spec.mesh_of_all_teeth(&whole.tables);
            // an error near 0 may lift with either sign; on a flank with form, the larger the error the more it lifts
            let varied = self.varied(&self.measured, &WITHIN, mesh_of)?;
            Ok(SolvedTeeth::new(&input.mesh, &input.judged_strokes()?, &varied)?)
        });
        Some(match solved {
            Ok(solved) if solved.teeth.solved => Ok(solved),
            Ok(_) => Err(NoBound::NotSolved.to_string()),
            Err(Diagnostics(why)) => Err(why.iter().map(Diagnostic::sentence).collect::<Vec<_>>().join("; ")),
        })
    }

    /// The single teeth of this spec or its tables.
    fn known_of_teeth(&self, tables: &MeasuredTables) -> Vec<DeviationKind> {
        let mut whole = Whole { spec: self.clone(), tables: tables.clone() };
        DeviationKind::ALL.into_iter().filter(|kind| !whole.values(Influence::Error(*kind)).is_empty()).collect()
    }

    /// The errors that the spec gives or asks for of a part in `tables`, without those that the tables have.
    #[must_use]
    pub fn not_in_tables(&self, part: Part, tables: &MeasuredTables) -> Vec<DeviationKind> {
        let measured = self.measured_only(part).known_of_teeth(tables);
        let of_teeth = self.known_of_teeth(&MeasuredTables::default());
        let is_said = |kind: &DeviationKind| self.speaks_of(*kind) || of_teeth.contains(kind);
        DeviationKind::ALL
            .into_iter()
            .filter(|kind| kind.part() == part && is_said(kind) && !measured.contains(kind))
            .collect()
    }

    /// The meshes in which one uncertain value after the other is off by about so many standard uncertainties: sizes of the gear,
    /// and every value of the teeth that are known one by one. Measured teeth have one value each; a deviation of some teeth is
    /// one value for all of them.
    ///
    /// # Errors
    /// Diagnostics as [`mesh`](Self::mesh).
    fn varied(
        &self,
        tables: &MeasuredTables,
        within: &[f64],
        mesh_of: impl Fn(&Whole) -> Result<Option<MeshInput>, Diagnostics>,
    ) -> Result<Vec<VariedTeeth>, Diagnostics> {
        let whole = Whole { spec: self.clone(), tables: tables.clone() };
        let mut varied = Vec::new();
        for (source, uncertainty) in &self.uncertainties {
            if uncertainty.value.standard == 0.0 {
                continue;
            }
            let (source, standard) = (*source, uncertainty.value.standard);
            let by = standard.max(LEAST);
            let count = whole.clone().values(source).len();
            for index in 0..count {
                let mut off = Vec::new();
                for by in within.iter().map(|so_many| so_many * by) {
                    let other = whole.with_value_off(source, index, by)?;
                    off.extend(mesh_of(&other)?.map(|input| (by, input.mesh)));
                }
                varied.push(VariedTeeth { source, standard, off });
            }
        }
        Ok(varied)
    }
}

impl Whole {
    /// The spec and tables with one value of this kind off by mm or degrees.
    fn with_value_off(&self, source: Influence, index: usize, by: f64) -> Result<Self, Diagnostics> {
        let mut off = self.clone();
        let Some(value) = off.values(source).into_iter().nth(index) else { return Ok(off) };
        // f_Hβ of a pinion is a length; single teeth have the angle for it
        let is_slope = source == Influence::Error(DeviationKind::PinionLead);
        let step = if is_slope && !matches!(value, Variable::Length(_)) {
            pinion_lead_angle_rad(&self.spec.pair("the exact mesh")?, by) / RADIANS_PER_DEGREE
        } else {
            by
        };
        value.add(step).map_err(Diagnostic::with_code(Code::OutOfDomain))?;
        Ok(off)
    }

    /// The values of this kind.
    fn values(&mut self, source: Influence) -> Vec<Variable<'_>> {
        let (spec, tables) = (&mut self.spec, &mut self.tables);
        match source {
            Influence::Roller => {
                spec.errors.iter_mut().filter_map(|(_, written)| of_roller(&mut written.value)).collect()
            }
            Influence::Error(kind) => {
                let errors = spec.errors.iter_mut().filter(|(other, _)| *other == kind);
                let errors = errors.filter_map(|(_, written)| of_error(&mut written.value));
                let single: Vec<_> = if kind.part() == Part::Rack {
                    let written = spec.rack_deviations.iter_mut();
                    let written = written.filter_map(|deviation| of_rack(kind, &mut deviation.value.kind));
                    let rows = tables.rack.iter_mut().flat_map(|table| &mut table.rows);
                    written.chain(rows.filter_map(|row| of_space(kind, row))).collect()
                } else {
                    let written = spec.pinion_deviations.iter_mut();
                    let written = written.filter_map(|deviation| of_pinion(kind, &mut deviation.value.kind));
                    let rows = tables.pinion.iter_mut().flat_map(|table| &mut table.rows);
                    written.chain(rows.flat_map(|row| of_tooth(kind, row))).collect()
                };
                errors.chain(single).collect()
            }
            size => match spec.values.at_mut(size.key()) {
                Some(Value::Length(length)) => vec![Variable::Length(length)],
                Some(Value::Angle(angle)) => vec![Variable::Angle(angle)],
                _ => Vec::new(),
            },
        }
    }
}

fn of_error(error: &mut WrittenError) -> Option<Variable<'_>> {
    match error {
        WrittenError::Value(DeviationValue::Length(length)) | WrittenError::OverRoller { measured: length, .. } => {
            Some(Variable::Length(length))
        }
        WrittenError::Value(DeviationValue::Angle(angle)) => Some(Variable::Angle(angle)),
        WrittenError::Value(DeviationValue::Slope(slope)) => Some(Variable::Slope(slope)),
        WrittenError::Tolerance(_) | WrittenError::Class(_) => None,
    }
}

const fn of_roller(error: &mut WrittenError) -> Option<Variable<'_>> {
    match error {
        WrittenError::OverRoller { roller, .. } => Some(Variable::Length(roller)),
        _ => None,
    }
}

fn of_rack(kind: DeviationKind, deviation: &mut RackDeviationKind) -> Option<Variable<'_>> {
    use RackDeviationKind::{Lead, Left, OverRoller, Pitch, Right, Shift, Thickness};
    match (kind, deviation) {
        // a thickness is measured over a roller, a flank side as a pitch
        (DeviationKind::RackOverRoller, OverRoller(mm) | Thickness(mm))
        | (DeviationKind::RackPitch, Pitch(mm) | Shift(mm) | Left(mm) | Right(mm)) => Some(Variable::Mm(mm)),
        (DeviationKind::RackLead, Lead(rad)) => Some(Variable::Rad(rad)),
        _ => None,
    }
}

fn of_pinion(kind: DeviationKind, deviation: &mut PinionDeviationKind) -> Option<Variable<'_>> {
    use PinionDeviationKind::{Eccentricity, Lead, Left, Radial, Right, Shift, Thickness};
    match (kind, deviation) {
        (DeviationKind::PinionRadial, Radial(mm) | Thickness(mm) | Eccentricity(mm))
        | (DeviationKind::PinionPitch, Shift(mm) | Left(mm) | Right(mm)) => Some(Variable::Mm(mm)),
        (DeviationKind::PinionLead, Lead(rad)) => Some(Variable::Rad(rad)),
        _ => None,
    }
}

fn of_space(kind: DeviationKind, row: &mut RackSpace) -> Option<Variable<'_>> {
    let measured = match kind {
        DeviationKind::RackOverRoller => row.over_pin.as_mut(),
        DeviationKind::RackPitch => row.position.as_mut(),
        DeviationKind::RackLead => return row.lead.as_mut().map(Variable::Angle),
        _ => None,
    };
    measured.map(|(Measured::Absolute(length) | Measured::Deviation(length))| Variable::Length(length))
}

fn of_tooth(kind: DeviationKind, row: &mut PinionTooth) -> Vec<Variable<'_>> {
    let lengths = match kind {
        DeviationKind::PinionRadial => [row.radial.as_mut(), None, None],
        DeviationKind::PinionPitch => [row.position.as_mut(), row.left_pitch.as_mut(), row.right_pitch.as_mut()],
        DeviationKind::PinionLead => return row.lead.iter_mut().map(Variable::Angle).collect(),
        _ => [None, None, None],
    };
    lengths.into_iter().flatten().map(Variable::Length).collect()
}
