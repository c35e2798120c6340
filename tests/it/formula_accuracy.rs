//! Every formula against an independent implementation with 256-bit numbers; see `common/formulas.rs`.

use crate::common::formulas;

#[test]
fn pitch_errors() {
    formulas::rack_pitch();
    formulas::pinion_pitch();
}

#[test]
fn lead_errors() {
    formulas::rack_lead();
    formulas::rack_lead_by_slope();
    formulas::pinion_lead();
}

#[test]
fn pins() {
    formulas::pins();
}
