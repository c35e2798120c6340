//! The companions of a measured value, by role: its nominal value, its unit and the like. They are columns of a table, places of a
//! record, or cells.

use super::field::Beside as Role;

/// How many roles a companion can have.
const ROLES: usize = Role::Measured as usize + 1;

/// At most one companion of each role.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Companions<T>([Option<T>; ROLES]);

impl<T> Default for Companions<T> {
    fn default() -> Self {
        Self([const { None }; ROLES])
    }
}

impl<T> Companions<T> {
    pub(crate) fn iter(&self) -> impl Iterator<Item = &T> {
        self.0.iter().flatten()
    }

    pub(crate) fn get(&self, role: Role) -> Option<&T> {
        self.0.get(role as usize)?.as_ref()
    }

    pub(crate) fn set(&mut self, role: Role, companion: Option<T>) {
        if let Some(slot) = self.0.get_mut(role as usize) {
            *slot = companion;
        }
    }

    /// Turns each companion into something else; drops those for which `of` gives nothing.
    pub(crate) fn map<'a, U>(&'a self, of: impl Fn(&'a T) -> Option<U>) -> Companions<U> {
        Companions(self.0.each_ref().map(|companion| companion.as_ref().and_then(&of)))
    }
}
