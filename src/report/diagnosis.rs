//! Which teeth explain a measured curve: the part of `mesh --measured --diagnose`.

use serde_json::{Value, json};

use super::number::{millimetres, tidy, unsigned};
use super::trace::AT_AN_END;
use super::{Block, Table};
use crate::gear::Pair;
use crate::trace::{Alternative, Diagnosis, FoundError, ToothError, UNSEEN_MM, Unseen};

fn json_of(pair: &Pair, error: ToothError, value_mm: f64, interval_mm: [Option<f64>; 2]) -> Value {
    let mut json = json!({
        "part": error.part.name(),
        "kind": error.kind.name(),
        "tooth": error.tooth,
        "value_mm": tidy(value_mm),
        "interval_mm": interval_mm.map(|end| end.map(tidy)),
    });
    if let Some(angle) = error.lead_rad(pair, value_mm) {
        json["value_deg"] = tidy(angle.to_degrees()).into();
    }
    json
}

/// The errors, the one with the largest effect first.
pub(super) fn errors_json(diagnosis: &Diagnosis, pair: &Pair) -> Value {
    // an interval holds only where the errors explain the curve
    let interval = |own: [Option<f64>; 2]| if diagnosis.is_likely() { own } else { [None; 2] };
    let found = diagnosis.errors.iter().map(|found| {
        let mut json = json_of(pair, found.error, found.value_mm, interval(found.interval_mm));
        json["effect_mm"] = tidy(found.effect_mm).into();
        let others = found.alternatives.iter().map(|other| {
            let mut json = json_of(pair, other.error, other.value_mm, interval(other.interval_mm));
            if let Some(shift_mm) = other.shift_mm {
                json["stroke_shift_mm"] = tidy(shift_mm).into();
            }
            json
        });
        json["alternatives"] = others.collect();
        json
    });
    found.collect()
}

/// How the errors were found, and what the curve cannot tell.
pub(super) fn json(diagnosis: &Diagnosis, is_fitted: bool) -> Value {
    json!({
        "noise_mm": tidy(diagnosis.noise_mm),
        "noise_is_stated": diagnosis.noise_is_stated,
        "candidates": diagnosis.candidates,
        "chi_square_threshold": tidy(diagnosis.threshold),
        "rms_left_mm": tidy(diagnosis.rms_left_mm),
        "leaves_more_than_noise": diagnosis.leaves_more,
        "eccentricity_mm": diagnosis.eccentricity_mm.map(tidy),
        "offset_mm": tidy(diagnosis.offset_mm),
        "stroke_shift_mm": tidy(diagnosis.shift_mm),
        "unseen_size_mm": UNSEEN_MM,
        "unseen": diagnosis.unseen.iter().map(|of| json!({
            "part": of.part.name(),
            "kind": of.kind.name(),
            "sign": if of.is_negative { "-" } else { "+" },
            "teeth": of.teeth,
        })).collect::<Vec<_>>(),
        "cannot_tell": remarks(diagnosis, is_fitted),
    })
}

fn name(error: ToothError) -> String {
    format!("{} {} of tooth {}", error.part.name(), error.kind.name().replace('_', "-"), error.tooth)
}

fn micrometres(mm: f64) -> String {
    format!("{:+.1} µm", tidy(1000.0 * mm))
}

/// The part for people.
pub(super) fn blocks(diagnosis: &Diagnosis, is_fitted: bool) -> Vec<Block> {
    let end = |found: &FoundError, at: usize| found.interval_mm[at].map_or_else(|| "open".to_owned(), micrometres);
    let mut rows: Vec<[String; 5]> = diagnosis
        .errors
        .iter()
        .map(|found| {
            let effect = format!("{:.1} µm", 1000.0 * found.effect_mm);
            [name(found.error), micrometres(found.value_mm), end(found, 0), end(found, 1), effect]
        })
        .collect();
    if !rows.is_empty() && is_fitted {
        let fitted = [("offset", diagnosis.offset_mm), ("stroke shift", diagnosis.shift_mm)];
        rows.extend(fitted.map(|(name, mm)| {
            [name.to_owned(), format!("{} mm", millimetres(tidy(mm))), String::new(), String::new(), String::new()]
        }));
    }
    let title = match (diagnosis.eccentricity_mm, diagnosis.leaves_more) {
        (Some(_), _) => "in place of an eccentricity",
        (None, true) => "explains a part of the curve",
        (None, false) => "explains the curve",
    };
    let mut table = Table::of(rows).text(title, |row| row[0].clone()).number("value", |row| row[1].clone());
    if diagnosis.is_likely() {
        table = table.number("from", |row| row[2].clone()).number("to", |row| row[3].clone());
    }
    let table = table.number("changes ΔCD by", |row| row[4].clone());
    let mut blocks: Vec<Block> = table.block_if_any().into_iter().collect();
    let stated = if diagnosis.noise_is_stated { "stated" } else { "estimated from second differences" };
    let left = format!(
        "left is an rms of {} mm, and the noise is {} mm ({stated})",
        unsigned(diagnosis.rms_left_mm),
        unsigned(diagnosis.noise_mm)
    );
    blocks.push(Block::Note(match (diagnosis.errors.len(), diagnosis.leaves_more, diagnosis.eccentricity_mm) {
        (count, _, Some(mm)) => format!(
            "an eccentricity of the pinion of {:.1} µm explains the curve as well as these {count} errors of teeth: write it into the spec, \
             pinion.deviation = [{{ eccentricity = … }}], and look again; {left}",
            1000.0 * tidy(mm)
        ),
        (0, ..) => format!("no error of a tooth stands out of the noise; {left}"),
        (_, true, None) => format!("errors of single teeth do not explain the curve; {left}"),
        (1, ..) => format!("one error explains the curve; {left}"),
        (count, ..) => format!("{count} errors explain the curve; {left}"),
    }));
    blocks.extend(remarks(diagnosis, is_fitted).into_iter().map(Block::Note));
    blocks
}

/// Where more is left than the noise.
const NOT_EXPLAINED: &str = "what is left is more than the noise: check module, pressure angle, teeth and hands of the spec first; errors \
                             named here may stand for others, and their intervals do not hold";

/// What the curve cannot tell.
fn remarks(diagnosis: &Diagnosis, is_fitted: bool) -> Vec<String> {
    let is_unexplained = diagnosis.leaves_more && diagnosis.eccentricity_mm.is_none();
    let mut remarks: Vec<String> = is_unexplained.then(|| NOT_EXPLAINED.to_owned()).into_iter().collect();
    remarks.extend(diagnosis.errors.iter().filter(|found| !found.alternatives.is_empty()).map(same_curve));
    let open = |found: &&FoundError| found.interval_mm.contains(&None);
    remarks.extend(diagnosis.errors.iter().filter(open).map(|found| {
        format!(
            "the curve shows one side only of the {}: at the open end its size may be any, and \
             the value is the one nearest to the other end",
            name(found.error)
        )
    }));
    if is_fitted && !diagnosis.errors.is_empty() && diagnosis.at_an_end {
        remarks.push(AT_AN_END.to_owned());
    }
    if is_fitted {
        remarks.push(format!(
            "an over-roller error of all spaces, a radial one of all pinion teeth and an offset of the gauge have the same curve: which of \
             them the {} mm are is undecidable",
            millimetres(tidy(diagnosis.offset_mm))
        ));
    }
    if !diagnosis.unseen.is_empty() {
        let unseen: Vec<_> = diagnosis.unseen.iter().map(unseen).collect();
        let size = 1000.0 * UNSEEN_MM;
        remarks.push(format!("an error of {size:.0} µm would not show: {}", unseen.join("; ")));
    }
    remarks
}

fn elsewhere(other: &Alternative) -> String {
    let shift = |mm: f64| format!(" at a stroke shift of {} mm", millimetres(tidy(mm)));
    other.shift_mm.map_or_else(String::new, shift)
}

fn same_curve(found: &FoundError) -> String {
    const MOST: usize = 6;
    let others = found.alternatives.iter().take(MOST);
    let mut others: Vec<_> = others
        .map(|other| format!("{} {}{}", name(other.error), micrometres(other.value_mm), elsewhere(other)))
        .collect();
    if let more @ 1.. = found.alternatives.len().saturating_sub(MOST) {
        others.push(format!("{more} more"));
    }
    format!("the {} has the same curve as: {}", name(found.error), others.join(", "))
}

fn unseen(of: &Unseen) -> String {
    let sign = if of.is_negative { "−" } else { "+" };
    let kind = format!("{} {} {sign}", of.part.name(), of.kind.name().replace('_', "-"));
    if of.teeth.len() == of.of {
        return format!("{kind} of any tooth");
    }
    let mut runs: Vec<[i64; 2]> = Vec::new();
    for tooth in &of.teeth {
        match runs.last_mut() {
            Some([_, last]) if *last + 1 == *tooth => *last = *tooth,
            _ => runs.push([*tooth, *tooth]),
        }
    }
    let run = |[first, last]: &[i64; 2]| if first == last { first.to_string() } else { format!("{first} to {last}") };
    format!("{kind} of {}", runs.iter().map(run).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::Part;
    use crate::trace::ToothErrorKind;

    /// Where more is left than the noise, nothing is called explained, and a size has no interval.
    #[test]
    fn what_is_left_is_said_before_anything_is_called_explained() {
        let error = ToothError { part: Part::Rack, kind: ToothErrorKind::Shift, tooth: 5 };
        let found = FoundError {
            error,
            value_mm: 0.018,
            interval_mm: [Some(0.017), Some(0.019)],
            effect_mm: 0.02,
            alternatives: Vec::new(),
        };
        let said = |leaves_more, eccentricity_mm| {
            let diagnosis = Diagnosis {
                errors: vec![found.clone()],
                noise_mm: 0.001,
                noise_is_stated: false,
                rms_left_mm: 0.004,
                leaves_more,
                eccentricity_mm,
                explained_mm: Vec::new(),
                offset_mm: 0.0,
                shift_mm: 0.0,
                at_an_end: false,
                candidates: 100,
                threshold: 20.0,
                unseen: Vec::new(),
            };
            let pair = crate::reproduction::pair().expect("a valid pair");
            let ends = errors_json(&diagnosis, &pair)[0]["interval_mm"].clone();
            (format!("{:?}", blocks(&diagnosis, false)), ends)
        };
        let ((all, ends), (part, no_ends)) = (said(false, None), said(true, None));
        assert_eq!((ends, no_ends), (json!([0.017, 0.019]), json!([null, null])));
        assert!(all.contains("one error explains the curve") && all.contains("+19.0 µm"), "{all}");
        assert!(part.contains("do not explain the curve; left") && part.contains(NOT_EXPLAINED), "{part}");
        assert!(!part.contains("error explains") && !part.contains("+19.0 µm"), "{part}");
        let (simpler, no_ends) = said(false, Some(0.015));
        assert!(
            simpler.contains("an eccentricity of the pinion of 15.0 µm explains the curve as well")
                && !simpler.contains("+19.0 µm"),
            "{simpler}"
        );
        assert_eq!(no_ends, json!([null, null]));
    }
}
