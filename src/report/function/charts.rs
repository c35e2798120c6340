//! Pictures of a yoke along the stroke: the play that the assembler sets, and the torque with its terms.

use super::super::chart::{Axis, Chart, Layer, Scale, Shape, Span};
use super::FunctionPart;
use crate::function::{ForcesAt, Target};
use crate::mesh::MeshPoint;

impl FunctionPart {
    /// Both pictures, if there is something to show.
    #[must_use]
    pub fn charts(&self, points: &[MeshPoint]) -> Vec<Chart> {
        std::iter::once(self.play_chart(None, points)).chain(self.torque_chart(None, points)).collect()
    }

    /// The play along the stroke between its limits, and its range for the settings that keep them.
    #[must_use]
    pub fn play_chart(&self, title: Option<&str>, points: &[MeshPoint]) -> Chart {
        let function = &self.function;
        let lowest = self.window.map(|bounds| bounds.window().lower_mm);
        // without a setting, the play that just touches its lower limit
        let at_limit = lowest.unwrap_or(0.0) + (function.highest.delta_cd_mm - function.at_mm());
        let (label, set) = match function.play_mm {
            Some(play) if self.yoke.play_mm.is_some() => ("play as set", play),
            Some(play) if self.is_known => ("play as recommended", play),
            Some(play) => ("play at the middle, with the errors placed so", play),
            None => ("play with its smallest at the limit", at_limit),
        };
        let play = |set: f64, point: &MeshPoint| set - (point.delta_cd_mm - function.at_mm());
        let band = function.setting.and_then(|setting| {
            let to = setting.to_mm?;
            let span = |point: &MeshPoint| Span {
                x: point.stroke_mm,
                low: play(setting.from_mm, point),
                high: play(to, point),
            };
            Some(points.iter().map(span).collect())
        });
        let ends = self.window.map(|bounds| lowest.into_iter().chain(bounds.upper).collect());
        let layers = vec![
            Layer::new("settings that keep the window", Shape::Band(band.unwrap_or_default())),
            Layer::new("limits", Shape::Limits(ends.unwrap_or_default())),
            Layer::new(label, Shape::Line(points.iter().map(|point| (point.stroke_mm, play(set, point))).collect())),
        ];
        let chart = Chart::along_the_stroke(title.unwrap_or("play of the yoke"), layers);
        Chart { y: Axis { label: "play of the yoke [mm]".to_owned(), scale: Scale::Airy }, ..chart }
    }

    /// The free torque of the pinion with its terms; `None` if it is not known.
    #[must_use]
    pub fn torque_chart(&self, title: Option<&str>, points: &[MeshPoint]) -> Option<Chart> {
        self.function.forces.as_ref()?;
        let line = |of: fn(&ForcesAt) -> f64| {
            let at = points.iter().zip(&self.function.along);
            Shape::Line(at.filter_map(|(point, at)| Some((point.stroke_mm, of(&at.forces?)))).collect())
        };
        let limits = self.checks.iter().filter(|check| check.on == Target::PinionTorque);
        let limits = limits.flat_map(|check| check.bounds.lower.into_iter().chain(check.bounds.upper)).collect();
        let mut layers = vec![
            Layer::new("limits", Shape::Limits(limits)),
            Layer::new("stroke rising", line(|at| at.rising_n_m)),
            Layer::new("stroke falling", line(|at| at.falling_n_m)),
            Layer::new("lifting, rising", line(|at| at.lifting_n_m)),
        ];
        if self.yoke.yoke_friction.is_some() {
            layers.push(Layer::new("yoke friction", line(|at| at.yoke_friction_n_m)));
        }
        if self.yoke.tooth_friction.is_some() {
            layers.push(Layer::new("tooth friction", line(|at| at.tooth_friction_n_m)));
        }
        let chart = Chart::along_the_stroke(title.unwrap_or("free torque of the pinion"), layers);
        Some(Chart { y: Axis { label: "torque at the pinion [N m]".to_owned(), scale: Scale::Airy }, ..chart })
    }
}
