//! The uncertainty of a quantity and the distribution of its values.

named! {
    /// The distribution of the values that a quantity may have, of half-width a.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    #[non_exhaustive]
    pub enum Distribution {
        /// Normal; Student's t where the degrees of freedom are finite (JCGM 101, 6.4.9).
        Normal = "normal",
        /// All values within ±a are equally probable: u = a/√3.
        Rectangular = "rectangular",
        /// The probability falls linearly from the middle to ±a: u = a/√6.
        Triangular = "triangular",
        /// Values as those of a sine of amplitude a, mostly near ±a: u = a/√2.
        Arcsine = "arcsine",
    }
}

impl Distribution {
    /// Half-width a in standard uncertainties, a / u; for a normal distribution that of 95.45 %, 2.
    #[must_use]
    pub fn half_width(self) -> f64 {
        match self {
            Self::Normal => 2.0,
            Self::Rectangular => 3.0_f64.sqrt(),
            Self::Triangular => 6.0_f64.sqrt(),
            Self::Arcsine => std::f64::consts::SQRT_2,
        }
    }
}

/// The uncertainty of one quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// Standard uncertainty u, mm or degrees.
    pub standard: f64,
    /// The distribution of its values.
    pub distribution: Distribution,
    /// Degrees of freedom ν of u; infinite if u is exact.
    pub dof: f64,
    /// Whether ν is stated or follows from the distribution; otherwise it is assumed.
    pub is_dof_stated: bool,
}

impl Uncertainty {
    /// A standard uncertainty u of a normal distribution, with infinite degrees of freedom.
    #[must_use]
    pub const fn standard(u: f64) -> Self {
        Self { standard: u, distribution: Distribution::Normal, dof: f64::INFINITY, is_dof_stated: true }
    }

    /// The standard uncertainty u = U / k from an expanded uncertainty U and its coverage factor k, above 0 (JCGM 100:2008,
    /// clause 4.3.3).
    #[must_use]
    pub fn expanded(expanded: f64, k: f64) -> Self {
        Self::standard(expanded / k)
    }

    /// The standard uncertainty u from a half-width a and its distribution: a / 2 (normal), a / √3 (rectangular), a / √6
    /// (triangular) or a / √2 (arcsine) (JCGM 100:2008, clause 4.3.7).
    #[must_use]
    pub fn half_width(half_width: f64, distribution: Distribution) -> Self {
        Self { distribution, ..Self::standard(half_width / distribution.half_width()) }
    }
}
