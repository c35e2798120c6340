//! The reports of `class`: permissible values, grades obtained, and the coarsest grade within a ΔCD.

use serde_json::{Value, json};

use super::number::{interval_text, plain, tidy, unsigned};
use super::{Block, Column, Report, Table, fact, titled};
use crate::deviation::DeviationKind;
use crate::evaluation::JudgedBy;
use crate::judge::class::{
    DiameterSource, ErrorClass, NO_OVER_ROLLER_CLASS, NoEffect, SizedPart, deviation_of, effect,
};
use crate::judge::grade::{GradeSearch, ObtainedGrade, overall};
use crate::judge::{Combined, Interval, Limit, Stack, Verdict};
use crate::quantity::{Length, LengthUnit};
use crate::standard::{Deviation, Permissible, RangeUse, Size, Standard};

/// The permissible values of one grade.
#[derive(Debug, Clone)]
pub struct ClassReport {
    /// The spec's title.
    pub title: Option<String>,
    /// The standard asked for.
    pub standard: Standard,
    /// The part and its size.
    pub sized: SizedPart,
    /// The grade.
    pub grade: u8,
    /// One per deviation.
    pub rows: Vec<ClassRow>,
    /// Deviations without a value, and why.
    pub not_given: Vec<(Standard, Deviation, String)>,
    /// Remarks.
    pub notes: Vec<String>,
}

impl ClassReport {
    /// The part and its size: `pinion: m_n = 1.9 mm, d = 14.675 mm (given), b = 30 mm, z = 7`.
    fn size(&self) -> String {
        let SizedPart { wheel, diameter_source, meshing } = &self.sized;
        let mm = |symbol: &str, length: &Option<Length>| {
            length.as_ref().map(|length| format!("{symbol} = {} mm", plain(rounded(length.mm()))))
        };
        let diameter = mm("d", &wheel.diameter).map(|text| match diameter_source {
            Some(source) => format!("{text} ({})", source.name()),
            None => text,
        });
        let parts = [
            mm("m_n", &wheel.normal_module),
            diameter,
            mm("b", &wheel.face_width),
            wheel.teeth.map(|teeth| format!("z = {teeth}")),
        ];
        format!("{}: {}", meshing.part.name(), parts.into_iter().flatten().collect::<Vec<_>>().join(", "))
    }

    /// The remarks, with what there is to say of the ΔCD of permissible deviations.
    fn all_notes(&self) -> Vec<String> {
        use Deviation::{HelixSlope, Runout, SectorPitch, SinglePitch, TotalHelix, TotalPitch};
        let mut notes = self.notes.clone();
        let has = |some: &[Deviation]| self.rows.iter().any(|row| some.contains(&row.permissible.deviation));
        if has(&[Runout]) {
            notes.push(
                "ΔCD of F_r and of the composite deviations is their own peak-to-peak value; of an eccentric part it moves \
                 by ± F_r / 2 about its mean, which is what { class = … } of the radial error takes"
                    .to_owned(),
            );
        }
        let by_angle = [SinglePitch, SectorPitch, TotalPitch, HelixSlope, TotalHelix];
        if self.sized.meshing.pressure_angle.is_none() && has(&by_angle) {
            notes.push("give --pressure-angle for the ΔCD of pitch and helix deviations".to_owned());
        }
        if self.rows.iter().any(|row| row.mesh.is_some()) {
            notes.push("exact mesh: each deviation alone, on an otherwise perfect pair".to_owned());
        }
        notes
    }
}

/// A standard with the one that has the other deviations.
fn standards(standard: Standard) -> String {
    match standard.companion() {
        Some(companion) => format!("{standard} with {companion}"),
        None => standard.to_string(),
    }
}

/// A size for people: to 0.1 µm.
fn rounded(mm: f64) -> f64 {
    let rounded = (mm * 1e4).round() / 1e4;
    if rounded.is_finite() { rounded } else { mm }
}

/// One permissible value and its ΔCD.
#[derive(Debug, Clone)]
pub struct ClassRow {
    /// The value.
    pub permissible: Permissible,
    /// ΔCD by the formulas, or why there is none.
    pub delta_cd: Result<Length, NoEffect>,
    /// ΔCD by the exact mesh, mm, and how the deviation was put on the teeth.
    pub mesh: Option<(f64, &'static str)>,
}

fn range_json(used: &RangeUse) -> Value {
    json!({
        "size": used.size.key(),
        "value": used.value,
        "over": used.range.as_ref().map(|range| range.over),
        "up_to": used.range.as_ref().map(|range| range.up_to),
        "taken": used.taken,
    })
}

/// The ranges used, in short: `m 0.5–2, d 5–20`.
fn ranges_text(ranges: &[RangeUse]) -> String {
    let texts = ranges.iter().map(|used| {
        let symbol = match used.size {
            Size::NormalModule => "m",
            Size::Diameter => "d",
            Size::FaceWidth => "b",
            Size::Teeth => return format!("k {}", plain(used.taken)),
            Size::HelixAngle => "β",
        };
        match &used.range {
            Some(range) => format!("{symbol} {}–{}", plain(range.over), plain(range.up_to)),
            None => format!("{symbol} {}", plain(rounded(used.taken))),
        }
    });
    texts.collect::<Vec<_>>().join(", ")
}

impl Report for ClassReport {
    fn json(&self) -> Value {
        let values: Vec<_> = self
            .rows
            .iter()
            .map(|ClassRow { permissible, delta_cd, mesh }| {
                json!({
                    "symbol": permissible.symbol(),
                    "value_um": permissible.value_um(),
                    "unrounded_um": permissible.unrounded_um(),
                    "name": permissible.deviation.name(),
                    "standard": permissible.standard.id(),
                    "clause": permissible.clause,
                    "formula": permissible.formula,
                    "ranges": permissible.ranges.iter().map(range_json).collect::<Vec<_>>(),
                    "delta_cd_mm": delta_cd.as_ref().ok(),
                    "delta_cd_by": delta_cd.as_ref().ok().and_then(|_| effect(permissible.deviation)),
                    "delta_cd_missing": delta_cd.as_ref().err().map(ToString::to_string),
                    "mesh_delta_cd_mm": mesh.map(|(mm, _)| tidy(mm)),
                    "mesh_arrangement": mesh.map(|(_, arrangement)| arrangement),
                    "remarks": permissible.remarks.iter().map(ToString::to_string).collect::<Vec<_>>(),
                })
            })
            .collect();
        let not_given: Vec<_> = self
            .not_given
            .iter()
            .map(|(standard, deviation, reason)| json!({ "symbol": standard.symbol(*deviation), "reason": reason }))
            .collect();
        let SizedPart { wheel, diameter_source, meshing } = &self.sized;
        json!({
            "standard": self.standard.id(),
            "grade": self.grade,
            "values": values,
            "not_given": not_given,
            "title": self.title,
            "standard_name": standards(self.standard),
            "part": meshing.part.name(),
            "normal_module_mm": wheel.normal_module,
            "diameter_mm": wheel.diameter,
            "diameter_source": diameter_source.map(DiameterSource::name),
            "face_width_mm": wheel.face_width,
            "teeth": wheel.teeth,
            "notes": self.all_notes(),
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        const NAMES: &str = "symbol value_um unrounded_um standard grade diameter_mm delta_cd_mm delta_cd_by \
                             mesh_delta_cd_mm formula";
        fact::rows(&self.json(), "values", NAMES)
    }

    fn blocks(&self) -> Vec<Block> {
        let with_mesh = self.rows.iter().any(|row| row.mesh.is_some());
        let values = Table::of(&self.rows)
            .text("deviation", |row| row.permissible.deviation.to_string())
            .text("symbol", |row| row.permissible.symbol())
            .number("permissible\n[µm]", |row| shown_um(&row.permissible))
            .number("unrounded\n[µm]", |row| format!("{:.3}", row.permissible.unrounded_um()))
            .text("ranges [mm]", |row| ranges_text(&row.permissible.ranges))
            .number("ΔCD\n[mm]", |row| row.delta_cd.as_ref().ok().map(|delta_cd| unsigned(delta_cd.mm())))
            .text("by", |row| row.delta_cd.as_ref().ok().and_then(|_| effect(row.permissible.deviation)))
            .column_if(with_mesh, Column::number("exact mesh\n[mm]"), |row| row.mesh.map(|(mm, _)| unsigned(tidy(mm))));
        let mut blocks = titled(self.title.as_deref());
        blocks.push(Block::Title(format!("{}, grade {}", standards(self.standard), self.grade)));
        blocks.push(Block::Note(self.size()));
        blocks.push(values.block());
        let not_given = self.not_given.iter().map(|(standard, deviation, reason)| {
            Block::Note(format!("not given: {}: {reason}", standard.symbol(*deviation)))
        });
        let mut notes: Vec<_> = not_given.collect();
        for row in &self.rows {
            for remark in &row.permissible.remarks {
                notes.push(Block::Remark(format!("{}: {remark}", row.permissible.symbol())));
            }
        }
        notes.extend(self.all_notes().into_iter().map(Block::Remark));
        notes.dedup();
        blocks.extend(notes);
        blocks
    }
}

/// A permissible value for people: as its standard rounds it, or with the digits of the unrounded one where that is
/// unknown.
fn shown_um(permissible: &Permissible) -> String {
    let text = plain(permissible.value_um());
    if permissible.is_rounded() { text } else { format!("{:.3}", permissible.unrounded_um()) }
}

/// The grades that measured values reach.
#[derive(Debug, Clone)]
pub struct ObtainedReport {
    /// The spec's title.
    pub title: Option<String>,
    /// The standard.
    pub standard: Standard,
    /// The diameters used, in words.
    pub diameters: Vec<String>,
    /// One per deviation.
    pub obtained: Vec<ObtainedGrade>,
    /// Deviations without a grade, and why.
    pub not_graded: Vec<String>,
}

/// The permissible value that is shown beside a measured one.
fn shown(one: &ObtainedGrade) -> &Permissible {
    one.reached.as_ref().unwrap_or(&one.coarsest)
}

impl Report for ObtainedReport {
    fn json(&self) -> Value {
        let values: Vec<_> = self
            .obtained
            .iter()
            .map(|one| {
                let shown = shown(one);
                json!({
                    "part": one.part.name(),
                    "symbol": shown.symbol(),
                    "measured_um": one.measured.in_unit(LengthUnit::Micrometre),
                    "origin": one.origin,
                    "standard": shown.standard.id(),
                    "grade": one.reached.as_ref().map(|permissible| permissible.grade),
                    "beyond_known_values": one.is_beyond_what_is_known(),
                    "permissible_um": shown.value_um(),
                })
            })
            .collect();
        json!({
            "title": self.title,
            "standard": self.standard.id(),
            "grade": overall(&self.obtained),
            "values": values,
            "diameters": self.diameters,
            "not_graded": self.not_graded,
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        fact::rows(&self.json(), "values", "part symbol measured_um grade permissible_um standard origin")
    }

    fn blocks(&self) -> Vec<Block> {
        let grade = |one: &ObtainedGrade| match &one.reached {
            Some(permissible) => permissible.grade.to_string(),
            None if one.is_beyond_what_is_known() => format!("over {}, not known", one.coarsest.grade),
            None => format!("beyond {}", one.coarsest.grade),
        };
        let obtained = Table::of(&self.obtained)
            .text("part", |one| one.part.name())
            .text("deviation", |one| one.deviation.to_string())
            .text("symbol", |one| shown(one).symbol())
            .number("measured\n[µm]", |one| format!("{:.1}", one.measured.in_unit(LengthUnit::Micrometre)))
            .number("grade", |one| grade(one))
            .number("permissible\n[µm]", |one| shown_um(shown(one)))
            .text("measured as", |one| one.origin.clone());
        let mut blocks = titled(self.title.as_deref());
        blocks.push(obtained.block());
        blocks.push(Block::Note(match overall(&self.obtained) {
            Some(grade) => format!("Overall: grade {grade} of {}", standards(self.standard)),
            None if self.obtained.is_empty() => "Overall: nothing could be graded".to_owned(),
            None if self.obtained.iter().any(ObtainedGrade::is_beyond_what_is_known) => format!(
                "Overall: not known: this program has not all values of {}, and a deviation is beyond those it has",
                standards(self.standard)
            ),
            None => format!("Overall: beyond the grades of {}", standards(self.standard)),
        }));
        blocks.extend(self.diameters.iter().cloned().map(Block::Remark));
        blocks.extend(self.not_graded.iter().map(|text| Block::Note(format!("not graded: {text}"))));
        blocks
    }
}

/// The coarsest grade within a ΔCD.
#[derive(Debug, Clone)]
pub struct GradeSearchReport {
    /// The spec's title.
    pub title: Option<String>,
    /// The standard.
    pub standard: Standard,
    /// The grades and their combinations.
    pub search: GradeSearch,
    /// The kinds of error that were combined.
    pub kinds: Vec<DeviationKind>,
    /// Those that have no class.
    pub left_out: Vec<DeviationKind>,
    /// The parts that have them.
    pub parts: Vec<SizedPart>,
}

impl GradeSearchReport {
    /// What was combined: by which deviation of a standard each error is graded.
    fn terms(&self) -> Vec<String> {
        let term = |kind: &DeviationKind| {
            let deviation = deviation_of(*kind)?;
            let limiting = self.standard.that_limits(deviation)?;
            let part = self.parts.iter().find(|part| part.meshing.part == kind.part())?;
            let diameter = part.diameter_in_words().map(|words| format!(", {words}")).unwrap_or_default();
            let cap = match deviation {
                Deviation::SinglePitch if limiting.deviations().contains(&Deviation::TotalPitch) => {
                    format!(", capped by {}", limiting.symbol(Deviation::TotalPitch))
                }
                Deviation::Runout => " / 2, an eccentricity,".to_owned(),
                _ => String::new(),
            };
            Some(format!("{kind} by {}{cap} of {limiting}{diameter}", limiting.symbol(deviation)))
        };
        self.kinds.iter().filter_map(term).collect()
    }

    /// What was not combined, and why.
    fn left_out(&self) -> Vec<String> {
        self.left_out.iter().map(|kind| format!("{kind}: {NO_OVER_ROLLER_CLASS}")).collect()
    }
}

/// The ends of a grade's combination, if it has them.
fn ends(combined: &Result<Combined<Interval>, NoEffect>, stack: Stack) -> Option<Interval> {
    combined.as_ref().ok().and_then(|combined| combined.interval(stack).ok())
}

/// Why a grade has no worst case.
fn why_none(combined: &Result<Combined<Interval>, NoEffect>) -> Option<String> {
    match combined {
        Ok(combined) => combined.range.err().map(|open| open.to_string()),
        Err(error) => Some(error.to_string()),
    }
}

impl Report for GradeSearchReport {
    fn json(&self) -> Value {
        let grades: Vec<_> = self
            .search
            .steps
            .iter()
            .map(|step| {
                json!({
                    "grade": step.grade,
                    "worst_case_mm": ends(&step.combined, Stack::Range),
                    "rss_mm": ends(&step.combined, Stack::Rss),
                    "missing": why_none(&step.combined),
                })
            })
            .collect();
        json!({
            "title": self.title,
            "standard": self.standard.id(),
            "delta_cd_mm": self.search.limit.mm(),
            "grade_worst_case": self.search.coarsest(Stack::Range),
            "grade_rss": self.search.coarsest(Stack::Rss),
            "grades": grades,
            "terms": self.terms(),
            "left_out": self.left_out(),
        })
    }

    fn rows(&self) -> Vec<Vec<String>> {
        const NAMES: &str = "grade worst_case_lower_mm=worst_case_mm/lower worst_case_upper_mm=worst_case_mm/upper \
                             rss_lower_mm=rss_mm/lower rss_upper_mm=rss_mm/upper missing";
        fact::rows(&self.json(), "grades", NAMES)
    }

    fn blocks(&self) -> Vec<Block> {
        let limit = self.search.limit;
        let is_within = |interval| Limit::symmetric(limit).judge(interval) == Verdict::Pass;
        let within = |interval| if is_within(interval) { "within" } else { "beyond" };
        let grades = Table::of(&self.search.steps)
            .number("grade", |step| step.grade.to_string())
            .number("worst case\n[mm]", |step| ends(&step.combined, Stack::Range).as_ref().map(interval_text))
            .text("", |step| ends(&step.combined, Stack::Range).map(within))
            .number("RSS\n[mm]", |step| ends(&step.combined, Stack::Rss).as_ref().map(interval_text))
            .text("", |step| ends(&step.combined, Stack::Rss).map(within));
        let mut blocks = titled(self.title.as_deref());
        blocks.push(Block::Title(format!("ΔCD within {} mm by {}", plain(limit.mm()), standards(self.standard))));
        blocks.push(grades.block());
        let grade = |grade: Option<u8>| grade.map_or_else(|| "none".to_owned(), |grade| format!("grade {grade}"));
        blocks.push(Block::Note(format!(
            "The coarsest grade within {} mm: {} judged by {}, {} by {}",
            plain(limit.mm()),
            grade(self.search.coarsest(Stack::Range)),
            JudgedBy::Bound,
            grade(self.search.coarsest(Stack::Rss)),
            JudgedBy::Statistical
        )));
        blocks.extend(self.terms().into_iter().map(|term| Block::Note(format!("combined: {term}"))));
        blocks.extend(self.left_out().into_iter().map(|reason| Block::Note(format!("left out: {reason}"))));
        let mut reasons: Vec<String> = self.search.steps.iter().filter_map(|step| why_none(&step.combined)).collect();
        reasons.dedup();
        if let Some(reason) = reasons.first() {
            blocks.push(Block::Remark(format!("grades without a value: {reason}")));
        }
        blocks
    }
}

/// A resolved class, for programs.
pub(super) fn class_fact(ErrorClass { permissible, diameter, .. }: &ErrorClass) -> Value {
    json!({
        "standard": permissible.standard.id(),
        "grade": permissible.grade,
        "symbol": permissible.symbol(),
        "value_um": permissible.value_um(),
        "unrounded_um": permissible.unrounded_um(),
        "diameter_mm": diameter.map(|(diameter, _)| diameter.mm()),
        "diameter_source": diameter.map(|(_, source)| source.name()),
    })
}
