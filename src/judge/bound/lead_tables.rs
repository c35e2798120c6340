//! Tables of what leads ask for and give way, node by node. A node is computed when it is first needed.

use std::sync::OnceLock;

use super::Extent;
use crate::deviation::Part;
use crate::gear::Pair;
use crate::trig;

/// The most that leads ask for and give way, at the nodes of a table. Each node is computed once, because the rows of a
/// batch need it again and again.
#[derive(Debug, Default)]
pub(super) struct LeadTables {
    /// Distance of the nodes: rad for the rack, mm for the pinion.
    pub(super) spacing: [f64; 2],
    nodes: Vec<OnceLock<LeadDemand>>,
}

/// Nodes of a table on either side of 0.
pub(super) const NODES_A_SIDE: i32 = 128;
const NODES: usize = 2 * NODES_A_SIDE as usize + 1;
/// A table for each part and extent.
const TABLES: usize = 2 * Extent::EVERY.len();

/// The most that leads ask for, alone and with undercut, the most that they give way, and either at any one stroke.
#[derive(Debug, Clone, Copy)]
pub(super) struct LeadDemand {
    pub(super) most: f64,
    pub(super) with_undercut: f64,
    pub(super) gives_way: f64,
    pub(super) at_any_time: f64,
}

impl LeadTables {
    /// The tables of a pair, as far as leads within its reach go.
    pub(super) fn new(pair: &Pair, largest_mm: f64) -> Self {
        /// Faces that cover each other in part leave more to a lead than its formula says.
        const FARTHER: f64 = 4.0;
        let tan_alpha = trig::tan(pair.normal_pressure_angle_rad());
        let rack = largest_mm * 2.0 * tan_alpha / pair.rack().face_width_mm;
        let spacing = [rack, largest_mm].map(|largest| FARTHER * largest / f64::from(NODES_A_SIDE));
        Self { spacing, nodes: (0..TABLES * NODES).map(|_| OnceLock::new()).collect() }
    }

    /// The node at this distance from the node of 0.
    pub(super) fn node(&self, part: Part, extent: Extent, index: i32) -> &OnceLock<LeadDemand> {
        let table = Extent::EVERY.len() * part as usize + extent as usize;
        &self.nodes[NODES * table + (index + NODES_A_SIDE) as usize]
    }
}
