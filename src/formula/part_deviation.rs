//! A deviation of a part together with the law that maps it to ΔCD. Built by the spec layer, evaluated by
//! [`evaluate`](crate::evaluation::evaluate); holds no number that the law does not.

use super::{Law, Model, Sensitivity};
use crate::deviation::{DeviationKind, DeviationValue, Extent};
use crate::quantity::{DomainError, Length};

/// The ends of a tolerance: plus and minus one value, or two values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToleranceEnds {
    /// The end farther from 0. If `nearer` is `None`, the other end is the same value with the other sign.
    pub farther: DeviationValue,
    /// The other end, where it is not as far from 0.
    pub nearer: Option<DeviationValue>,
}

impl ToleranceEnds {
    /// From the least to the greatest value of one dimension.
    #[must_use]
    pub fn from_to(lower: DeviationValue, upper: DeviationValue) -> Self {
        let (below, above) = (lower.base(), upper.base());
        match (below.abs() > above.abs(), below == -above) {
            (_, true) => Self { farther: upper, nearer: None },
            (true, false) => Self { farther: lower, nearer: Some(upper) },
            (false, false) => Self { farther: upper, nearer: Some(lower) },
        }
    }

    /// Both ends in mm or degrees, the lower one first.
    #[must_use]
    pub fn base(self) -> [f64; 2] {
        let farther = self.farther.base();
        let nearer = self.nearer.map_or(-farther, DeviationValue::base);
        [farther.min(nearer), farther.max(nearer)]
    }
}

/// One deviation of a rack or pinion and its law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartDeviation {
    law: Law,
    value: DeviationValue,
    extent: Extent,
    is_tolerance: bool,
    /// For a tolerance that is not symmetric, the end nearer to 0.
    nearer_end: Option<DeviationValue>,
    total: Option<Length>,
}

impl PartDeviation {
    /// An error that was measured or given, on the teeth that [`DeviationKind::usual_extent`] names.
    #[must_use]
    pub fn new(law: Law, value: impl Into<DeviationValue>) -> Self {
        Self {
            law,
            value: value.into(),
            extent: law.kind().usual_extent(),
            is_tolerance: false,
            nearer_end: None,
            total: None,
        }
    }

    /// A permissible deviation in place of a measured one: any value from −`value` to +`value`, different on each tooth unless
    /// another extent is given.
    #[must_use]
    pub fn within(law: Law, value: impl Into<DeviationValue>) -> Self {
        Self { law, value: value.into(), extent: Extent::Each, is_tolerance: true, nearer_end: None, total: None }
    }

    /// A permissible deviation that is not symmetric: any value between its ends, different on each tooth unless another extent
    /// is given.
    #[must_use]
    pub fn between(law: Law, ends: ToleranceEnds) -> Self {
        Self { nearer_end: ends.nearer, ..Self::within(law, ends.farther) }
    }

    /// The same error on other teeth.
    #[must_use]
    pub fn with_extent(self, extent: Extent) -> Self {
        Self { extent, ..self }
    }

    /// The same pitch tolerance where the total cumulative deviation F_p of either flank side is limited, too.
    #[must_use]
    pub fn within_total(self, total: Length) -> Self {
        Self { total: Some(total), ..self }
    }

    /// The limit of the total cumulative deviation F_p, if the tolerance has one.
    #[must_use]
    pub const fn total(&self) -> Option<Length> {
        self.total
    }

    /// The same kind of error on the same teeth with another value.
    #[must_use]
    pub fn with_value(self, value: impl Into<DeviationValue>) -> Self {
        Self { value: value.into(), nearer_end: None, ..self }
    }

    /// The ends of a tolerance.
    #[must_use]
    pub const fn tolerance(&self) -> ToleranceEnds {
        ToleranceEnds { farther: self.value, nearer: self.nearer_end }
    }

    /// The same error as a measured one, whose sign counts.
    #[must_use]
    pub fn measured(self) -> Self {
        Self { is_tolerance: false, ..self }
    }

    /// On which teeth it is.
    #[must_use]
    pub const fn extent(&self) -> Extent {
        self.extent
    }

    /// The kind of error.
    #[must_use]
    pub const fn kind(&self) -> DeviationKind {
        self.law.kind()
    }

    /// Whether the value is a permissible deviation, whose sign is not known.
    #[must_use]
    pub const fn is_tolerance(&self) -> bool {
        self.is_tolerance
    }

    /// The law without the value.
    #[must_use]
    pub const fn law(&self) -> Law {
        self.law
    }

    /// The error's value; for a permissible deviation, the end that is farther from 0.
    #[must_use]
    pub const fn value(&self) -> DeviationValue {
        self.value
    }

    /// ΔCD of this error.
    ///
    /// # Errors
    /// [`DomainError`] as [`Law::delta_cd`].
    pub fn delta_cd(&self, model: Model) -> Result<Length, DomainError> {
        self.law.delta_cd(self.value, model)
    }

    /// ∂ΔCD/∂input by the error and by the gear data of its law.
    ///
    /// # Errors
    /// [`DomainError`] as [`Law::delta_cd`].
    pub fn sensitivities(&self, model: Model) -> Result<Vec<Sensitivity>, DomainError> {
        self.law.sensitivities(self.value, model)
    }
}
