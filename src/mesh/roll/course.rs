//! Where the search for the lowest roll begins: what was solved at this stroke and at the last one. Written and read by
//! [`roll`](super); no result depends on it by more than rounding.

/// A bracket around the expected bottom reaches at least this far, and exactly this far where no movement is known.
const NEAREST: f64 = 1e-6;
pub(super) const AROUND: f64 = 1e-3;
/// A roll solved at another stroke counts as this much farther away.
const OTHER_STROKE: f64 = 0.01;

/// Where the search at one stroke begins: what is known of rolls at this stroke and at the last one.
#[derive(Debug, Clone, Default)]
pub(in crate::mesh) struct Course {
    pub(super) here: Vec<Start>,
    pub(super) before: Vec<Start>,
    /// The bottoms of the last stroke and of the one before.
    pub(super) bottoms: [Option<f64>; 2],
    /// How often another tooth or peak asked for more at a bottom of this stroke.
    pub(super) surprises: u32,
}

/// The rotation, against where the rack's nearest tooth has the pinion, and the centre distance at a roll, with derivatives.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    pub(super) angle: f64,
    pub(super) at: [f64; 2],
    pub(super) rate: [f64; 2],
}

impl Course {
    /// The next stroke begins.
    pub(super) fn go_on(&mut self) {
        std::mem::swap(&mut self.here, &mut self.before);
        self.here.clear();
        self.surprises = 0;
    }

    /// The solution expected at a roll, from one that was solved within so much.
    pub(super) fn at(&self, angle: f64, within: f64) -> Option<[f64; 2]> {
        let near = |start: &Start, more: f64| (start.angle - angle).abs() + more;
        let here = self.here.iter().map(|start| (near(start, 0.0), start));
        let before = self.before.iter().map(|start| (near(start, OTHER_STROKE), start));
        let (away, start) = here.chain(before).min_by(|a, b| a.0.total_cmp(&b.0))?;
        (away <= within).then(|| [0, 1].map(|i| start.at[i] + start.rate[i] * (angle - start.angle)))
    }

    /// Where the bottom is expected, and within how much.
    pub(super) fn bottom(&self) -> Option<(f64, f64)> {
        let [last, earlier] = self.bottoms;
        let moved = earlier.zip(last).map_or(AROUND, |(earlier, last)| (last - earlier).abs());
        last.map(|last| (last, moved.clamp(NEAREST, AROUND)))
    }

    pub(super) fn ends_at(&mut self, bottom: f64) {
        self.bottoms = [Some(bottom), self.bottoms[0]];
    }
}
