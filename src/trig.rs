//! The only place that computes trigonometric functions. Angles are in rad or an [`Angle`].
//!
//! These functions are pure Rust and give the same bits on every machine. Those of the standard library differ in the last
//! bits between C libraries; a lint (`clippy.toml`) forbids them.

use crate::quantity::Angle;

/// Sine and cosine of an angle in radians.
#[must_use]
#[inline]
pub fn sin_cos(radians: f64) -> (f64, f64) {
    libm::sincos(radians)
}

/// Sine of an angle in radians.
#[must_use]
#[inline]
pub fn sin(radians: f64) -> f64 {
    libm::sin(radians)
}

/// Cosine of an angle in radians.
#[must_use]
#[inline]
pub fn cos(radians: f64) -> f64 {
    libm::cos(radians)
}

/// Tangent of an angle in radians.
#[must_use]
#[inline]
pub fn tan(radians: f64) -> f64 {
    libm::tan(radians)
}

/// Arc sine of x in −1 … 1, in radians; NaN outside.
#[must_use]
#[inline]
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// Arc cosine of x in −1 … 1, in radians; NaN outside.
#[must_use]
#[inline]
pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// Arc tangent, in radians.
#[must_use]
#[inline]
pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

/// Angle of the point (x, y) in radians, in (-π, π].
#[must_use]
#[inline]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// Sine and cosine of an [`Angle`]. The rounding of the angle to radians is corrected to first order.
#[must_use]
pub fn sin_cos_of(angle: Angle) -> (f64, f64) {
    let (radians, rest) = angle.radians_and_rest();
    let (sin, cos) = sin_cos(radians);
    (sin + rest * cos, cos - rest * sin)
}

/// Sine of an [`Angle`] within ±90°, with the same correction.
#[must_use]
#[inline]
pub fn sin_of(angle: Angle) -> f64 {
    let (radians, rest) = angle.radians_and_rest();
    // the correction needs the cosine to second order only
    sin(radians) + rest * (1.0 - 0.5 * radians * radians)
}

/// Tangent of an [`Angle`], with the same correction.
#[must_use]
pub fn tan_of(angle: Angle) -> f64 {
    let (radians, rest) = angle.radians_and_rest();
    let tan = tan(radians);
    tan + rest * (1.0 + tan * tan)
}
