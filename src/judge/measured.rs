//! A rack measured space by space, or a pinion tooth by tooth, with ΔCD of each deviation by its formula. The spec layer
//! builds it from a table, the reports write it.

use crate::deviation::{DeviationKind, DeviationValue, Part};
use crate::formula::Model;
use crate::quantity::Length;

/// A column of deviations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feature {
    /// Measure over the pin less its nominal value.
    OverPin,
    /// Distance from the previous space less the pitch.
    Pitch,
    /// Helix angle deviation of a space.
    Lead,
    /// Radial deviation of the space after a tooth.
    Radial,
    /// Difference of the positions of a pin in the space after a tooth and in the space before it.
    PinPitch,
    /// Single pitch deviation of the left flank.
    LeftPitch,
    /// Single pitch deviation of the right flank.
    RightPitch,
    /// Helix slope deviation f_Hβ of a tooth over the face width.
    HelixSlope,
}

impl Feature {
    /// The feature in words, its key in results, and the error whose formula takes it.
    const fn facts(self) -> (&'static str, &'static str, DeviationKind) {
        match self {
            Self::OverPin => ("over-pin", "over_pin", DeviationKind::RackOverRoller),
            Self::Pitch => ("pitch", "pitch", DeviationKind::RackPitch),
            Self::Lead => ("lead", "lead", DeviationKind::RackLead),
            Self::Radial => ("radial", "radial", DeviationKind::PinionRadial),
            Self::PinPitch => ("pitch", "pitch", DeviationKind::PinionPitch),
            Self::LeftPitch => ("left pitch", "left_pitch", DeviationKind::PinionPitch),
            Self::RightPitch => ("right pitch", "right_pitch", DeviationKind::PinionPitch),
            Self::HelixSlope => ("helix slope", "helix_slope", DeviationKind::PinionLead),
        }
    }

    /// The feature in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.facts().0
    }

    /// The feature's key in results.
    #[must_use]
    pub const fn key(self) -> &'static str {
        self.facts().1
    }

    /// The error whose formula takes the feature.
    #[must_use]
    pub const fn error(self) -> DeviationKind {
        self.facts().2
    }
}

/// One deviation and its ΔCD by the formula.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// The deviation.
    pub deviation: DeviationValue,
    /// Its ΔCD.
    pub delta_cd: Length,
}

/// One space or tooth.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredRow {
    /// Its number.
    pub number: i64,
    /// One per feature of the part; `None` where it was not measured.
    pub effects: Vec<Option<Effect>>,
}

/// A measured rack or pinion, by the formulas.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredPart {
    /// Which part it is.
    pub part: Part,
    /// The model of the formulas.
    pub model: Model,
    /// What was measured.
    pub features: Vec<Feature>,
    /// One per space or tooth.
    pub rows: Vec<MeasuredRow>,
}

impl MeasuredPart {
    /// The largest effect of a feature, by magnitude, and the number of its space or tooth.
    #[must_use]
    pub fn largest(&self, feature: usize) -> Option<(i64, &Effect)> {
        let effects = self.rows.iter().filter_map(|row| Some((row.number, row.effects.get(feature)?.as_ref()?)));
        effects.reduce(|a, b| if b.1.delta_cd.abs() > a.1.delta_cd.abs() { b } else { a })
    }

    /// The lowest and highest ΔCD of a feature; an error that pushes acts between 0 and its largest value.
    #[must_use]
    pub fn range_of(&self, feature: usize) -> Option<(Length, Length)> {
        let effects =
            || self.rows.iter().filter_map(|row| row.effects.get(feature)?.as_ref()).map(|effect| effect.delta_cd);
        let (low, high) = (effects().min()?, effects().max()?);
        Some(if self.features[feature].error().always_acts() { (low, high) } else { (Length::ZERO, high) })
    }

    /// The range of all features: the sum of their ranges. Left and right flanks of a pinion deviate by themselves, so both
    /// count.
    #[must_use]
    pub fn range(&self) -> (Length, Length) {
        let ranges = (0..self.features.len()).filter_map(|feature| self.range_of(feature));
        ranges.fold((Length::ZERO, Length::ZERO), |(low, high), (from, to)| (low + from, high + to))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(text: &str) -> Length {
        text.parse().unwrap()
    }

    fn effect(delta_cd: &str) -> Effect {
        Effect { deviation: DeviationValue::Length(Length::ZERO), delta_cd: length(delta_cd) }
    }

    #[test]
    fn keys_are_names_in_one_word() {
        use Feature::{HelixSlope, Lead, LeftPitch, OverPin, PinPitch, Pitch, Radial, RightPitch};
        for feature in [OverPin, Pitch, Lead, Radial, PinPitch, LeftPitch, RightPitch, HelixSlope] {
            assert_eq!(feature.key(), feature.name().replace([' ', '-'], "_"));
        }
    }

    #[test]
    fn the_largest_of_equals_is_the_first_and_pitches_of_both_flanks_add_up() {
        let rows = [(3, "0.01", "-0.02", "0.03"), (4, "-0.02", "0.01", "0.05"), (5, "0.02", "-0.01", "0.01")];
        let part = MeasuredPart {
            part: Part::Pinion,
            model: Model::Exact,
            features: vec![Feature::Radial, Feature::LeftPitch, Feature::RightPitch],
            rows: rows
                .map(|(number, radial, left, right)| MeasuredRow {
                    number,
                    effects: [radial, left, right].map(|delta_cd| Some(effect(delta_cd))).to_vec(),
                })
                .to_vec(),
        };
        let (number, largest) = part.largest(0).unwrap();
        assert_eq!((number, &largest.delta_cd), (4, &length("-0.02")));
        assert_eq!(part.range_of(0), Some((length("-0.02"), length("0.02"))));
        assert_eq!(part.range_of(1), Some((Length::ZERO, length("0.01"))));
        assert_eq!(part.range(), (length("-0.02"), length("0.08")));
    }
}
