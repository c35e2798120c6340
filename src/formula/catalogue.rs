//! The formulas by name, with the text that documents each: what `explain` prints.

use super::Model;

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
    /// Whether the paper has it, by the source that the text names.
    #[must_use]
    pub fn is_of_paper(&self) -> bool {
        !self.text.contains("\nSource: not in the paper")
    }

    /// Its equation by a model, as it stands in the text: `ΔCD = |Δp| cos β_r / (2 tan α_n)`.
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

pub(crate) const OVER_PIN: FormulaPage =
    FormulaPage { name: "over-pin", aliases: &[], text: include_str!("over_pin.md") };
pub(super) const RACK_OVER_ROLLER: FormulaPage =
    FormulaPage { name: "rack-over-roller", aliases: &["over-roller"], text: include_str!("over_roller.md") };
pub(super) const RACK_PITCH: FormulaPage =
    FormulaPage { name: "rack-pitch", aliases: &["pitch"], text: include_str!("rack_pitch.md") };
pub(super) const RACK_LEAD: FormulaPage =
    FormulaPage { name: "rack-lead", aliases: &["lead"], text: include_str!("rack_lead.md") };
pub(super) const PINION_RADIAL: FormulaPage =
    FormulaPage { name: "pinion-radial", aliases: &["radial"], text: include_str!("pinion_radial.md") };
pub(super) const PINION_PITCH: FormulaPage =
    FormulaPage { name: "pinion-pitch", aliases: &[], text: include_str!("pinion_pitch.md") };
pub(super) const PINION_LEAD: FormulaPage =
    FormulaPage { name: "pinion-lead", aliases: &[], text: include_str!("pinion_lead.md") };

/// Every formula: the paper's in its order, then the others.
pub const CATALOGUE: &[FormulaPage] = &[
    FormulaPage { name: "ideal-pin", aliases: &["pin"], text: include_str!("ideal_pin.md") },
    OVER_PIN,
    FormulaPage { name: "roller-change", aliases: &[], text: include_str!("roller_change.md") },
    RACK_OVER_ROLLER,
    RACK_PITCH,
    RACK_LEAD,
    PINION_RADIAL,
    PINION_PITCH,
    PINION_LEAD,
];
