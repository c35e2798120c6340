//! Every formula against an independent implementation with 448-bit numbers; see `common/formulas.rs`.

use crate::common::formulas::{self, angle, length};
use rackmesh::formula::{Model, RackLead};
use rackmesh::quantity::Angle;

#[test]
fn the_ideal_pin() {
    formulas::the_ideal_pin();
}

#[test]
fn the_measure_over_a_pin() {
    formulas::the_measure_over_a_pin();
}

#[test]
fn the_change_of_rollers() {
    formulas::the_change_of_rollers();
}

#[test]
fn over_roller_and_radial_errors() {
    formulas::over_roller_and_radial_errors();
}

#[test]
fn the_rack_pitch_error() {
    formulas::the_rack_pitch_error();
}

#[test]
fn the_pinion_pitch_error() {
    formulas::the_pinion_pitch_error();
}

#[test]
fn the_rack_lead_error() {
    formulas::the_rack_lead_error();
}

#[test]
fn the_lead_error_of_a_slope() {
    formulas::the_lead_error_of_a_slope();
}

#[test]
fn an_inverse_next_to_a_decimal_or_to_90_degrees_keeps_its_bound() {
    // At tiny angles the tangent is the angle to 40 digits, so that the inverse is almost a short decimal,
    // and a ΔCD far beyond the face width belongs to an angle that is almost 90°.
    for (alpha, width, delta_cd, largest) in [
        (1e-20, 1.0, 64.159_715_910_064_24, 1.283_194_318_201_284_6e-18),
        (20.0, 1.0, 1e300, 90.0_f64.next_down()),
        (20.0, 1e-300, 1.0, 90.0_f64.next_down()),
    ] {
        let formula = RackLead::new(&angle(alpha), &Angle::ZERO, &length(width)).unwrap();
        let inverse = formula.largest_error(&length(delta_cd), Model::Paper).unwrap();
        assert_eq!(inverse.degrees(), largest, "α_n {alpha:e} k {width:e}");
        assert!(formula.delta_cd(&inverse, Model::Paper).unwrap() <= length(delta_cd), "α_n {alpha:e} k {width:e}");
    }
}
