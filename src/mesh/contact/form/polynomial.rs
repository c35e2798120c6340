//! Polynomials of second degree: what a surface with form asks for along a generator, and a value with its rate.

use std::ops::{Add, Mul, Sub};

/// a x² + b x + c, of a product no higher power: along a generator in w, or near a place a value c with its rate b.
#[derive(Debug, Clone, Copy)]
pub(super) struct Polynomial {
    pub(super) a: f64,
    pub(super) b: f64,
    pub(super) c: f64,
}

impl Polynomial {
    pub(super) fn line(b: f64, c: f64) -> Self {
        Self { a: 0.0, b, c }
    }

    pub(super) fn at(&self, w: f64) -> f64 {
        (self.a * w + self.b) * w + self.c
    }

    pub(super) fn slope_at(&self, w: f64) -> f64 {
        2.0 * self.a * w + self.b
    }

    /// The places where the polynomial is zero; only finite ones.
    pub(super) fn roots(&self) -> [f64; 2] {
        let root = (self.b * self.b - 4.0 * self.a * self.c).sqrt();
        let far = -0.5 * (self.b + root.copysign(self.b));
        [far / self.a, self.c / far]
    }
}

impl From<f64> for Polynomial {
    fn from(c: f64) -> Self {
        Self::line(0.0, c)
    }
}

impl Add for Polynomial {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { a: self.a + other.a, b: self.b + other.b, c: self.c + other.c }
    }
}

impl Sub for Polynomial {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { a: self.a - other.a, b: self.b - other.b, c: self.c - other.c }
    }
}

impl Mul for Polynomial {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            a: self.a * other.c + self.b * other.b + self.c * other.a,
            b: self.b * other.c + self.c * other.b,
            c: self.c * other.c,
        }
    }
}

impl Mul<f64> for Polynomial {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { a: self.a * factor, b: self.b * factor, c: self.c * factor }
    }
}
