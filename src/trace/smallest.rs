//! The smallest set: errors without which the others do as well go, and several errors of neighbouring teeth become one.

use super::TraceError;
use super::search::{SAME_CURVE, Search, Watch};
use super::tooth_error::ToothError;
use crate::deviation::Part;

impl Search<'_> {
    /// χ² with the errors found, plus the threshold for each of them.
    pub(super) fn cost(&self) -> f64 {
        let square = self.chi_square(&self.errors, self.shift_mm).unwrap_or(f64::INFINITY);
        square + self.threshold * self.errors.len() as f64
    }

    /// Removes errors without which the others explain the curve as well.
    pub(super) fn remove_needless(&mut self) -> Result<(), TraceError> {
        while !self.errors.is_empty() {
            let without = |at: usize| {
                let mut fewer = self.clone();
                fewer.errors.remove(at);
                fewer.refit_below(self.cost())?;
                Ok((fewer.cost(), fewer))
            };
            let tried: Vec<(f64, Self)> = (0..self.errors.len()).map(without).collect::<Result<_, TraceError>>()?;
            let least = tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
            match least.filter(|(cost, _)| *cost < self.cost()) {
                Some((_, fewer)) => *self = fewer,
                None => break,
            }
        }
        Ok(())
    }

    /// Replaces errors of a tooth, or of neighbours, by one of these teeth, as long as one explains as much as they do.
    pub(super) fn simplify(&mut self, watch: &mut Watch<'_>) -> Result<(), TraceError> {
        while let Some(fewer) = self.merged(watch)? {
            *self = fewer;
            self.remove_needless()?;
        }
        Ok(())
    }

    /// The search with one error instead of two or three, if that has the lower cost.
    fn merged(&self, watch: &mut Watch<'_>) -> Result<Option<Self>, TraceError> {
        for group in self.groups() {
            let is_of_group =
                |one: &ToothError| group.iter().any(|error| (one.part, one.tooth) == (error.part, error.tooth));
            let merged = self.replaced(&group, is_of_group, self.cost(), watch)?;
            if merged.is_some() {
                return Ok(merged);
            }
        }
        Ok(None)
    }

    /// Exchanges an error for any other one as long as that lowers the cost: an error found first may explain a part of several.
    pub(super) fn exchange(&mut self, watch: &mut Watch<'_>) -> Result<(), TraceError> {
        /// The most exchanges in a row.
        const MOST: usize = 4;
        let (mut at, mut exchanged) = (0, 0);
        while let Some((error, _)) = self.errors.get(at).filter(|_| exchanged < MOST) {
            match self.replaced(&[*error], |_| true, self.cost() - SAME_CURVE, watch)? {
                Some(other) => {
                    *self = other;
                    self.remove_needless()?;
                    (at, exchanged) = (0, exchanged + 1);
                }
                None => at += 1,
            }
        }
        Ok(())
    }

    /// The search with one error instead of some, if its cost is below a given one.
    fn replaced(
        &self,
        some: &[ToothError],
        is_tried: impl Fn(&ToothError) -> bool,
        below: f64,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Self>, TraceError> {
        /// The errors that are tried.
        const TRIED: usize = 2;
        let others: Vec<_> = self.errors.iter().filter(|(error, _)| !some.contains(error)).copied().collect();
        let means = self.sight(&others, &self.means, false)?;
        let points = self.sight(&others, &self.points, false)?;
        let screened = self.screened(&others, &means, is_tried, watch)?;
        let best = self.best(&others, (&means, &points), &screened, self.threshold)?;
        for (error, explains) in best.into_iter().take(TRIED) {
            let mut replaced = self.clone();
            replaced.errors.clone_from(&others);
            replaced.errors.push((error, explains.size_mm));
            replaced.refit_below(below)?;
            if replaced.cost() < below {
                return Ok(Some(replaced));
            }
        }
        Ok(None)
    }

    /// Three errors, then two, of one part whose teeth are the same or neighbours.
    fn groups(&self) -> Vec<Vec<ToothError>> {
        let errors: Vec<ToothError> = self.errors.iter().map(|(error, _)| *error).collect();
        let teeth = i64::from(self.mesh.pair().pinion().teeth);
        let is_near = |a: &ToothError, b: &ToothError| {
            let apart = match a.part {
                Part::Rack => (a.tooth - b.tooth).abs(),
                Part::Pinion => (a.tooth - b.tooth).rem_euclid(teeth).min((b.tooth - a.tooth).rem_euclid(teeth)),
            };
            a.part == b.part && apart <= 1
        };
        let mut groups: Vec<Vec<ToothError>> = Vec::new();
        for (at, a) in errors.iter().enumerate() {
            for (next, b) in errors.iter().enumerate().skip(at + 1).filter(|(_, b)| is_near(a, b)) {
                let third = errors.iter().skip(next + 1).filter(|c| is_near(a, c) && is_near(b, c));
                groups.extend(third.map(|c| vec![*a, *b, *c]));
                groups.push(vec![*a, *b]);
            }
        }
        groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
        groups
    }
}
