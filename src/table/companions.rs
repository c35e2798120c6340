//! What stands beside a measured value, by what it says of it: columns of the table, then places of a record, then cells.

use super::names::Role;

/// One of each companion that a value may have.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Companions<T> {
    /// The deviation beside a measured value.
    pub(crate) deviation: Option<T>,
    pub(crate) nominal: Option<T>,
    pub(crate) upper: Option<T>,
    pub(crate) lower: Option<T>,
    pub(crate) uncertainty: Option<T>,
    pub(crate) unit: Option<T>,
    /// The evaluation length of f_Hβ.
    pub(crate) length: Option<T>,
}

impl<T> Default for Companions<T> {
    fn default() -> Self {
        Self { deviation: None, nominal: None, upper: None, lower: None, uncertainty: None, unit: None, length: None }
    }
}

impl<T> Companions<T> {
    pub(crate) fn iter(&self) -> impl Iterator<Item = &T> {
        let Self { deviation, nominal, upper, lower, uncertainty, unit, length } = self;
        [deviation, nominal, upper, lower, uncertainty, unit, length].into_iter().flatten()
    }

    /// The companion of a role; `None` if no companion has it.
    pub(crate) fn of_role(&mut self, role: Role) -> Option<&mut Option<T>> {
        match role {
            Role::Nominal => Some(&mut self.nominal),
            Role::Deviation => Some(&mut self.deviation),
            Role::Upper => Some(&mut self.upper),
            Role::Lower => Some(&mut self.lower),
            Role::Uncertainty => Some(&mut self.uncertainty),
            Role::Unit => Some(&mut self.unit),
            Role::Part | Role::Name | Role::Measured | Role::Status => None,
        }
    }

    /// The same companions as something else; those of which nothing comes are left out.
    pub(crate) fn map<'a, U>(&'a self, of: impl Fn(&'a T) -> Option<U>) -> Companions<U> {
        let of = |companion: &'a Option<T>| companion.as_ref().and_then(&of);
        Companions {
            deviation: of(&self.deviation),
            nominal: of(&self.nominal),
            upper: of(&self.upper),
            lower: of(&self.lower),
            uncertainty: of(&self.uncertainty),
            unit: of(&self.unit),
            length: of(&self.length),
        }
    }
}
