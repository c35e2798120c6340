//! `[yoke]`, the rack's travel, and the limits on a yoke, as written, for commands that solve the mesh; judges nothing.

use std::ops::Range;

use super::keys::{self, Kind};
use super::limits::read_limit;
use super::reader::SectionReader;
use super::resolve::Problems;
use super::{Located, MeshInput, Spec};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::function::{Bounds, Function, SetAt, Target, Yoke, YokeJudge};
use crate::judge::Rule;
use crate::mesh::{Mesh, STROKE_MM};
use crate::multibody;
use crate::quantity::{Angle, Length};

/// Reads the entries of `[limits]` on a yoke.
pub(super) fn limits(reader: &mut SectionReader<'_>) -> Vec<(Target, Located<Bounds>)> {
    Target::ALL.into_iter().filter_map(|target| Some((target, limit(reader, target)?))).collect()
}

fn limit(reader: &mut SectionReader<'_>, target: Target) -> Option<Located<Bounds>> {
    let name = target.name();
    let key = keys::LIMITS.keys.iter().find(|key| key.name() == name)?;
    let help = "write { lower = …, upper = … }, or one of both";
    let bad = |message: String| Diagnostic::error(Code::BadLimit, message).help(help);
    let written = reader.table.get(name)?;
    let (bounds, span) = if let Kind::MeasureLimit(unit) = key.kind {
        let Some(ends) = written.get_ref().as_table() else {
            return reader.wrong_type(name, written, "{ lower, upper }");
        };
        reader.knows_keys(name, ends, &["lower", "upper"].into_iter(), help)?;
        let mut end = |name: &str| match ends.get(name) {
            Some(value) => reader.measure_value(name, value, unit).map(Some),
            None => Some(None),
        };
        let (lower, upper) = (end("lower"), end("upper"));
        (Bounds { lower: lower?, upper: upper? }, written.span())
    } else {
        let Located { value, span } = read_limit(reader, name)?;
        (Bounds { lower: value.lower.map(Length::mm), upper: value.upper.map(Length::mm) }, span)
    };
    let unit = target.unit();
    let problem = match bounds {
        Bounds { lower: None, upper: None } => Some(format!("`{name}` limits nothing")),
        Bounds { lower: Some(lower), upper: Some(upper) } if lower > upper => {
            Some(format!("the lower limit {lower} {unit} is above the upper limit {upper} {unit}"))
        }
        Bounds { lower: Some(lower), .. } if target == Target::YokePlay && lower < 0.0 => {
            Some(format!("the lower limit of `{name}` is {lower} mm: below 0 there is no play"))
        }
        _ => None,
    };
    match problem {
        Some(problem) => reader.refuse(bad(problem), span),
        None => Some(Located { value: bounds, span }),
    }
}

impl Spec {
    /// Whether the spec describes a yoke, or has a limit on one.
    #[must_use]
    pub fn has_yoke(&self) -> bool {
        self.values.has_any_within("yoke.") || !self.function_limits.is_empty()
    }

    /// The yoke of the spec.
    ///
    /// # Errors
    /// A diagnostic if the plug is backed off by an angle and the spec has no thread pitch.
    pub fn yoke(&self) -> Result<Yoke, Diagnostics> {
        let mut problems = Problems::default();
        let turned = self.get(keys::YOKE_BACK_OFF).map(|angle: Angle| {
            let place = self.place(keys::YOKE_BACK_OFF).map(|span| (span, String::new()));
            let pitch = problems.take(self, keys::YOKE_THREAD_PITCH, || ("`back_off`".to_owned(), place));
            pitch.map_or(0.0, |pitch| pitch.mm() * angle.degrees() / 360.0)
        });
        let yoke = Yoke {
            preload_n: self.get(keys::YOKE_PRELOAD),
            rate_n_per_mm: self.get(keys::YOKE_RATE),
            set_at: self.get(keys::YOKE_SET_AT).unwrap_or_default(),
            play_mm: self.get(keys::YOKE_SET_PLAY).map(Length::mm).or(turned),
            thread_pitch_mm: self.get(keys::YOKE_THREAD_PITCH).map(Length::mm),
            yoke_friction: self.get(keys::YOKE_FRICTION_YOKE),
            tooth_friction: self.get(keys::YOKE_FRICTION_TEETH),
            bearing_torque_n_m: self.get(keys::YOKE_BEARING_TORQUE),
        };
        problems.answer(Some(yoke), &self.source)
    }

    /// First and last stroke of the rack's travel, mm.
    #[must_use]
    pub fn travel_mm(&self) -> Option<(f64, f64)> {
        Some((self.get(keys::RACK_TRAVEL_FROM)?.mm(), self.get(keys::RACK_TRAVEL_TO)?.mm()))
    }

    /// The limits on the yoke.
    #[must_use]
    pub fn function_limits(&self) -> Vec<(Target, Bounds)> {
        self.function_limits.iter().map(|(target, bounds)| (*target, bounds.value)).collect()
    }

    /// How parts with this yoke are judged, if the spec has one: over the rack's travel, or over these strokes. A rule that needs
    /// an uncertainty judges no limit.
    ///
    /// # Errors
    /// Diagnostics as [`yoke`](Self::yoke).
    pub fn yoke_judge(&self, strokes_mm: Option<(f64, f64)>, rule: &Rule) -> Result<Option<YokeJudge>, Diagnostics> {
        if !self.has_yoke() {
            return Ok(None);
        }
        let strokes = strokes_mm.or_else(|| self.travel_mm());
        Ok(Some(YokeJudge {
            yoke: self.yoke()?,
            limits: self.function_limits(),
            strokes_mm: strokes.unwrap_or(STROKE_MM),
            knows_travel: strokes.is_some(),
            is_by_value: *rule == Rule::Simple,
        }))
    }

    /// A diagnostic for values of a yoke or a travel that are each in their domain, but not together.
    pub(super) fn yoke_contradictions(&self) -> Vec<Diagnostic> {
        let at = |message: &str, span: Option<Range<usize>>| {
            Diagnostic::error(Code::OutOfDomain, message).at(&self.source, span, "")
        };
        let backwards = self.travel_mm().filter(|(from, to)| from >= to).map(|(from, to)| {
            at(&format!("the travel from {from} mm to {to} mm is none"), self.place(keys::RACK_TRAVEL_TO))
                .help("`to` lies above `from`")
        });
        let twice = self.place(keys::YOKE_BACK_OFF).filter(|_| self.place(keys::YOKE_SET_PLAY).is_some());
        let twice = twice.map(|span| {
            at("`back_off` and `set_play` say the same twice", Some(span)).help("give the play or the angle")
        });
        backwards.into_iter().chain(twice).collect()
    }

    /// The yoke of a simulation over these strokes, with the force and the clearance at the nominal place of the rack.
    pub(super) fn simulated_yoke(
        &self,
        mesh: &Mesh,
        yoke: multibody::Yoke,
        strokes: Range<f64>,
    ) -> Result<multibody::Yoke, Diagnostics> {
        let known = self.yoke()?;
        let found = match known.set_at {
            SetAt::Stroke(stroke_mm) => mesh.at(stroke_mm).map(|point| point.delta_cd_mm),
            SetAt::Tightest => {
                let (from, to) = self.travel_mm().unwrap_or((strokes.start, strokes.end));
                let curve = mesh.curve(from, to, 1e-6);
                curve.map(|curve| curve.points.iter().map(|point| point.delta_cd_mm).fold(f64::NEG_INFINITY, f64::max))
            }
        };
        let at_mm = found.map_err(Diagnostic::with_code(Code::NoMesh))?;
        let clearance = match (self.get(keys::YOKE_CLEARANCE), known.play_mm) {
            (None, Some(play)) => (play + at_mm).max(0.0),
            _ => yoke.clearance_mm,
        };
        // the force that the user gives is that at s_0
        Ok(multibody::Yoke { preload_n: yoke.preload_n - yoke.rate_n_per_mm * at_mm, clearance_mm: clearance, ..yoke })
    }
}

impl MeshInput {
    /// Whether every flank that carries over the strokes of a yoke, and where its play is set, was measured, if its part was.
    #[must_use]
    pub fn measures(&self, function: &Function) -> bool {
        let (from, to) = function.strokes_mm;
        self.measures_strokes(from.min(function.set_at_mm), to.max(function.set_at_mm))
    }

    /// Whether every flank that carries over some strokes was measured, if its part was.
    #[must_use]
    pub fn measures_strokes(&self, from: f64, to: f64) -> bool {
        if self.rack_rows.is_empty() && self.pinion_rows.is_empty() {
            return true;
        }
        let covers = |strokes: &Range<f64>| strokes.start <= from && to <= strokes.end;
        let strokes = self.judged_strokes();
        strokes.is_ok_and(|strokes| self.rack_rows.is_empty() || strokes.iter().any(covers))
    }
}
