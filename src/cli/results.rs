//! The results of a command that are compared from design to design: names, places in its answer, and cells.

use serde_json::Value;

use super::question::Of;
use crate::batch::{ColumnKind, ResultCell};
use crate::diagnostic::Diagnostic;
use crate::report::{at, element_name};

/// A result of a design.
#[derive(Debug, Clone)]
pub(super) struct Column {
    pub(super) name: String,
    /// Where it stands in the answer.
    place: String,
    pub(super) kind: ColumnKind,
    /// Whether it is not among the results that are compared from design to design.
    pub(super) is_elsewhere: bool,
}

/// The figures of a yoke, where there is one: of known teeth, and by the bound.
const YOKE: &str = "smallest_play_mm=yoke/smallest_play_mm largest_play_mm=yoke/largest_play_mm \
    setting_from_mm=yoke/setting/from_mm setting_to_mm=yoke/setting/to_mm setting_from_deg=yoke/setting/from_deg \
    setting_to_deg=yoke/setting/to_deg torque_rising_mean_n_m=yoke/torque_n_m/rising/mean \
    torque_rising_largest_n_m=yoke/torque_n_m/rising/largest torque_rising_fluctuation_n_m=yoke/torque_n_m/rising/fluctuation \
    torque_falling_mean_n_m=yoke/torque_n_m/falling/mean torque_falling_largest_n_m=yoke/torque_n_m/falling/largest \
    torque_falling_fluctuation_n_m=yoke/torque_n_m/falling/fluctuation variation_at_most_mm=yoke/variation_at_most_mm \
    safe_setting_from_mm=yoke/safe_setting/from_mm safe_setting_to_mm=yoke/safe_setting/to_mm \
    torque_fluctuation_reached_n_m=yoke/reached/torque_fluctuation_n_m lift_off_force_n=yoke/lift_off_force_n ";

/// Behind all results.
const VERDICT: &str = "lower_mm=judged_mm/lower upper_mm=judged_mm/upper verdict reason";

impl Of {
    /// Its results: `NAME=PLACE`, where a `*` stands for each element of a list that has the place.
    fn declared(self) -> String {
        match self {
            Self::Eval => {
                "delta_cd_*_mm=contributions/*/delta_cd_mm range_lower_mm=combined/range_mm/lower \
                 range_upper_mm=combined/range_mm/upper rss_lower_mm=combined/rss_mm/lower rss_upper_mm=combined/rss_mm/upper \
                 reached_lower_mm=reached_mm/lower reached_upper_mm=reached_mm/upper "
                    .to_owned()
                    + YOKE
                    + VERDICT
            }
            Self::Mesh => {
                "mean_mm=summary/mean_mm min_mm=summary/min_mm max_mm=summary/max_mm peak_to_peak_mm=summary/peak_to_peak_mm \
                 tooth_to_tooth_mm=summary/tooth_to_tooth_mm largest_rate=summary/largest_rate \
                 transmission_error_mm=summary/transmission_error_mm contact_ratio=geometry/contact_ratio \
                 nominal_center_distance_mm=nominal_center_distance_mm "
                    .to_owned()
                    + YOKE
                    + VERDICT
            }
            Self::Simulate => {
                "nominal_mm=nominal/delta_cd_mm deviating_mm=deviating/delta_cd_mm difference_mm=difference_mm \
                 exact_difference_mm=exact_difference_mm min_mm=smallest/delta_cd_mm max_mm=largest/delta_cd_mm \
                 normal_right_mean_n=forces/normal_right_n/mean normal_right_largest_n=forces/normal_right_n/largest \
                 normal_left_mean_n=forces/normal_left_n/mean normal_left_largest_n=forces/normal_left_n/largest \
                 pinion_torque_mean_n_m=forces/pinion_torque_n_m/mean pinion_torque_largest_n_m=forces/pinion_torque_n_m/largest "
                    .to_owned()
                    + VERDICT
            }
            Self::Class => "*_um=values/*/value_um delta_cd_*_mm=values/*/delta_cd_mm reason".to_owned(),
            Self::Budget => "tolerance_*_mm=tolerances/*/tolerance_mm tolerance_*_deg=tolerances/*/tolerance_deg \
                 worst_case_lower_mm=worst_case_mm/lower worst_case_upper_mm=worst_case_mm/upper rss_lower_mm=rss_mm/lower \
                 rss_upper_mm=rss_mm/upper reached_lower_mm=reached_mm/lower reached_upper_mm=reached_mm/upper feasible reason"
                .to_owned(),
        }
    }

    /// The columns of a table for people; the first one is drawn.
    const fn shown(self) -> &'static str {
        match self {
            Self::Eval => {
                "range_upper_mm range_lower_mm reached_upper_mm setting_from_mm setting_to_mm lift_off_force_n verdict reason"
            }
            Self::Mesh => {
                "peak_to_peak_mm tooth_to_tooth_mm min_mm max_mm setting_from_mm setting_to_mm torque_rising_mean_n_m \
                 torque_rising_fluctuation_n_m lift_off_force_n verdict reason"
            }
            Self::Simulate => "max_mm min_mm difference_mm normal_right_largest_n normal_left_largest_n verdict reason",
            Self::Class => "f_pt_um F_p_um F_beta_um F_r_um reason",
            Self::Budget => "worst_case_upper_mm worst_case_lower_mm tolerance_*_mm tolerance_*_deg feasible reason",
        }
    }
}

/// The kind of a column, by a first answer.
fn kind(name: &str, value: Option<&Value>) -> ColumnKind {
    match value {
        Some(Value::String(_)) => ColumnKind::Text,
        Some(Value::Bool(_)) => ColumnKind::Flag,
        _ if matches!(name, "verdict" | "reason") => ColumnKind::Text,
        _ if name == "feasible" => ColumnKind::Flag,
        _ => ColumnKind::Number,
    }
}

/// Every result that a command has, by a first answer: those of a yoke only where there is one.
pub(super) fn all(of: Of, answer: &Value) -> Vec<Column> {
    // what a yoke has none of stands there as null, and what is not known of any of its kind does not
    let is_of_yoke = |place: &str| {
        let of_yoke = place.strip_prefix("yoke/").and_then(|place| place.split('/').next());
        of_yoke.is_none_or(|name| answer.get("yoke").is_some_and(|yoke| yoke.get(name).is_some()))
    };
    let column = |name: String, place: String| {
        let kind = kind(&name, at(answer, &place));
        Column { name, place, kind, is_elsewhere: false }
    };
    let declared = of.declared();
    let named = declared.split_whitespace().map(|name| name.split_once('=').unwrap_or((name, name)));
    let named = named.filter(|(_, place)| is_of_yoke(place));
    named
        .flat_map(|(name, place)| {
            let Some((list, _)) = place.split_once("/*") else {
                return vec![column(name.to_owned(), place.to_owned())];
            };
            let elements = at(answer, list).and_then(Value::as_array).into_iter().flatten();
            let each = elements
                .filter_map(element_name)
                .map(|element| column(name.replace('*', element), place.replace('*', element)));
            each.filter(|column| at(answer, &column.place).is_some_and(|value| !value.is_null())).collect()
        })
        .collect()
}

/// The column of that name, or what stands at that place of the answer.
pub(super) fn named(of: Of, name: &str, answer: &Value) -> Result<Column, Diagnostic> {
    let all = all(of, answer);
    if let Some(known) = all.iter().find(|column| column.name == name) {
        return Ok(known.clone());
    }
    match at(answer, name) {
        Some(value) if !value.is_array() && !value.is_object() => {
            let kind = kind(name, Some(value));
            Ok(Column { name: name.to_owned(), place: name.to_owned(), kind, is_elsewhere: true })
        }
        _ => {
            let known: Vec<_> = all.iter().map(|column| column.name.as_str()).collect();
            let help = format!(
                "the results are {}; any other value has its place in the command's JSON as its name, such as {}",
                known.join(", "),
                "contributions/rack_pitch/share"
            );
            Err(Diagnostic::usage(format!("there is no result `{name}`")).help(help))
        }
    }
}

/// The column of a result by its name, or its place, where no answer can tell whether there is one.
pub(super) fn unchecked(of: Of, name: &str) -> Column {
    let known = all(of, &Value::Null).into_iter().find(|column| column.name == name);
    let (name, place) = (name.to_owned(), name.to_owned());
    known.unwrap_or(Column { kind: kind(&name, None), name, place, is_elsewhere: true })
}

/// The columns that are written: those asked for, those of a table for people, or all.
pub(super) fn written(
    of: Of,
    asked: Option<&[String]>,
    is_table: bool,
    answer: &Value,
) -> Result<Vec<Column>, Diagnostic> {
    if let Some(asked) = asked {
        return asked.iter().map(|name| named(of, name, answer)).collect();
    }
    let mut all = all(of, answer);
    if is_table {
        let is_shown = |name: &str| {
            of.shown().split_whitespace().any(|shown| match shown.split_once('*') {
                Some((before, after)) => name.starts_with(before) && name.ends_with(after),
                None => shown == name,
            })
        };
        all.retain(|column| is_shown(&column.name));
    }
    Ok(all)
}

/// The column to draw.
pub(super) fn drawn<'c>(of: Of, asked: Option<&[String]>, columns: &'c [Column]) -> Option<&'c Column> {
    let is_number = |column: &&Column| column.kind == ColumnKind::Number;
    let first = of.shown().split_whitespace().next().filter(|_| asked.is_none());
    columns
        .iter()
        .filter(is_number)
        .find(|column| first.is_none_or(|first| column.name == first))
        .or_else(|| columns.iter().find(is_number))
}

impl Column {
    /// Whether it is a result of the mesh that stands without a verdict.
    pub(super) fn needs_no_verdict(&self) -> bool {
        let of_mesh = ["summary/", "geometry/", "nominal_center_distance_mm"];
        !self.is_elsewhere && of_mesh.iter().any(|place| self.place.starts_with(place))
    }

    /// The value in an answer, if there is one.
    pub(super) fn value<'v>(&self, answer: &'v Value) -> Option<&'v Value> {
        at(answer, &self.place)
    }

    /// The number in an answer, if there is one.
    pub(super) fn number(&self, answer: &Value) -> Option<f64> {
        self.value(answer)?.as_f64()
    }

    /// The cell of a design with this answer; empty if the value has another kind than the column.
    pub(super) fn cell(&self, answer: &Value) -> ResultCell<'static> {
        match (self.kind, self.value(answer)) {
            (ColumnKind::Number, Some(value)) => value.as_f64().map_or(ResultCell::Nothing, ResultCell::Number),
            (ColumnKind::Flag, Some(Value::Bool(flag))) => ResultCell::Flag(*flag),
            (ColumnKind::Text, Some(Value::String(text))) => ResultCell::Text(text.clone().into_bytes().into()),
            _ => ResultCell::Nothing,
        }
    }
}
