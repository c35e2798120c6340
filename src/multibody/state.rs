//! Where the bodies are, and the forces on them. Passed between the runs and the contact; computes nothing.

/// The coordinates, or their rates (rad/s, mm/s).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Coordinates {
    /// Pinion rotation ψ since s = 0, positive as the stroke rises, rad.
    pub pinion_angle: f64,
    /// Centre distance a, mm.
    pub center_distance: f64,
    /// Rack roll φ about +X, rad.
    pub roll: f64,
    /// Stroke s, mm.
    pub stroke: f64,
}

impl Coordinates {
    pub(super) fn from_free(free: [f64; 3], stroke: f64) -> Self {
        Self { pinion_angle: free[0], center_distance: free[1], roll: free[2], stroke }
    }

    pub(super) fn all(&self) -> [f64; 4] {
        [self.pinion_angle, self.center_distance, self.roll, self.stroke]
    }
}

/// The contact at one position.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Forces {
    /// Generalised contact forces on ψ (N mm), a (N), φ (N mm), s (N).
    pub generalized: [f64; 4],
    /// −∂force/∂coordinate for ψ, a, φ.
    pub stiffness: [[f64; 3]; 3],
    /// −∂force/∂rate for ψ, a, φ.
    pub damping: [[f64; 3]; 3],
    /// Sum of the normal forces' components along the rack, without sign, N.
    pub along: f64,
    /// Elastic energy, N mm.
    pub energy: f64,
    /// Power lost to damping, N mm/s.
    pub damped: f64,
    /// Power lost to friction, N mm/s.
    pub rubbed: f64,
    /// Sum of normal forces on right rack flanks, N.
    pub normal_right: f64,
    /// Sum of normal forces on left rack flanks, N.
    pub normal_left: f64,
    /// Elements that touch.
    pub contacts: u32,
    /// Largest penetration, mm.
    pub penetration: f64,
    /// Lowest and highest rack tooth that touches.
    pub teeth: Option<(i64, i64)>,
    /// Rack teeth whose right and left flank carry most.
    pub carrying: [Option<i64>; 2],
}

impl Forces {
    /// Power lost to damping and friction, N mm/s.
    #[must_use]
    pub const fn dissipation(&self) -> f64 {
        self.damped + self.rubbed
    }

    /// Sums of the normal forces on right and left rack flanks, N.
    pub(super) const fn normal_forces(&self) -> [f64; 2] {
        [self.normal_right, self.normal_left]
    }

    /// Adds elements of a flank of a rack tooth, which press with this force and go in as deep.
    pub(super) fn note(&mut self, (right, tooth): (bool, i64), contacts: u32, force: f64, penetration: f64) {
        if right {
            self.normal_right += force;
        } else {
            self.normal_left += force;
        }
        self.contacts += contacts;
        self.penetration = self.penetration.max(penetration);
        self.teeth = Some(self.teeth.map_or((tooth, tooth), |(low, high)| (low.min(tooth), high.max(tooth))));
    }
}

/// Positions and velocities with the forces there.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    pub(super) time: f64,
    pub(super) q: [f64; 3],
    pub(super) v: [f64; 3],
    pub(super) stroke: f64,
    pub(super) speed: f64,
    /// Generalised forces, the closing force included.
    pub(super) f: [f64; 3],
    pub(super) contact: Forces,
}
