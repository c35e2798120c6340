//! The closed table of a Q-DAS file. Each characteristic has a role or is left out by a rule, each remark is left out by a rule, and the
//! format owns everything else.

use std::collections::HashSet;
use std::sync::Arc;

use super::table::title;
use super::{Characteristic, LeftOut, Qdas};
use crate::deviation::{DeviationKind, DeviationValue};
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::quantity::{Decimal, Unit};
use crate::table::Table;
use crate::table::account::Unclosed;
use crate::table::cell::head_rows;
use crate::table::column::{SMALLEST_DIGIT, in_words};
use crate::table::contract::{File, of_records, refuse_wide};
use crate::table::field::{Field, ValueKind};
use crate::table::layout::{Layout, Parts};
use crate::table::ledger::digest;
use crate::table::number::{DecimalMark, quantity};
use crate::table::reading::NotUsed;
use crate::table::want::{GivenColumn, Want};

/// The table of a file.
///
/// # Errors
/// Everything that has no owner; values with points and with commas, or of several parts in one row.
pub(crate) fn qdas_table(name: &str, qdas: Qdas, want: &Want) -> Result<Table, Unclosed> {
    let layout = want.contract();
    let want = &with_nominals(&qdas, &layout, want)?;
    let mut file = File { said: qdas.said.clone(), ..File::new(name, "Q-DAS") };
    qdas.remarks.tell(&mut file, &layout);
    let left_out = qdas.left_out.clone();
    let has_names = qdas.part_names.len() > 0;
    let titles = qdas.characteristics.iter().map(|one| digest(0, 0, title(one, &layout).as_bytes()));
    refuse_wide(name, titles.collect::<HashSet<_>>().len() + 1)?;
    let table = Arc::new(qdas.table(&layout));
    let mark = table.mark().map_err(|line| {
        let message = format!("{name} has values with decimal points and with commas: one of them is in line {line}");
        Diagnostic::error(Code::BadTable, message).help("write every value with the same mark")
    })?;
    if let Some(refused) = table.mixed(name) {
        return Err(refused.into());
    }
    let mut head = vec![table.header(&layout)];
    let rows = head_rows(head[0].cells.len()).min(table.len());
    head.extend((0..rows).filter_map(|row| table.record(row)));
    let widest = |column: usize, unit: Unit| table.widest(column, unit);
    file.widest = Some(&widest);
    let all = Arc::clone(&table);
    let rest = (rows..table.len()).filter_map(move |row| all.record(row)).map(Ok);
    // each row is a part
    let layout = Arc::new(Layout { parts: Some(Parts::Rows), part_id: None, teeth: false, ..Layout::clone(&layout) });
    let mut found = of_records(&file, head, rest, &layout, want).map_err(|unclosed| {
        if left_out.is_empty() { unclosed } else { with_left_out(unclosed.into(), &left_out).into() }
    })?;
    found.reading.decimal_mark = mark.map(DecimalMark::word);
    found.reading.header_line = None;
    // the number of a row is no name of a part
    found.refuses_repeats &= has_names;
    for left_out in left_out {
        let LeftOut { code, count, first_line } = &left_out;
        let meaning = left_out.meaning().map_or_else(String::new, |meaning| format!(" ({meaning})"));
        let values =
            if *count == 1 { "1 value does not count".to_owned() } else { format!("{count} values do not count") };
        let note = format!("{name}: attribute {code}{meaning}: {values}, the first in line {first_line}");
        found.reading.notes.push(note);
        let title = format!("values with attribute {code}");
        found.reading.not_used.push(NotUsed { title, why: "they do not count" });
    }
    Ok(found)
}

/// The refusal of a file, with the values that do not count.
fn with_left_out(Diagnostics(mut problems): Diagnostics, left_out: &[LeftOut]) -> Diagnostics {
    let codes: Vec<_> =
        left_out.iter().map(|left_out| format!("{} ({} times)", left_out.code, left_out.count)).collect();
    if let (Some(problem), false) = (problems.first_mut(), codes.is_empty()) {
        problem.message += &format!("; values with these attributes do not count: {}", codes.join(", "));
    }
    Diagnostics(problems)
}

/// What is known of the table, with the nominal values of the file (K2101). A characteristic that has one holds measured values,
/// whatever its name says, unless the spec says deviations.
fn with_nominals(qdas: &Qdas, layout: &Layout, want: &Want) -> Result<Want, Diagnostics> {
    let mut want = want.clone();
    for characteristic in &qdas.characteristics {
        let Some(kind) = Qdas::error_of(characteristic, layout) else { continue };
        let is_deviation = want.given(kind).is_some_and(|given| given.holds == Some(ValueKind::Deviation));
        let nominal = nominal_of(characteristic, kind, &want).filter(|nominal| !nominal.is_zero() && !is_deviation);
        let Some(nominal) = nominal else { continue };
        let known = want.given.iter().position(|given| given.kind == kind);
        let at = known.unwrap_or_else(|| {
            want.given.push(GivenColumn { kind, unit: None, holds: None, nominal: None, length: None });
            want.given.len() - 1
        });
        let given = &mut want.given[at];
        match &given.nominal {
            // a nominal value in inches is rounded
            Some(Ok(stated)) if (stated.base() - nominal.base()).abs() > SMALLEST_DIGIT => {
                let message = format!(
                    "the nominal value of {kind} is {} in the file (K2101 of `{}`) and {} in the spec or another characteristic",
                    in_words(nominal),
                    characteristic.name,
                    in_words(*stated)
                );
                return Err(Diagnostic::error(Code::BadTable, message).help("correct the one that is wrong").into());
            }
            Some(Ok(_)) => {}
            None if !nominal.is_size(want.module) => {
                let message = format!(
                    "K2101 of `{}`, {}, may be the nominal value or a limit",
                    characteristic.name,
                    in_words(nominal)
                );
                let help = format!("give the nominal value in the spec: [errors] {} = {{ nominal = … }}", kind.key());
                return Err(Diagnostic::error(Code::BadTable, message).help(help).into());
            }
            _ => given.nominal = Some(Ok(nominal)),
        }
        given.holds = given.holds.or(Some(ValueKind::Measured));
    }
    Ok(want)
}

/// The nominal value of a characteristic, in its unit or else in that of the spec.
fn nominal_of(characteristic: &Characteristic, kind: DeviationKind, want: &Want) -> Option<DeviationValue> {
    let number = Decimal::parse(characteristic.nominal.as_deref()?).ok()?;
    let default = if Field::Error(kind).is_angle() { "°" } else { "mm" };
    let unit = match characteristic.unit.as_deref() {
        Some(symbol) => Unit::from_symbol(symbol),
        None => want.given(kind).and_then(|given| given.unit).or_else(|| Unit::from_symbol(default)),
    };
    quantity(number, unit?).ok()
}
