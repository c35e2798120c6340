//! The exact mesh of a spec in which one uncertain value is off: what the uncertainty of known teeth follows from.
//! Solves nothing.

use std::ops::Range;

use super::value::Value;
use super::{MeasuredTables, Spec};
use crate::deviation::{DeviationKind, Part, PinionDeviationKind, RackDeviationKind};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::law::RADIANS_PER_DEGREE;
use crate::judge::bound::pinion_lead_angle_rad;
use crate::judge::strokes::{extremes, tolerance_mm};
use crate::mesh::Mesh;
use crate::quantity::{Angle, DomainError, Length};
use crate::table::{Measured, PinionTooth, RackSpace};
use crate::uncertainty::{Influence, VariedTeeth, teeth_sensitivities};

/// By how much a value is off at least, mm or degrees, so that a curve tells it.
const LEAST: f64 = 1e-3;

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
}

impl Variable<'_> {
    /// Adds mm or degrees.
    ///
    /// # Errors
    /// If no value is as large.
    fn add(self, by: f64) -> Result<(), DomainError> {
        match self {
            Self::Length(value) => *value = Length::from_mm(value.mm() + by)?,
            Self::Angle(value) => *value = Angle::from_degrees(value.degrees() + by)?,
            Self::Mm(value) => *value += by,
            Self::Rad(value) => *value += by * RADIANS_PER_DEGREE,
        }
        Ok(())
    }
}

impl Spec {
    /// The same spec with what the teeth do that it or `tables` know one by one, without any other error: over `strokes`, by
    /// `mesh`, which is that of both. With it how that follows from what is uncertain.
    ///
    /// # Errors
    /// Diagnostics as [`mesh`](Self::mesh), or if a stroke has no solution.
    pub fn with_known_teeth(
        mut self,
        tables: &MeasuredTables,
        mesh: &Mesh,
        strokes: &[Range<f64>],
    ) -> Result<Self, Diagnostics> {
        let tolerance_mm = tolerance_mm(mesh);
        let extremes = extremes(mesh, strokes, tolerance_mm)?;
        self.teeth_sensitivities = teeth_sensitivities(mesh, &extremes, tolerance_mm, &self.varied(tables)?)?;
        let known = self.known_of_teeth(tables).into_iter();
        self.teeth_taken_as_exact = known.filter(|kind| !self.is_uncertain(*kind)).collect();
        self.known_teeth = Some(extremes.judged(mesh));
        Ok(self)
    }

    /// What this spec or its tables know of single teeth.
    fn known_of_teeth(&self, tables: &MeasuredTables) -> Vec<DeviationKind> {
        let mut whole = Whole { spec: self.clone(), tables: tables.clone() };
        DeviationKind::ALL.into_iter().filter(|kind| !whole.values(Influence::Error(*kind)).is_empty()).collect()
    }

    /// What the spec says or asks of a part whose teeth `tables` have, and these do not tell.
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

    /// The mesh with each uncertain value off by about its standard uncertainty, one after the other: sizes of the gear, and
    /// every value of the teeth that are known one by one. What is measured tooth by tooth is one value for each of
    /// them, what a deviation gives for some teeth is one for all of these.
    ///
    /// # Errors
    /// Diagnostics as [`mesh`](Self::mesh).
    fn varied(&self, tables: &MeasuredTables) -> Result<Vec<VariedTeeth>, Diagnostics> {
        let whole = Whole { spec: self.clone(), tables: tables.clone() };
        let mut varied = Vec::new();
        for (source, uncertainty) in &self.uncertainties {
            if uncertainty.value.standard == 0.0 {
                continue;
            }
            let (source, by) = (*source, uncertainty.value.standard.max(LEAST));
            // f_Hβ of a pinion is a length, and its teeth have the angle that this is
            let step = match source {
                Influence::Error(DeviationKind::PinionLead) => {
                    pinion_lead_angle_rad(&self.pair("the exact mesh")?, by) / RADIANS_PER_DEGREE
                }
                _ => by,
            };
            let count = whole.clone().values(source).len();
            for index in 0..count {
                let mut off = whole.clone();
                if let Some(value) = off.values(source).into_iter().nth(index) {
                    let varied = value.add(step);
                    varied.map_err(Diagnostic::with_code(Code::OutOfDomain))?;
                }
                varied.push(VariedTeeth { source, by, mesh: off.spec.mesh(&off.tables)?.mesh });
            }
        }
        Ok(varied)
    }
}

impl Whole {
    /// The values of this kind.
    fn values(&mut self, source: Influence) -> Vec<Variable<'_>> {
        let (spec, tables) = (&mut self.spec, &mut self.tables);
        match source {
            // of errors that are given as one value
            Influence::Roller => Vec::new(),
            Influence::Error(kind) if kind.part() == Part::Rack => {
                let written = spec.rack_deviations.iter_mut();
                let written = written.filter_map(|deviation| of_rack(kind, &mut deviation.value.kind));
                let rows = tables.rack.iter_mut().flat_map(|table| &mut table.rows);
                written.chain(rows.filter_map(|row| of_space(kind, row))).collect()
            }
            Influence::Error(kind) => {
                let written = spec.pinion_deviations.iter_mut();
                let written = written.filter_map(|deviation| of_pinion(kind, &mut deviation.value.kind));
                let rows = tables.pinion.iter_mut().flat_map(|table| &mut table.rows);
                written.chain(rows.flat_map(|row| of_tooth(kind, row))).collect()
            }
            size => match spec.values.at_mut(size.key()) {
                Some(Value::Length(length)) => vec![Variable::Length(length)],
                Some(Value::Angle(angle)) => vec![Variable::Angle(angle)],
                _ => Vec::new(),
            },
        }
    }
}

fn of_rack(kind: DeviationKind, deviation: &mut RackDeviationKind) -> Option<Variable<'_>> {
    use RackDeviationKind::{Lead, OverRoller, Pitch, Shift};
    match (kind, deviation) {
        (DeviationKind::RackOverRoller, OverRoller(mm)) | (DeviationKind::RackPitch, Pitch(mm) | Shift(mm)) => {
            Some(Variable::Mm(mm))
        }
        (DeviationKind::RackLead, Lead(rad)) => Some(Variable::Rad(rad)),
        _ => None,
    }
}

fn of_pinion(kind: DeviationKind, deviation: &mut PinionDeviationKind) -> Option<Variable<'_>> {
    use PinionDeviationKind::{Lead, Radial, Shift};
    match (kind, deviation) {
        (DeviationKind::PinionRadial, Radial(mm)) | (DeviationKind::PinionPitch, Shift(mm)) => Some(Variable::Mm(mm)),
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
