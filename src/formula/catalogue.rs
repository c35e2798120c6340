//! The formulas by name, with the text that documents each: what `explain` prints.

use super::Model;
use crate::deviation::DeviationKind;

/// A formula's documentation.
#[derive(Debug, Clone, Copy)]
pub struct FormulaPage {
    /// Its name on the command line: `rack-pitch`.
    pub name: &'static str,
    /// Other names that it answers to.
    pub aliases: &'static [&'static str],
    /// The equation, symbols, domain and source, in Markdown.
    pub text: &'static str,
}

impl FormulaPage {
    pub(crate) const fn new(name: &'static str, aliases: &'static [&'static str], text: &'static str) -> Self {
        Self { name, aliases, text }
    }

    /// Whether the paper has the formula, by the source that the text names.
    #[must_use]
    pub fn is_of_paper(&self) -> bool {
        !self.text.contains("\nSource: not in the paper")
    }

    /// The equation of a model, as it stands in the text: `ΔCD = |Δp| cos β_r / (2 tan α_n)`.
    #[must_use]
    pub fn equation(&self, model: Model) -> &'static str {
        let mut block =
            self.text.lines().skip_while(|line| *line != "```text").skip(1).take_while(|line| *line != "```");
        let of_model = |line: &'static str| {
            let (first, rest) = line.split_once(' ')?;
            let is_named = [Model::Exact, Model::Paper].iter().any(|model| model.name() == first);
            if is_named { (first == model.name()).then(|| rest.trim_start()) } else { Some(line) }
        };
        block.find_map(of_model).unwrap_or_default()
    }
}

pub(crate) const IDEAL_PIN: FormulaPage = FormulaPage::new("ideal-pin", &["pin"], include_str!("ideal_pin.md"));
pub(crate) const OVER_PIN: FormulaPage = FormulaPage::new("over-pin", &[], include_str!("over_pin.md"));
pub(crate) const ROLLER_CHANGE: FormulaPage = FormulaPage::new("roller-change", &[], include_str!("roller_change.md"));

/// Every formula: first those of measures over pins, then one for each kind of error.
pub const CATALOGUE: &[FormulaPage; 9] = &[
    IDEAL_PIN,
    OVER_PIN,
    ROLLER_CHANGE,
    FormulaPage::new("rack-over-roller", &["over-roller"], include_str!("over_roller.md")),
    FormulaPage::new("rack-pitch", &["pitch"], include_str!("rack_pitch.md")),
    FormulaPage::new("rack-lead", &["lead"], include_str!("rack_lead.md")),
    FormulaPage::new("pinion-radial", &["radial"], include_str!("pinion_radial.md")),
    FormulaPage::new("pinion-pitch", &[], include_str!("pinion_pitch.md")),
    FormulaPage::new("pinion-lead", &[], include_str!("pinion_lead.md")),
];

/// The page of the law of a kind of error.
#[must_use]
pub const fn page_of(kind: DeviationKind) -> &'static FormulaPage {
    const OF_NO_ERROR: usize = 3;
    &CATALOGUE[OF_NO_ERROR + kind as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_error_has_its_page() {
        for kind in DeviationKind::ALL {
            assert_eq!(page_of(kind).name, kind.key().replace('_', "-"));
        }
    }
}
