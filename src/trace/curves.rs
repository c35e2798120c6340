//! The computed curve with some errors of teeth. A search asks for the same curve again and again, so the last ones are kept.

use std::sync::{Arc, Mutex};

use super::tooth_error::{ToothError, with_errors};
use super::{TraceError, sampled};
use crate::mesh::{Mesh, MeshError, MeshPoint, Sampler, Support};
use crate::parallel::lock;

/// A computed curve.
pub(super) struct Curve {
    errors: Vec<(ToothError, f64)>,
    pub(super) strokes_mm: Vec<f64>,
    /// ΔCD, mm.
    pub(super) model_mm: Vec<f64>,
    /// dΔCD/ds.
    pub(super) slopes: Vec<f64>,
}

/// The curves of a search and its copies that were solved last.
#[derive(Clone, Default)]
pub(super) struct Curves(Arc<Mutex<Vec<Arc<Curve>>>>);

impl Curves {
    /// How many are kept.
    const KEPT: usize = 8;

    /// The curve of a mesh with some more errors at rising strokes, mm.
    pub(super) fn of(
        &self,
        mesh: &Mesh,
        errors: &[(ToothError, f64)],
        strokes_mm: Vec<f64>,
    ) -> Result<Arc<Curve>, TraceError> {
        let is_it = |known: &&Arc<Curve>| known.errors == errors && known.strokes_mm == strokes_mm;
        if let Some(known) = lock(&self.0).iter().find(is_it) {
            return Ok(Arc::clone(known));
        }
        let mesh = with_errors(mesh, errors).ok_or(TraceError::NoSuchErrors)?;
        let (model_mm, slopes) = solved(&mesh, &strokes_mm)?;
        let curve = Arc::new(Curve { errors: errors.to_vec(), strokes_mm, model_mm, slopes });
        let mut kept = lock(&self.0);
        kept.insert(0, Arc::clone(&curve));
        kept.truncate(Self::KEPT);
        Ok(curve)
    }
}

/// ΔCD and its slope at strokes: the mesh's own rate, or a difference where the rack rolls.
fn solved(mesh: &Mesh, strokes_mm: &[f64]) -> Result<(Vec<f64>, Vec<f64>), MeshError> {
    const STEP_MM: f64 = 2e-4;
    if mesh.support() != Support::Fixed {
        let model = sampled(mesh, strokes_mm)?;
        let ahead = sampled(mesh, &strokes_mm.iter().map(|stroke| stroke + STEP_MM).collect::<Vec<_>>())?;
        let slopes = ahead.iter().zip(&model).map(|(ahead, here)| (ahead - here) / STEP_MM).collect();
        return Ok((model, slopes));
    }
    let (mut model, mut slopes) = (Vec::with_capacity(strokes_mm.len()), Vec::with_capacity(strokes_mm.len()));
    let strokes = |index: u64| strokes_mm[index as usize];
    let with_slopes = |points: &[(f64, Result<MeshPoint, MeshError>)]| {
        let mut sampler = Sampler::new(mesh);
        let mut with_slope = |(_, point): &(f64, Result<MeshPoint, MeshError>)| {
            let point = (*point)?;
            // without a slope a point says nothing of the shift
            Ok((point.delta_cd_mm, sampler.slope(&point).unwrap_or(0.0)))
        };
        points.iter().map(&mut with_slope).collect::<Vec<Result<_, MeshError>>>()
    };
    mesh.sample_blocks(strokes_mm.len() as u64, strokes, with_slopes, |block| {
        for point in block {
            let (delta_cd, slope) = point?;
            model.push(delta_cd);
            slopes.push(slope);
        }
        Ok(())
    })?;
    Ok((model, slopes))
}
