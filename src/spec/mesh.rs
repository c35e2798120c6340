//! What a spec means for the exact mesh: the pair, its deviations, and the rack's support. The subcommands that solve the
//! mesh or simulate call it and give it the text of measured tables; it opens no file and solves nothing.

mod rows;

use std::collections::BTreeSet;
use std::ops::Range;

pub use self::rows::MeasuredTables;
use self::rows::pinion_rows;
use super::resolve::Problems;
use super::{Spec, keys, said_of};
use crate::deviation::{
    DeviationError, DeviationKind, DeviationValue, Extent, FIRST_ODD_TOOTH, Part, PinionDeviation, PinionDeviationKind,
    PinionFlanks, PinionToothRow, RackDeviation, RackDeviationKind, RackFlanks, RackSpaceRow, ToothRange,
    pinion_flanks_from_rows, rack_flanks_from_spaces,
};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::formula::PartDeviation;
use crate::gear::{GeometryError, GeometryWarning, Pair, PairData, PairSize, PinionData, RackData};
use crate::judge::PlacedError;
use crate::judge::bound::pinion_lead_angle_rad;
use crate::judge::strokes::{StrokesError, judged_strokes};
use crate::mesh::{Mesh, MeshError, Support};
use crate::quantity::Length;
use crate::table::{PinionTeeth, RackSpaces};
use crate::trig;

/// Where the deviations of a mesh come from.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Origin {
    /// Deviations per tooth: `deviation` and `measured`; none at all is a perfect pair.
    Teeth,
    /// One value per error, from `[errors]`, on the teeth that the formulas assume, also for errors with another extent.
    Errors {
        /// The errors whose extent names other teeth.
        elsewhere: Vec<DeviationKind>,
    },
    /// One value per error, each on every tooth alike: nothing is left to place.
    AllTeeth,
    /// One value per error, on the worst teeth that a search finds.
    WorstTeeth {
        /// The errors with their teeth.
        errors: Vec<PlacedError>,
        /// Whether they are the worst for the largest ΔCD, and not for the smallest.
        is_upper: bool,
    },
}

/// A mesh and what its user should know.
#[derive(Debug, Clone)]
pub struct MeshInput {
    /// Ready to be solved.
    pub mesh: Mesh,
    /// Where the deviations come from.
    pub origin: Origin,
    /// The errors of `[errors]` that are on no teeth, because the spec knows those of the other part one by one.
    pub left_out: Vec<DeviationKind>,
    /// Warnings about the geometry.
    pub warnings: Vec<GeometryWarning>,
    /// The rack's deviations other than measured tables, for the formulas.
    pub rack_deviations: Vec<RackDeviation>,
    /// The pinion's deviations other than measured tables, for the formulas.
    pub pinion_deviations: Vec<PinionDeviation>,
    /// f_Hβ of the pinion that `[errors]` gives and the mesh has, for the formulas; mm.
    pub pinion_lead_mm: Option<f64>,
    /// The measured rows of the rack.
    pub rack_rows: Vec<RackSpaceRow>,
    /// The measured rows of the pinion.
    pub pinion_rows: Vec<PinionToothRow>,
    /// The spaces of a measured rack that have a value in every column of its table.
    pub whole_spaces: BTreeSet<i64>,
    /// The first space between measured ones that lacks a value, and its line.
    pub unmeasured_space: Option<(i64, u64)>,
    /// The first tooth of a measured pinion that lacks a value.
    pub unmeasured_tooth: Option<i64>,
}

impl MeshInput {
    /// The strokes at which a deviated tooth can carry.
    ///
    /// # Errors
    /// [`StrokesError`] if measured spaces cover no stroke, or a space between others or a tooth of a measured pinion was
    /// left out.
    pub fn judged_strokes(&self) -> Result<Vec<Range<f64>>, StrokesError> {
        if let Some(tooth) = self.unmeasured_tooth {
            return Err(StrokesError::Tooth { tooth, teeth: self.mesh.pair().pinion().teeth });
        }
        if let Some((space, line)) = self.unmeasured_space {
            return Err(StrokesError::Gap { space, line });
        }
        if !self.rack_rows.is_empty() && self.whole_spaces.is_empty() {
            return Err(StrokesError::NotMeasured);
        }
        // deviations of all teeth alike do not change along a turn
        let changes = |deviation: &PinionDeviation| {
            let is_centred = !matches!(deviation.kind, PinionDeviationKind::Eccentricity(_));
            !(is_centred && deviation.teeth == ToothRange::ALL)
        };
        let pinion_deviates = self.pinion_deviations.iter().any(changes) || !self.pinion_rows.is_empty();
        judged_strokes(&self.mesh, &self.rack_deviations, &self.whole_spaces, pinion_deviates)
    }
}

impl Spec {
    /// Whether the spec gives deviations per tooth.
    #[must_use]
    pub fn has_deviations(&self) -> bool {
        self.knows_teeth(Part::Rack) || self.knows_teeth(Part::Pinion)
    }

    /// The nominal pair; `what` needs it.
    ///
    /// # Errors
    /// A diagnostic for each key that is missing, or for geometry that cannot mesh.
    pub fn pair(&self, what: &str) -> Result<Pair, Diagnostics> {
        let mut problems = Problems::default();
        let data = self.pair_data(what, &mut problems);
        let data = problems.answer(data, &self.source)?;
        Pair::new(&data).map_err(|error| self.bad_geometry(&error).into())
    }

    /// The nominal pair without a check; `None` if a key is missing.
    fn pair_data(&self, what: &str, problems: &mut Problems) -> Option<PairData> {
        let who = || (what.to_owned(), None);
        let module = problems.take(self, keys::PAIR_NORMAL_MODULE, who);
        let alpha = problems.take(self, keys::PAIR_NORMAL_PRESSURE_ANGLE, who);
        let rack_face = problems.take(self, keys::RACK_FACE_WIDTH, who);
        let addendum = problems.take(self, keys::RACK_ADDENDUM, who);
        let teeth = problems.take(self, keys::PINION_TEETH, who);
        let pinion_face = problems.take(self, keys::PINION_FACE_WIDTH, who);
        let tip = problems.take(self, keys::PINION_TIP_DIAMETER, who);
        let mm = |key| self.get(key).map(Length::mm);
        Some(PairData {
            normal_module_mm: module?.mm(),
            normal_pressure_angle_rad: alpha?.radians(),
            rack: RackData {
                helix_angle_rad: self.or_zero(keys::RACK_HELIX_ANGLE).radians(),
                face_width_mm: rack_face?.mm(),
                addendum_mm: addendum?.mm(),
                tooth_thickness_mm: mm(keys::RACK_TOOTH_THICKNESS),
            },
            pinion: PinionData {
                teeth: teeth?,
                helix_angle_rad: self.or_zero(keys::PINION_HELIX_ANGLE).radians(),
                profile_shift: self.or_zero(keys::PINION_PROFILE_SHIFT),
                tip_diameter_mm: tip?.mm(),
                root_form_diameter_mm: mm(keys::PINION_ROOT_FORM_DIAMETER),
                face_width_mm: pinion_face?.mm(),
                tooth_thickness_deviation_mm: mm(keys::PINION_TOOTH_THICKNESS_DEVIATION).unwrap_or(0.0),
            },
        })
    }

    /// The mesh of the pair with all its errors and deviations.
    ///
    /// Without deviations per tooth, the values in `[errors]` are put on the teeth: over-roller and radial
    /// errors on all of them, the rack's pitch and lead errors on the teeth from [`FIRST_ODD_TOOTH`] on, the pinion's
    /// pitch error as one step half way round, its lead error on all of its teeth.
    ///
    /// # Errors
    /// Diagnostics for missing keys, geometry that cannot mesh, and deviations that cannot be.
    pub fn mesh(&self, tables: &MeasuredTables) -> Result<MeshInput, Diagnostics> {
        let pair = self.pair("the exact mesh")?;
        self.refuse_both_ways(&self.kinds())?;
        if self.has_deviations() || self.errors.is_empty() {
            let input = self.mesh_with(pair, &[], Origin::Teeth, tables)?;
            return Ok(MeshInput { left_out: self.kinds(), ..input });
        }
        let errors = self.part_deviations()?;
        let is_elsewhere = |error: &&PartDeviation| {
            let is_said = error.is_tolerance() || said_of(&self.extents, error.kind()).is_some();
            is_said && !PLACED.contains(&(error.kind(), error.extent()))
        };
        let elsewhere = errors.iter().filter(is_elsewhere).map(PartDeviation::kind).collect();
        self.mesh_with(pair, &errors, Origin::Errors { elsewhere }, tables)
    }

    /// The mesh of the teeth that are known one by one together with these errors, whose origin says on which teeth they are.
    pub(super) fn mesh_with(
        &self,
        pair: Pair,
        errors: &[PartDeviation],
        origin: Origin,
        tables: &MeasuredTables,
    ) -> Result<MeshInput, Diagnostics> {
        let (mut rack_deviations, mut pinion_deviations) = on_teeth(errors, &pair, origin == Origin::AllTeeth);
        rack_deviations.extend(self.rack_deviations.iter().map(|deviation| deviation.value));
        pinion_deviations.extend(self.pinion_deviations.iter().map(|deviation| deviation.value));
        let lead = errors.iter().find(|error| error.kind() == DeviationKind::PinionLead);
        let pinion_lead_mm = lead.map(|error| error.value().base());
        let rack_rows = match &tables.rack {
            Some(spaces) => self.rack_rows(spaces, &pair)?,
            None => Vec::new(),
        };
        let on_circle = |teeth: &PinionTeeth| pinion_rows(&self.on_reference_circle(&teeth.rows));
        let pinion_rows = tables.pinion.as_ref().map(on_circle).unwrap_or_default();
        if let Some(teeth) = &tables.pinion {
            self.check_pinion_rows(teeth, &pinion_rows)?;
        }
        let rack = self.rack_flanks(&pair, &rack_deviations, &rack_rows, tables)?;
        let pinion = self.pinion_flanks(&pair, &pinion_deviations, &pinion_rows, tables)?;
        let support = self.support()?;
        let mesh = Mesh::new(pair, rack, pinion, support).map_err(Diagnostic::with_code(Code::OutOfDomain))?;
        let warnings = pair.warnings();
        Ok(MeshInput {
            mesh,
            origin,
            left_out: Vec::new(),
            warnings,
            rack_deviations,
            pinion_deviations,
            pinion_lead_mm,
            rack_rows,
            pinion_rows,
            whole_spaces: tables.rack.as_ref().map(RackSpaces::measured_spaces).unwrap_or_default(),
            unmeasured_space: tables.rack.as_ref().and_then(RackSpaces::unmeasured),
            unmeasured_tooth: tables.pinion.as_ref().and_then(|table| table.unmeasured(i64::from(pair.pinion().teeth))),
        })
    }

    pub(super) fn support(&self) -> Result<Support, Diagnostics> {
        if !self.rolls() {
            return Ok(Support::Fixed);
        }
        let mut problems = Problems::default();
        let place = self.place(keys::SUPPORT_ROLL).map(|span| (span, String::new()));
        let depth =
            problems.take(self, keys::SUPPORT_ROLL_AXIS_DEPTH, || ("a rack that is free to roll".to_owned(), place));
        let depth = problems.answer(depth, &self.source)?;
        Ok(Support::FreeRoll { axis_depth_mm: depth.mm() })
    }

    fn rack_flanks(
        &self,
        pair: &Pair,
        deviations: &[RackDeviation],
        rows: &[RackSpaceRow],
        tables: &MeasuredTables,
    ) -> Result<RackFlanks, Diagnostic> {
        // first each by itself, so that the message points at the impossible one
        for written in &self.rack_deviations {
            RackFlanks::new(pair, &[written.value])
                .map_err(|error| self.bad_value(&error, Some(written.span.clone())))?;
        }
        let whole = |error| self.bad_value(&error, None);
        let measured = rack_flanks_from_spaces(pair, rows).map_err(whole)?;
        let in_table = |error| self.bad_in(tables.rack.as_ref().map(|table| table.name.as_str()), &error);
        let form = self.rack_form();
        let form_span = self.place(keys::RACK_TIP_RELIEF).or_else(|| self.place(keys::RACK_CROWNING));
        RackFlanks::new(pair, deviations)
            .map_err(whole)?
            .with_measured(&measured)
            .map_err(in_table)?
            .with_form(pair, form)
            .map_err(|error| self.bad_value(&error, form_span))
    }

    fn pinion_flanks(
        &self,
        pair: &Pair,
        deviations: &[PinionDeviation],
        rows: &[PinionToothRow],
        tables: &MeasuredTables,
    ) -> Result<PinionFlanks, Diagnostic> {
        for written in &self.pinion_deviations {
            PinionFlanks::new(pair, &[written.value])
                .map_err(|error| self.bad_value(&error, Some(written.span.clone())))?;
        }
        let whole = |error| self.bad_value(&error, None);
        let in_table = |error| self.bad_in(tables.pinion.as_ref().map(|table| table.name.as_str()), &error);
        let form = self.pinion_form();
        let form_span = self.place(keys::PINION_PROFILE_SLOPE);
        let measured = pinion_flanks_from_rows(pair, rows).map_err(in_table)?;
        PinionFlanks::new(pair, deviations)
            .map_err(whole)?
            .with_measured(&measured)
            .map_err(in_table)?
            .with_form(form)
            .map_err(|error| self.bad_value(&error, form_span))
    }

    /// A diagnostic for an impossible deviation, in a table if there is one.
    fn bad_in(&self, table: Option<&str>, error: &DeviationError) -> Diagnostic {
        table.map_or_else(
            || self.bad_value(error, None),
            |table| Diagnostic::error(Code::BadTable, format!("{table}: {error}")),
        )
    }

    fn bad_value(&self, error: &DeviationError, span: Option<Range<usize>>) -> Diagnostic {
        let code = match error {
            DeviationError::NoSuchTooth { .. } => Code::BadTeeth,
            _ => Code::OutOfDomain,
        };
        Diagnostic::error(code, error.to_string()).at(&self.source, span, "")
    }

    /// A diagnostic for geometry that cannot mesh, at the value that causes it.
    fn bad_geometry(&self, error: &GeometryError) -> Diagnostic {
        let quantity = match error {
            GeometryError::OutOfDomain { quantity, .. } => *quantity,
            GeometryError::PointedRack { .. } => PairSize::RackAddendum,
            GeometryError::NoRackSpace { .. } => PairSize::RackToothThickness,
            GeometryError::NoInvolute { .. } if self.get(keys::PINION_ROOT_FORM_DIAMETER).is_some() => {
                PairSize::PinionRootFormDiameter
            }
            GeometryError::PointedPinion { .. } | GeometryError::NoInvolute { .. } => PairSize::PinionTipDiameter,
        };
        let place = self.values.at(quantity.key()).map(|written| written.span.clone());
        let diagnostic = Diagnostic::error(Code::BadGeometry, error.to_string()).at(&self.source, place, "");
        if let GeometryError::NoInvolute { .. } = error {
            diagnostic.help("check the tip diameter, the number of teeth and the module against each other")
        } else {
            diagnostic
        }
    }
}

impl From<MeshError> for Diagnostic {
    fn from(error: MeshError) -> Self {
        let diagnostic = Self::error(Code::NoMesh, error.to_string());
        match error {
            MeshError::NoContact { .. } => diagnostic
                .help("check the diameters, the addendum and the deviations: the teeth do not reach each other"),
            MeshError::TipOnTip { .. } => {
                diagnostic.help("check the tooth thicknesses and the deviations: the teeth are wider than the spaces")
            }
            _ => diagnostic,
        }
    }
}

impl From<MeshError> for Diagnostics {
    fn from(error: MeshError) -> Self {
        Diagnostic::from(error).into()
    }
}

impl From<StrokesError> for Diagnostics {
    fn from(error: StrokesError) -> Self {
        match error {
            StrokesError::Mesh(error) => error.into(),
            other => Diagnostic::error(Code::NoMesh, other.to_string()).into(),
        }
    }
}

/// The extents that [`on_teeth`] follows.
const PLACED: [(DeviationKind, Extent); 7] = [
    (DeviationKind::RackOverRoller, Extent::All),
    (DeviationKind::RackPitch, Extent::One),
    (DeviationKind::RackLead, Extent::All),
    (DeviationKind::RackLead, Extent::Part),
    (DeviationKind::PinionRadial, Extent::All),
    (DeviationKind::PinionPitch, Extent::One),
    (DeviationKind::PinionLead, Extent::All),
];

/// One value per error, on all teeth or on those that the formulas assume.
fn on_teeth(errors: &[PartDeviation], pair: &Pair, is_on_all: bool) -> (Vec<RackDeviation>, Vec<PinionDeviation>) {
    let later = if is_on_all { ToothRange::ALL } else { ToothRange::starting_at(FIRST_ODD_TOOTH) };
    let pitch = if is_on_all { RackDeviationKind::Pitch } else { RackDeviationKind::Shift };
    let half_turn = ToothRange::starting_at(i64::from(pair.pinion().teeth / 2));
    let (mut rack, mut pinion) = (Vec::new(), Vec::new());
    let mut on_rack = |teeth, kind| rack.push(RackDeviation { teeth, kind });
    let mut on_pinion = |teeth, kind| pinion.push(PinionDeviation { teeth, kind });
    let all = ToothRange::ALL;
    for error in errors {
        // for a permissible deviation, the upper end
        match (error.kind(), error.value()) {
            (DeviationKind::RackOverRoller, DeviationValue::Length(length)) => {
                on_rack(all, RackDeviationKind::OverRoller(length.mm()));
            }
            (DeviationKind::RackPitch, DeviationValue::Length(length)) => {
                on_rack(later, pitch(length.mm()));
            }
            (DeviationKind::PinionRadial, DeviationValue::Length(length)) => {
                on_pinion(all, PinionDeviationKind::Radial(length.mm()));
            }
            (DeviationKind::PinionPitch, DeviationValue::Length(length)) => {
                on_pinion(half_turn, PinionDeviationKind::Shift(length.mm()));
            }
            (DeviationKind::PinionLead, DeviationValue::Length(length)) => {
                on_pinion(all, PinionDeviationKind::Lead(pinion_lead_angle_rad(pair, length.mm())));
            }
            (_, DeviationValue::Angle(angle)) => on_rack(later, RackDeviationKind::Lead(angle.radians())),
            (_, DeviationValue::Slope(tangent)) => on_rack(later, RackDeviationKind::Lead(trig::atan(tangent))),
            // a lead error of the rack is no length
            (DeviationKind::RackLead, DeviationValue::Length(_)) => {}
        }
    }
    (rack, pinion)
}
