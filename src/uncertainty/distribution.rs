//! The uncertainty of a quantity and the distribution of its values. Holds numbers only, and knows nothing of formulas.

named! {
    /// How the values that a quantity may have are distributed.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    #[non_exhaustive]
    pub enum Distribution {
        /// Normal; Student's t where the degrees of freedom are finite (JCGM 101, 6.4.9).
        Normal = "normal",
        /// All values within the half-width are equally probable: u = a/√3.
        Rectangular = "rectangular",
        /// Falling linearly from the middle: u = a/√6.
        Triangular = "triangular",
        /// Distributed like the values of a sine wave, mostly near the ends: u = a/√2.
        Arcsine = "arcsine",
    }
}

impl Distribution {
    /// Half-width in standard uncertainties; for a normal distribution, that of 95.45 %.
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
    /// How its values are distributed.
    pub distribution: Distribution,
    /// Degrees of freedom ν of u; infinite if u is known well.
    pub dof: f64,
    /// Whether ν was stated or follows from the distribution; otherwise it is assumed.
    pub is_dof_stated: bool,
}

impl Uncertainty {
    /// A standard uncertainty that is known well, normal.
    #[must_use]
    pub const fn standard(u: f64) -> Self {
        Self { standard: u, distribution: Distribution::Normal, dof: f64::INFINITY, is_dof_stated: true }
    }

    /// From an expanded uncertainty U = k u.
    #[must_use]
    pub fn expanded(expanded: f64, k: f64) -> Self {
        Self::standard(expanded / k)
    }

    /// From a half-width and its distribution.
    #[must_use]
    pub fn half_width(half_width: f64, distribution: Distribution) -> Self {
        Self { distribution, ..Self::standard(half_width / distribution.half_width()) }
    }
}
