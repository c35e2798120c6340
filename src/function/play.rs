//! The play that a plug leaves, and the settings that keep it within a window. Arithmetic on extremes of ΔCD.

use crate::quantity::tidy;

/// Permitted play along the travel, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Smallest play, at least 0.
    pub lower_mm: f64,
    /// Largest play, if there is a limit.
    pub upper_mm: Option<f64>,
}

/// Plays J_0 at s_0 that keep the window on the whole travel, mm: `from_mm ≤ to_mm`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Smallest.
    pub from_mm: f64,
    /// Largest; `None` if nothing limits it.
    pub to_mm: Option<f64>,
}

impl Window {
    /// The settings that keep the window: J_0 ∈ [J_low + max ΔCD − ΔCD(s_0), J_high + min ΔCD − ΔCD(s_0)], mm, from the smallest
    /// and largest ΔCD and that at s_0. `None` if there are none: the variation of ΔCD is larger than the window. Values are
    /// rounded to 1 fm.
    #[must_use]
    pub fn settings(&self, smallest_mm: f64, largest_mm: f64, at_mm: f64) -> Option<Setting> {
        let from_mm = tidy(self.lower_mm + (largest_mm - at_mm));
        let to_mm = self.upper_mm.map(|upper| tidy(upper - (at_mm - smallest_mm)));
        let spare_mm = self.upper_mm.map(|upper| tidy((upper - self.lower_mm) - (largest_mm - smallest_mm)));
        // each end is rounded; rounding must not put the upper end below the lower one where a setting exists
        let setting = Setting { from_mm, to_mm: to_mm.map(|to| to.max(from_mm)) };
        spare_mm.is_none_or(|spare| spare >= 0.0).then_some(setting)
    }
}

impl Setting {
    /// The middle, mm, farthest from both ends; `None` without an upper end.
    #[must_use]
    pub fn middle_mm(&self) -> Option<f64> {
        self.to_mm.map(|to| 0.5 * (self.from_mm + to))
    }

    /// Whether a play lies within the settings, up to rounding.
    #[must_use]
    pub fn contains(&self, play_mm: f64) -> bool {
        let play_mm = tidy(play_mm);
        self.from_mm <= play_mm && self.to_mm.is_none_or(|to| play_mm <= to)
    }
}

/// The settings by a bound of ΔCD.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SafeSettings {
    /// Width U − L of the bound, mm: no variation of ΔCD is larger.
    pub width_mm: f64,
    /// Whether every curve within the bound has a setting: U − L ≤ J_high − J_low.
    pub is_there_one: bool,
    /// Plays at a given stroke that keep the window for every curve: J_0 ∈ [J_low + (U − L), J_high − (U − L)].
    pub at_stroke: Option<Setting>,
    /// Plays at the tightest stroke that keep the window for every curve: J_0 ∈ [J_low, J_high − (U − L)].
    pub at_tightest: Option<Setting>,
}

impl SafeSettings {
    /// The settings by a bound of this width, mm.
    #[must_use]
    pub fn of(window: &Window, width_mm: f64) -> Self {
        let at_tightest = window.settings(0.0, width_mm, width_mm);
        // ΔCD(s_0) may lie at either end of the bound, so the width counts at both ends of the window
        let twice = Window { lower_mm: window.lower_mm + width_mm, ..*window };
        let at_stroke = twice.settings(0.0, width_mm, width_mm);
        Self { width_mm, is_there_one: at_tightest.is_some(), at_stroke, at_tightest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const WINDOW: Window = Window { lower_mm: 0.01, upper_mm: Some(0.1) };

    #[test]
    fn a_window_that_is_met_exactly_has_one_setting() {
        let setting = WINDOW.settings(-0.03, 0.06, 0.0).expect("0.09 mm of 0.09");
        assert_eq!((setting.from_mm, setting.to_mm, setting.middle_mm()), (0.07, Some(0.07), Some(0.07)));
        assert_eq!(WINDOW.settings(-0.03, 0.060_000_000_001, 0.0), None);
        let open = Window { upper_mm: None, ..WINDOW }.settings(-1.0, 1.0, 0.5).expect("no upper end");
        assert_eq!((open.from_mm, open.to_mm, open.middle_mm()), (0.51, None, None));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        /// There are settings if and only if the variation fits the window; each keeps it, and a play beyond them does not.
        #[test]
        fn settings_are_those_that_keep_the_window(
            low in -0.1..0.1_f64, v in 0.0..0.2_f64, share in 0.0..1.0_f64, pick in 0.0..1.0_f64,
        ) {
            let (high, at) = (low + v, low + share * v);
            let keeps = |play: f64| {
                let plays = [play - (high - at), play + (at - low)];
                plays[0] >= 0.01 - 1e-9 && plays[1] <= 0.1 + 1e-9
            };
            match WINDOW.settings(low, high, at) {
                Some(Setting { from_mm, to_mm }) => {
                    let to_mm = to_mm.unwrap();
                    prop_assert!(v <= 0.09 + 1e-12 && keeps(from_mm + pick * (to_mm - from_mm)));
                    prop_assert!((to_mm - from_mm - (0.09 - v)).abs() < 2e-12);
                    prop_assert!(!keeps(from_mm - 1e-6) && !keeps(to_mm + 1e-6));
                    // setting at another stroke moves both ends by the difference of ΔCD
                    let tightest = WINDOW.settings(low, high, high).unwrap();
                    prop_assert!((from_mm - tightest.from_mm - (high - at)).abs() < 2e-12);
                    // a size on all teeth moves nothing
                    let moved = WINDOW.settings(low + 0.02, high + 0.02, at + 0.02).unwrap();
                    prop_assert!((moved.from_mm - from_mm).abs() < 2e-12);
                }
                None => prop_assert!(v > 0.09 - 1e-12 && !keeps(0.055 + (high - at) - 0.5 * v)),
            }
        }

        /// A setting that is safe by a bound suits every curve within it.
        #[test]
        fn what_is_safe_by_a_bound_is_safe_on_every_curve(
            width in 0.0..0.12_f64, ends in prop::array::uniform2(0.0..1.0_f64), share in 0.0..1.0_f64, pick in 0.0..1.0_f64,
        ) {
            let safe = SafeSettings::of(&WINDOW, width);
            let (low, high) = (width * ends[0].min(ends[1]), width * ends[0].max(ends[1]));
            let at = low + share * (high - low);
            let pick = |setting: Setting| setting.from_mm + pick * (setting.to_mm.unwrap() - setting.from_mm);
            prop_assert_eq!(safe.is_there_one, width <= 0.09);
            if safe.is_there_one {
                prop_assert!(WINDOW.settings(low, high, at).is_some());
                let tightest = WINDOW.settings(low, high, high).unwrap();
                prop_assert!(tightest.contains(pick(safe.at_tightest.unwrap())));
            }
            prop_assert_eq!(safe.at_stroke.is_some(), width <= 0.045);
            if let Some(setting) = safe.at_stroke {
                prop_assert!(WINDOW.settings(low, high, at).unwrap().contains(pick(setting)));
            }
        }
    }
}
