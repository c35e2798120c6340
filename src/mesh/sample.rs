//! One stroke after the other, and many on all cores. Called through [`Sampler::at`], [`Mesh::at`], [`Mesh::sample`]
//! and [`Mesh::sample_blocks`]; deals strokes out and collects results, solves nothing itself.
//!
//! The result of many does not depend on the number of cores: strokes are dealt in blocks of fixed size, each solved from a
//! fresh start.

use std::convert::Infallible;

use super::{Mesh, MeshError, MeshPoint, Sampler, Support};
use crate::parallel;

/// Strokes to a block: long enough that starting one costs nothing, short enough to share out evenly. A rack that may roll
/// is solved at many rolls for each stroke, and flanks with form are searched.
const BLOCK: u64 = 512;
const SLOW_BLOCK: u64 = 16;

impl Sampler<'_> {
    /// Solves one stroke, faster near the last one. The result differs from that of a fresh start by rounding only.
    ///
    /// # Errors
    /// [`MeshError`] says why there is no mesh here.
    pub fn at(&mut self, stroke_mm: f64) -> Result<MeshPoint, MeshError> {
        self.work.strokes += 1;
        match self.mesh.support() {
            Support::Fixed => self.solve(stroke_mm),
            Support::FreeRoll { axis_depth_mm } => self.solve_rolling(stroke_mm, axis_depth_mm),
        }
    }
}

impl Mesh {
    /// Solves one stroke.
    ///
    /// # Errors
    /// [`MeshError`] says why there is no mesh here.
    pub fn at(&self, stroke_mm: f64) -> Result<MeshPoint, MeshError> {
        Sampler::new(self).at(stroke_mm)
    }

    /// Solves many strokes on all cores.
    #[must_use]
    pub fn sample(&self, strokes_mm: &[f64]) -> Vec<Result<MeshPoint, MeshError>> {
        let mut points = Vec::with_capacity(strokes_mm.len());
        let Ok(()) = self.sample_blocks(
            strokes_mm.len() as u64,
            |index| strokes_mm[index as usize],
            <[_]>::to_vec,
            |solved| -> Result<(), Infallible> {
                points.extend(solved.into_iter().map(|(_, point)| point));
                Ok(())
            },
        );
        points
    }

    /// Solves `count` strokes on all cores, applies `make` to each block of points there, and gives the results to `take` in the
    /// order of the strokes. Memory does not depend on the number of strokes.
    ///
    /// # Errors
    /// The first one of `take`, after which nothing more is solved.
    pub fn sample_blocks<T: Send, E>(
        &self,
        count: u64,
        stroke_mm: impl Fn(u64) -> f64 + Sync,
        make: impl Fn(&[(f64, Result<MeshPoint, MeshError>)]) -> T + Sync,
        take: impl FnMut(T) -> Result<(), E>,
    ) -> Result<(), E> {
        let block = if self.support() == Support::Fixed && !self.has_form() { BLOCK } else { SLOW_BLOCK };
        let make_block = |index: u64| {
            let mut sampler = Sampler::impartial(self);
            let strokes = (index * block..count.min((index + 1) * block)).map(&stroke_mm);
            let points: Vec<_> = strokes.map(|stroke| (stroke, sampler.at(stroke))).collect();
            make(&points)
        };
        parallel::in_order(parallel::cores(), count.div_ceil(block), make_block, take)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::{PinionFlanks, RackFlanks};
    use crate::gear::{Pair, PairData, PinionData, RackData};

    fn mesh() -> Mesh {
        let data = PairData {
            normal_module_mm: 2.0,
            normal_pressure_angle_rad: 0.35,
            rack: RackData { helix_angle_rad: 0.0, face_width_mm: 20.0, addendum_mm: 2.0, tooth_thickness_mm: None },
            pinion: PinionData {
                teeth: 20,
                helix_angle_rad: 0.2,
                profile_shift: 0.2,
                tip_diameter_mm: 45.6,
                root_form_diameter_mm: Some(39.0),
                face_width_mm: 24.0,
                tooth_thickness_deviation_mm: 0.0,
            },
        };
        Pair::new(&data).map(Mesh::nominal).expect("a valid pair").expect("nominal teeth are in order")
    }

    #[test]
    fn blocks_come_in_order_and_hold_every_stroke_once() {
        let mesh = mesh();
        for count in [0, 1, 511, 512, 513, 40_000] {
            let mut strokes = Vec::new();
            let only_strokes = |points: &[(f64, _)]| points.iter().map(|&(stroke, _)| stroke).collect::<Vec<_>>();
            let stroke = |index: u64| index as f64 * 1e-3;
            mesh.sample_blocks::<_, ()>(count, stroke, only_strokes, |block| {
                strokes.extend(block);
                Ok(())
            })
            .unwrap();
            assert_eq!(strokes, (0..count).map(stroke).collect::<Vec<_>>());
        }
    }

    #[test]
    fn blocks_of_a_rolling_rack_are_short() {
        let fixed = mesh();
        let (rack, pinion) = (RackFlanks::nominal(fixed.pair()), PinionFlanks::nominal(fixed.pair()));
        let rolling = Mesh::new(*fixed.pair(), rack, pinion, Support::FreeRoll { axis_depth_mm: 8.0 });
        let rolling = rolling.expect("nominal teeth are in order");
        for (mesh, expected) in [(fixed, vec![512, 88]), (rolling, [vec![16; 37], vec![8]].concat())] {
            let mut lengths = Vec::new();
            let taken = mesh.sample_blocks::<_, ()>(
                600,
                |_| 0.5,
                <[_]>::len,
                |length| {
                    lengths.push(length);
                    Ok(())
                },
            );
            assert_eq!((taken, lengths), (Ok(()), expected));
        }
    }

    #[test]
    fn nothing_is_solved_after_the_taker_has_enough() {
        let mesh = mesh();
        let solved = std::sync::atomic::AtomicUsize::new(0);
        let count = |points: &[_]| solved.fetch_add(points.len(), std::sync::atomic::Ordering::Relaxed);
        assert_eq!(mesh.sample_blocks(u64::MAX, |_| 1.0, count, |_| Err("enough")), Err("enough"));
        assert!(solved.into_inner() <= BLOCK as usize * parallel::HELD * parallel::cores());
    }
}
