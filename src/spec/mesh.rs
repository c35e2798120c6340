//! What a spec means for the exact mesh: the pair, its deviations, and the rack's support. Called by the subcommands
//! that solve the mesh or simulate; it gets the text of measured tables from its caller, opens no file and solves
//! nothing.

use std::collections::BTreeSet;
use std::ops::Range;

use super::resolve::MissingKeys;
use super::{Located, Spec, WrittenPinionDeviation};
use crate::deviation::plausible;
use crate::deviation::{
    DeviationKind, DeviationValue, PinionDeviation, PinionDeviationKind, PinionFlanks, PinionToothRow, RackDeviation,
    RackDeviationKind, RackFlanks, RackSpaceRow, ToothRange, pinion_flanks_from_rows, rack_flanks_from_spaces,
};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::PartDeviation;
use crate::formula::over_pin::OverPin;
use crate::gear::{GeometryError, GeometryWarning, Pair, PairData, PinionData, Quantity, RackData};
use crate::judge::bound::pinion_lead_angle_rad;
use crate::judge::strokes::{DeviatedTeeth, StrokesError, judged_strokes};
use crate::mesh::{Mesh, Support};
use crate::quantity::{Angle, Length};
use crate::table::{Measured, PinionTeeth, RackSpaces};
use crate::trig;

/// The tables that a spec names, read by the caller.
#[derive(Debug, Clone, Default)]
pub struct MeasuredTables {
    /// `rack.measured`
    pub rack: Option<RackSpaces>,
    /// `pinion.measured`
    pub pinion: Option<PinionTeeth>,
}

/// Where the deviations of a mesh come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Origin {
    /// Deviations per tooth: `deviation` and `measured`; none at all is a perfect pair.
    Teeth,
    /// One value per error, from `[errors]`: put on the teeth as the formulas understand them.
    Errors,
}

/// A mesh and what its user should know.
#[derive(Debug, Clone)]
pub struct MeshInput {
    /// Ready to be solved.
    pub mesh: Mesh,
    /// Where its deviations come from.
    pub origin: Origin,
    /// What the geometry does badly.
    pub warnings: Vec<GeometryWarning>,
    /// The rack's deviations other than measured tables, for the formulas.
    pub rack_deviations: Vec<RackDeviation>,
    /// The pinion's deviations other than measured tables, for the formulas.
    pub pinion_deviations: Vec<WrittenPinionDeviation>,
    /// f_Hβ of the pinion that `[errors]` gives and the mesh has, for the formulas; mm.
    pub pinion_lead_mm: Option<f64>,
    /// The measured rows of the rack.
    pub rack_rows: Vec<RackSpaceRow>,
    /// The measured rows of the pinion.
    pub pinion_rows: Vec<PinionToothRow>,
    /// The spaces of a measured rack of which everything was measured that its table has a column for.
    pub whole_spaces: BTreeSet<i64>,
    /// The first tooth of a measured pinion of which something was not measured.
    pub unmeasured_tooth: Option<i64>,
}

/// The first rack tooth with a pitch or lead error that `[errors]` gives as one value: teeth before it are
/// sound, as in the paper's model.
const FIRST_ODD_TOOTH: i64 = 4;

impl MeshInput {
    /// The strokes at which a deviated tooth can carry.
    ///
    /// # Errors
    /// [`StrokesError`] if measured spaces do not cover one stretch, or a tooth of a measured pinion was left out.
    pub fn judged_strokes(&self) -> Result<Vec<Range<f64>>, StrokesError> {
        if let Some(tooth) = self.unmeasured_tooth {
            return Err(StrokesError::Tooth { tooth, teeth: self.mesh.pair().pinion().teeth });
        }
        if !self.rack_rows.is_empty() && self.whole_spaces.is_empty() {
            return Err(StrokesError::NotMeasured);
        }
        let teeth = DeviatedTeeth {
            rack: &self.rack_deviations,
            spaces: &self.whole_spaces,
            pinion: !self.pinion_deviations.is_empty() || !self.pinion_rows.is_empty(),
        };
        judged_strokes(self.mesh.pair(), &teeth)
    }

    /// The first space between the first and the last of a measured rack of which something was not measured.
    #[must_use]
    pub fn unmeasured_space(&self) -> Option<i64> {
        let spaces = || self.rack_rows.iter().map(|row| row.space);
        let (first, last) = spaces().min().zip(spaces().max())?;
        (first..=last).find(|space| !self.whole_spaces.contains(space))
    }
}

impl Spec {
    /// Whether the spec gives deviations per tooth.
    #[must_use]
    pub fn has_deviations(&self) -> bool {
        let (rack, pinion) = (&self.rack, &self.pinion);
        !rack.deviations.is_empty()
            || !pinion.deviations.is_empty()
            || rack.measured.is_some()
            || pinion.measured.is_some()
    }

    /// The nominal pair; `what` needs it.
    ///
    /// # Errors
    /// A diagnostic for each key that is missing, or for geometry that cannot mesh.
    pub fn pair(&self, what: &str) -> Result<Pair, Diagnostics> {
        let mut missing = MissingKeys::default();
        let who = || (what.to_owned(), None);
        let module = missing.take("pair", "normal_module", self.pair.normal_module.as_ref(), who);
        let alpha = missing.take("pair", "normal_pressure_angle", self.pair.normal_pressure_angle.as_ref(), who);
        let rack_face = missing.take("rack", "face_width", self.rack.face_width.as_ref(), who);
        let addendum = missing.take("rack", "addendum", self.rack.addendum.as_ref(), who);
        let teeth = missing.take("pinion", "teeth", self.pinion.teeth.as_ref(), who);
        let pinion_face = missing.take("pinion", "face_width", self.pinion.face_width.as_ref(), who);
        let tip = missing.take("pinion", "tip_diameter", self.pinion.tip_diameter.as_ref(), who);
        let (Some(module), Some(alpha), Some(rack_face), Some(addendum), Some(teeth), Some(pinion_face), Some(tip)) =
            (module, alpha, rack_face, addendum, teeth, pinion_face, tip)
        else {
            return Err(Diagnostics(missing.diagnostics(&self.source).collect()));
        };
        let radians = |angle: &Option<Located<Angle>>| angle.as_ref().map_or(0.0, |angle| angle.value.radians());
        let mm = |length: &Option<Located<Length>>| length.as_ref().map(|length| length.value.mm());
        let data = PairData {
            normal_module_mm: module.mm(),
            normal_pressure_angle_rad: alpha.radians(),
            rack: RackData {
                helix_angle_rad: radians(&self.rack.helix_angle),
                face_width_mm: rack_face.mm(),
                addendum_mm: addendum.mm(),
                tooth_thickness_mm: mm(&self.rack.tooth_thickness),
            },
            pinion: PinionData {
                teeth,
                helix_angle_rad: radians(&self.pinion.helix_angle),
                profile_shift: self.pinion.profile_shift.as_ref().map_or(0.0, |shift| shift.value),
                tip_diameter_mm: tip.mm(),
                root_form_diameter_mm: mm(&self.pinion.root_form_diameter),
                face_width_mm: pinion_face.mm(),
                tooth_thickness_deviation_mm: mm(&self.pinion.tooth_thickness_deviation).unwrap_or(0.0),
            },
        };
        Pair::new(&data).map_err(|error| self.bad_geometry(&error).into())
    }

    /// The mesh of the pair with everything that the spec says is wrong with it.
    ///
    /// Without deviations per tooth, the values in `[errors]` are put on the teeth: over-roller and radial
    /// errors on all of them, the rack's pitch and lead errors on the teeth from number 4 on, the pinion's
    /// pitch error as one step half way round, its lead error on all of its teeth.
    ///
    /// # Errors
    /// Diagnostics for missing keys, geometry that cannot mesh, and deviations that cannot be.
    pub fn mesh(&self, tables: &MeasuredTables) -> Result<MeshInput, Diagnostics> {
        let pair = self.pair("the exact mesh")?;
        let (mut rack_deviations, mut pinion_deviations): (Vec<_>, Vec<_>) = (
            self.rack.deviations.iter().map(|deviation| deviation.value).collect(),
            self.pinion.deviations.iter().map(|deviation| deviation.value).collect(),
        );
        let kinds: Vec<_> = self.errors.iter().map(|(kind, _)| *kind).collect();
        self.refuse_both_ways(&kinds)?;
        let origin = if self.has_deviations() || self.errors.is_empty() { Origin::Teeth } else { Origin::Errors };
        let mut pinion_lead_mm = None;
        if origin == Origin::Errors {
            let errors = self.part_deviations()?;
            (rack_deviations, pinion_deviations) = on_teeth(&errors, &pair);
            let lead = errors.iter().find(|error| error.kind() == DeviationKind::PinionLead);
            pinion_lead_mm = lead.map(|error| error.value().base());
        }
        let rack_rows = match &tables.rack {
            Some(spaces) => self.rack_rows(spaces, &pair)?,
            None => Vec::new(),
        };
        if let Some(teeth) = &tables.pinion {
            self.check_pinion_rows(teeth)?;
        }
        let pinion_rows = tables.pinion.as_ref().map(pinion_rows).unwrap_or_default();
        let rack = self.rack_flanks(&pair, &rack_deviations, &rack_rows, tables)?;
        let pinion = self.pinion_flanks(&pair, &pinion_deviations, &pinion_rows, tables)?;
        let support = self.support()?;
        let mesh = Mesh::new(pair, rack, pinion, support)
            .map_err(|error| Diagnostic::error(Code::OutOfDomain, error.to_string()))?;
        let warnings = pair.warnings();
        Ok(MeshInput {
            mesh,
            origin,
            warnings,
            rack_deviations,
            pinion_deviations,
            pinion_lead_mm,
            rack_rows,
            pinion_rows,
            whole_spaces: tables.rack.as_ref().map(RackSpaces::measured_spaces).unwrap_or_default(),
            unmeasured_tooth: tables.pinion.as_ref().and_then(|table| table.unmeasured(i64::from(pair.pinion().teeth))),
        })
    }

    pub(super) fn support(&self) -> Result<Support, Diagnostics> {
        if self.support.roll.as_ref().is_none_or(|roll| roll.value == "fixed") {
            return Ok(Support::Fixed);
        }
        let mut missing = MissingKeys::default();
        let place = self.support.roll.as_ref().map(|roll| (roll.span.clone(), String::new()));
        let depth = missing.take("support", "roll_axis_depth", self.support.roll_axis_depth.as_ref(), || {
            ("a rack that is free to roll".to_owned(), place)
        });
        match depth {
            Some(depth) => Ok(Support::FreeRoll { axis_depth_mm: depth.mm() }),
            None => Err(Diagnostics(missing.diagnostics(&self.source).collect())),
        }
    }

    fn rack_flanks(
        &self,
        pair: &Pair,
        deviations: &[RackDeviation],
        rows: &[RackSpaceRow],
        tables: &MeasuredTables,
    ) -> Result<RackFlanks, Diagnostic> {
        // each by itself first, so that the message points at the one that cannot be
        for written in &self.rack.deviations {
            RackFlanks::new(pair, &[written.value]).map_err(|error| self.bad_value(&error, written.span.clone()))?;
        }
        let whole = |error| self.bad_value(&error, 0..0);
        let measured = rack_flanks_from_spaces(pair, rows).map_err(whole)?;
        let in_table = |error: crate::deviation::DeviationError| match &tables.rack {
            Some(table) => Diagnostic::error(Code::BadTable, format!("{}: {error}", table.name)),
            None => self.bad_value(&error, 0..0),
        };
        let form = self.rack_form();
        let form_span = self.rack.tip_relief.as_ref().map(|relief| relief.span.clone());
        let form_span = form_span.or_else(|| self.rack.crowning.as_ref().map(|crowning| crowning.span.clone()));
        RackFlanks::new(pair, deviations)
            .map_err(whole)?
            .with_measured(measured)
            .map_err(in_table)?
            .with_form(pair, form)
            .map_err(|error| self.bad_value(&error, form_span.unwrap_or(0..0)))
    }

    fn pinion_flanks(
        &self,
        pair: &Pair,
        deviations: &[WrittenPinionDeviation],
        rows: &[PinionToothRow],
        tables: &MeasuredTables,
    ) -> Result<PinionFlanks, Diagnostic> {
        for written in &self.pinion.deviations {
            let checked = match written.value {
                WrittenPinionDeviation::Teeth(deviation) => PinionFlanks::new(pair, &[deviation]),
                WrittenPinionDeviation::Eccentricity(eccentricity) => {
                    PinionFlanks::nominal(pair).with_eccentricity(&[eccentricity])
                }
            };
            checked.map_err(|error| self.bad_value(&error, written.span.clone()))?;
        }
        let mut of_teeth = Vec::new();
        let mut eccentricities = Vec::new();
        for deviation in deviations {
            match deviation {
                WrittenPinionDeviation::Teeth(deviation) => of_teeth.push(*deviation),
                WrittenPinionDeviation::Eccentricity(eccentricity) => eccentricities.push(*eccentricity),
            }
        }
        let whole = |error| self.bad_value(&error, 0..0);
        let in_table = |error: crate::deviation::DeviationError| match &tables.pinion {
            Some(table) => Diagnostic::error(Code::BadTable, format!("{}: {error}", table.name)),
            None => self.bad_value(&error, 0..0),
        };
        let form = self.pinion_form();
        let form_span = self.pinion.profile_slope.as_ref().map(|slope| slope.span.clone());
        let measured = pinion_flanks_from_rows(pair, rows).map_err(in_table)?;
        PinionFlanks::new(pair, &of_teeth)
            .and_then(|flanks| flanks.with_eccentricity(&eccentricities))
            .map_err(whole)?
            .with_measured(&measured)
            .map_err(in_table)?
            .with_form(form)
            .map_err(|error| self.bad_value(&error, form_span.unwrap_or(0..0)))
    }

    fn bad_value(&self, error: &crate::deviation::DeviationError, span: Range<usize>) -> Diagnostic {
        let code = match error {
            crate::deviation::DeviationError::NoSuchTooth { .. } => Code::BadTeeth,
            _ => Code::OutOfDomain,
        };
        let diagnostic = Diagnostic::error(code, error.to_string());
        if span.is_empty() { diagnostic } else { diagnostic.at(&self.source, span, "") }
    }

    /// Refuses a table of a pinion with a deviation that no tooth can have.
    fn check_pinion_rows(&self, teeth: &PinionTeeth) -> Result<(), Diagnostic> {
        for row in &teeth.rows {
            let length = |length: Option<Length>| length.map(DeviationValue::Length);
            for (what, value) in [
                ("radial deviation", length(row.radial)),
                ("left pitch deviation", length(row.left_pitch)),
                ("right pitch deviation", length(row.right_pitch)),
                ("lead deviation", row.lead.map(DeviationValue::Angle)),
            ] {
                if let Some(diagnostic) = self.impossible_row(&teeth.name, row.line, what, value) {
                    return Err(diagnostic.help("check the unit of the column"));
                }
            }
        }
        Ok(())
    }

    /// Why a row of a table has no deviation, if it is impossible.
    fn impossible_row(&self, table: &str, line: u64, what: &str, value: Option<DeviationValue>) -> Option<Diagnostic> {
        let doubt = plausible::deviation(value?, self.module()).filter(|doubt| doubt.is_impossible)?;
        Some(Diagnostic::error(Code::Implausible, format!("{table}, line {line}: {what}: {doubt}")))
    }

    /// Measured values less their nominal ones.
    fn rack_rows(&self, spaces: &RackSpaces, pair: &Pair) -> Result<Vec<RackSpaceRow>, Diagnostics> {
        let absolute = spaces.rows.iter().find(|row| matches!(row.over_pin, Some(Measured::Absolute(_))));
        let nominal = match absolute {
            Some(_) => Some(self.nominal_over_pin()?),
            None => None,
        };
        let mut rows = Vec::with_capacity(spaces.rows.len());
        for row in &spaces.rows {
            let height = match (row.over_pin, nominal) {
                (Some(Measured::Deviation(length)), _) => length.mm(),
                (Some(Measured::Absolute(length)), Some(nominal)) => (length - nominal).mm(),
                _ => 0.0,
            };
            let deviation = Length::from_mm(height).ok().map(DeviationValue::Length);
            if let Some(diagnostic) = self.impossible_row(&spaces.name, row.line, "over-pin", deviation) {
                return Err(diagnostic.help("check the units, `rack.pin` and `rack.datum`").into());
            }
            // tooth indices are far below 2⁵³
            let nominal_position = (row.space as f64 + 0.5) * pair.rack().pitch_mm;
            let position = match &row.position {
                Some(Measured::Deviation(length)) => length.mm(),
                Some(Measured::Absolute(length)) => length.mm() - nominal_position,
                None => 0.0,
            };
            if position.abs() > pair.rack().pitch_mm / 2.0 {
                let message = format!(
                    "{}, line {}: the pin of space {} stands {position:.4} mm from its nominal position {nominal_position:.4} mm, more than half a pitch",
                    spaces.name, row.line, row.space
                );
                let diagnostic = Diagnostic::error(Code::OutOfDomain, message)
                    .help("space j is nominally at (j + 1/2) p_x; shift the positions, or give `position_deviation`");
                return Err(diagnostic.into());
            }
            rows.push(RackSpaceRow {
                space: row.space,
                height_mm: height,
                position_mm: position,
                lead_rad: row.lead.map(Angle::radians),
            });
        }
        Ok(rows)
    }

    /// The nominal measure over the pin: that of `errors.rack_over_roller`, or computed for `rack.pin`.
    ///
    /// # Errors
    /// Diagnostics for missing keys, or a thickness that leaves no space.
    pub fn nominal_over_pin(&self) -> Result<Length, Diagnostics> {
        let given = self.nominals.iter().find(|(kind, _)| *kind == DeviationKind::RackOverRoller);
        if let Some((_, Located { value: DeviationValue::Length(nominal), .. })) = given {
            return Ok(*nominal);
        }
        let mut missing = MissingKeys::default();
        let place = self.rack.measured.as_ref().map(|file| file.span.clone());
        let who = || {
            let place = place.clone().map(|span| (span, "has absolute over-pin values".to_owned()));
            ("the nominal measure over the pin".to_owned(), place)
        };
        let module = missing.take("pair", "normal_module", self.pair.normal_module.as_ref(), who);
        let alpha = missing.take("pair", "normal_pressure_angle", self.pair.normal_pressure_angle.as_ref(), who);
        let pin = missing.take("rack", "pin", self.rack.pin.as_ref(), who);
        let datum = missing.take("rack", "datum", self.rack.datum.as_ref(), who);
        let (Some(module), Some(alpha), Some(pin), Some(datum)) = (module, alpha, pin, datum) else {
            return Err(Diagnostics(missing.diagnostics(&self.source).collect()));
        };
        let over_pin = OverPin {
            normal_module: module,
            normal_pressure_angle: alpha,
            tooth_thickness: self.rack.tooth_thickness.as_ref().map(|thickness| thickness.value),
            pin_diameter: pin,
            datum,
        };
        over_pin.measure().map_err(|error| Diagnostic::error(Code::OutOfDomain, error.to_string()).into())
    }

    /// Geometry that cannot mesh, with the place of the value to blame.
    fn bad_geometry(&self, error: &GeometryError) -> Diagnostic {
        let span = match error {
            GeometryError::OutOfDomain { quantity, .. } => self.span_of(*quantity),
            GeometryError::PointedRack { .. } => self.span_of(Quantity::RackAddendum),
            GeometryError::NoRackSpace { .. } => self.span_of(Quantity::RackToothThickness),
            GeometryError::PointedPinion { .. } => self.span_of(Quantity::PinionTipDiameter),
            GeometryError::NoInvolute { .. } => self.span_of(Quantity::PinionRootFormDiameter),
        };
        let diagnostic = Diagnostic::error(Code::BadGeometry, error.to_string());
        match span {
            Some(span) => diagnostic.at(&self.source, span, ""),
            None => diagnostic,
        }
    }

    fn span_of(&self, quantity: Quantity) -> Option<Range<usize>> {
        fn span<T>(value: Option<&Located<T>>) -> Option<Range<usize>> {
            value.map(|value| value.span.clone())
        }
        match quantity {
            Quantity::NormalModule => span(self.pair.normal_module.as_ref()),
            Quantity::NormalPressureAngle => span(self.pair.normal_pressure_angle.as_ref()),
            Quantity::RackHelixAngle => span(self.rack.helix_angle.as_ref()),
            Quantity::RackFaceWidth => span(self.rack.face_width.as_ref()),
            Quantity::RackAddendum => span(self.rack.addendum.as_ref()),
            Quantity::RackToothThickness => span(self.rack.tooth_thickness.as_ref()),
            Quantity::PinionTeeth => span(self.pinion.teeth.as_ref()),
            Quantity::PinionHelixAngle => span(self.pinion.helix_angle.as_ref()),
            Quantity::PinionProfileShift => span(self.pinion.profile_shift.as_ref()),
            Quantity::PinionTipDiameter => span(self.pinion.tip_diameter.as_ref()),
            Quantity::PinionRootFormDiameter => span(self.pinion.root_form_diameter.as_ref()),
            Quantity::PinionFaceWidth => span(self.pinion.face_width.as_ref()),
            Quantity::PinionToothThicknessDeviation => span(self.pinion.tooth_thickness_deviation.as_ref()),
        }
    }
}

/// The rows of a pinion's table as deviations.
fn pinion_rows(teeth: &PinionTeeth) -> Vec<PinionToothRow> {
    let mm = |length: &Option<Length>| length.map(Length::mm);
    teeth
        .rows
        .iter()
        .map(|row| PinionToothRow {
            tooth: row.tooth,
            radial_mm: mm(&row.radial),
            position_mm: mm(&row.position),
            left_pitch_mm: mm(&row.left_pitch),
            right_pitch_mm: mm(&row.right_pitch),
            lead_rad: row.lead.map(Angle::radians),
        })
        .collect()
}

/// One value per error, put on the teeth as the formulas understand them.
fn on_teeth(errors: &[PartDeviation], pair: &Pair) -> (Vec<RackDeviation>, Vec<WrittenPinionDeviation>) {
    let later = ToothRange::new(Some(FIRST_ODD_TOOTH), None).unwrap_or(ToothRange::ALL);
    let half_turn = ToothRange::new(Some(i64::from(pair.pinion().teeth / 2)), None).unwrap_or(ToothRange::ALL);
    let (mut rack, mut pinion) = (Vec::new(), Vec::new());
    for error in errors {
        // of a permissible deviation, its upper end
        match (error.kind(), error.value()) {
            (DeviationKind::RackOverRoller, DeviationValue::Length(length)) => {
                rack.push(RackDeviation { teeth: ToothRange::ALL, kind: RackDeviationKind::OverRoller(length.mm()) });
            }
            (DeviationKind::RackPitch, DeviationValue::Length(length)) => {
                rack.push(RackDeviation { teeth: later, kind: RackDeviationKind::Shift(length.mm()) });
            }
            (DeviationKind::PinionRadial, DeviationValue::Length(length)) => {
                pinion.push(WrittenPinionDeviation::Teeth(PinionDeviation {
                    teeth: ToothRange::ALL,
                    kind: PinionDeviationKind::Radial(length.mm()),
                }));
            }
            (DeviationKind::PinionPitch, DeviationValue::Length(length)) => {
                pinion.push(WrittenPinionDeviation::Teeth(PinionDeviation {
                    teeth: half_turn,
                    kind: PinionDeviationKind::Shift(length.mm()),
                }));
            }
            (DeviationKind::PinionLead, DeviationValue::Length(length)) => {
                pinion.push(WrittenPinionDeviation::Teeth(PinionDeviation {
                    teeth: ToothRange::ALL,
                    kind: PinionDeviationKind::Lead(pinion_lead_angle_rad(pair, length.mm())),
                }));
            }
            (_, DeviationValue::Angle(angle)) => {
                rack.push(RackDeviation { teeth: later, kind: RackDeviationKind::Lead(angle.radians()) });
            }
            (_, DeviationValue::Slope(tangent)) => {
                rack.push(RackDeviation { teeth: later, kind: RackDeviationKind::Lead(trig::atan(tangent)) });
            }
            // a lead error of the rack is no length
            (DeviationKind::RackLead, DeviationValue::Length(_)) => {}
        }
    }
    (rack, pinion)
}
