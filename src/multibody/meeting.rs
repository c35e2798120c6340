//! A flank pair in a position, and those rows of the pinion's flank that may touch. Made by the scene for every flank
//! pair of a position; the contact models find the contacts of its rows.

use super::bound::{Bound, Reach, SLACK, row_range};
use super::flank::{Bounds, FlankPair, FlankPosition, Pose};
use super::template::{EARLY, Row, Template};
use crate::trig;

/// A flank pair in a position.
pub(super) struct Meeting<'a> {
    pub(super) pair: &'a FlankPair,
    pub(super) template: &'a Template,
    pub(super) pose: &'a Pose,
    pub(super) reach: &'a Reach,
    pub(super) placed: FlankPosition,
    pub(super) bound: Bound,
}

/// A row of the pinion's flank in a position.
pub(super) struct PlacedRow<'a> {
    pub(super) row: &'a Row,
    /// Roll angle at which it crosses the contact line.
    pub(super) crossing: f64,
    /// Sine and cosine of the angle by which it is turned.
    pub(super) sin: f64,
    pub(super) cos: f64,
}

impl<'a> Meeting<'a> {
    /// `None` if nothing of the flanks touches.
    pub(super) fn new(pair: &'a FlankPair, template: &'a Template, pose: &'a Pose, reach: &'a Reach) -> Option<Self> {
        let placed = pair.place(pose);
        let bound = Bound::new(template, &placed, reach.margin);
        if reach.cull && bound.clears_flank(template.half_face) {
            return None;
        }
        Some(Self { pair, template, pose, reach, placed, bound })
    }

    /// The rows that are not clear of the rack all along.
    pub(super) fn rows(&self) -> impl Iterator<Item = PlacedRow<'a>> {
        let Self { template, reach, placed, bound, .. } = *self;
        let rows = &template.rows;
        let range = if reach.cull { row_range(template, &placed, reach.polar) } else { 0..rows.len() };
        let line = placed.nu - placed.c;
        let (sin_c, cos_c) = trig::sin_cos(placed.c);
        let rows = rows[range].iter().filter(move |row| !(reach.cull && bound.clears(row.w)));
        rows.map(move |row| PlacedRow {
            row,
            crossing: line + template.kappa * row.w,
            sin: sin_c * row.cos - cos_c * row.sin,
            cos: cos_c * row.cos + sin_c * row.sin,
        })
    }

    /// Whether a row's contact line lies so little before the profile's start that the rack's tip tells what is clear.
    pub(super) fn is_early(&self, row: &PlacedRow<'_>) -> bool {
        self.reach.cull && row.crossing < self.template.start_roll && row.crossing >= -EARLY
    }

    /// A roll angle below which nothing of an early row touches, for the rack's tip is lower; `None` if none of it does.
    pub(super) fn floor(&self, row: &PlacedRow<'_>) -> Option<f64> {
        let Self { pair, template: t, pose, placed, bound, .. } = self;
        let &PlacedRow { row: Row { w, .. }, crossing, sin, cos } = row;
        let start = t.start_roll;
        if placed.nu + (t.tip_roll - crossing) > std::f64::consts::PI - placed.nu {
            return Some(start);
        }
        let (sin, cos) = (sin * t.cos_start + cos * t.sin_start, cos * t.cos_start - sin * t.sin_start);
        let early = crossing.min(0.0);
        let deepest = (bound.stop - bound.height(*w) - bound.early * early * early * early).max(0.0);
        let margin = (deepest * (deepest + 2.0 * t.widest)).sqrt() + SLACK;
        let misfit = t.widest * (placed.length - t.cos_base).max(0.0);
        let Bounds { half_width, tip, .. } = pair.bounds;
        let lifted = (half_width + margin) * pose.sin_roll.abs()
            + (tip + pose.shared.depth + margin).abs() * (1.0 - pose.cos_roll);
        // of the tooth system's axis over the rack's reference plane
        let top = pose.at.center_distance + placed.eccentric.1;
        let height = top - t.base_radius * (cos + start * sin) - misfit - tip - margin - lifted;
        if height <= 0.0 {
            return Some(start);
        }
        let floor = (start * start + 2.0 * height / (t.base_radius * cos)).sqrt();
        // no number if even the end of the profile rises
        (cos > 0.0 && floor <= t.tip_roll).then_some(floor)
    }
}
