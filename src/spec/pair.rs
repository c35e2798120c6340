//! Reads `[pair]`: the normal module from whichever module is given, and a shaft angle, which only checks the helix angles.

use std::ops::Range;
use std::sync::Arc;

use super::Located;
use super::gear::{PairSection, PinionSection, RackSection};
use super::reader::SectionReader;
use crate::diagnostic::{Code, Diagnostic, Source};
use crate::formula::femtometres;
use crate::quantity::{Angle, Length};
use crate::trig;

/// How far two modules of the same teeth may lie apart: 1e-9 mm.
const MODULES_APART: Length = Length::from_fm(1_000);
/// How far a shaft angle may lie from that of the helix angles: 0.01°, as drawings round.
const SHAFT_ANGLES_APART: Angle = Angle::from_nas(36_000_000_000);

/// The helix angles of both parts, right hand positive.
#[derive(Debug, Clone, Copy)]
pub(super) struct HelixAngles {
    rack: Angle,
    pinion: Angle,
}

impl HelixAngles {
    pub(super) fn of(rack: &RackSection, pinion: &PinionSection) -> Self {
        let or_zero = |angle: &Option<Located<Angle>>| angle.as_ref().map_or(Angle::ZERO, |angle| angle.value);
        Self { rack: or_zero(&rack.helix_angle), pinion: or_zero(&pinion.helix_angle) }
    }
}

/// `[pair]` as it is written.
#[derive(Default)]
pub(super) struct WrittenPair {
    normal_module: Option<Located<Length>>,
    transverse_module: Option<Located<Length>>,
    normal_pressure_angle: Option<Located<Angle>>,
    shaft_angle: Option<Located<Angle>>,
    both_flanks: Option<Range<usize>>,
}

/// Reads `[pair]`.
pub(super) fn read(reader: &mut SectionReader<'_>) -> WrittenPair {
    WrittenPair {
        normal_module: reader.length("normal_module"),
        normal_pressure_angle: reader.angle("normal_pressure_angle"),
        transverse_module: reader.length("transverse_module"),
        shaft_angle: reader.angle("shaft_angle"),
        both_flanks: reader.word("contact").map(|word| word.span),
    }
}

impl WrittenPair {
    /// What it comes to with the helix angles of both parts. What is held against a value that cannot be read would be
    /// blamed on the wrong one, so that nothing is if there are `diagnostics` already.
    pub(super) fn with(
        self,
        helix_angles: HelixAngles,
        source: &Arc<Source>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> PairSection {
        let transverse = self.transverse_module.as_ref();
        let converted = transverse.and_then(|module| of_transverse(module, helix_angles.pinion));
        if diagnostics.is_empty() {
            let shaft_angle =
                self.shaft_angle.as_ref().and_then(|given| check_shaft_angle(given, helix_angles, source));
            let modules = self.normal_module.as_ref().zip(converted.as_ref());
            let modules = modules.and_then(|(given, converted)| check_modules(given, converted, source));
            diagnostics.extend(shaft_angle.into_iter().chain(modules));
        }
        PairSection {
            normal_module: self.normal_module.or(converted),
            normal_pressure_angle: self.normal_pressure_angle,
            both_flanks: self.both_flanks,
        }
    }
}

/// The normal module that a transverse one comes to, m_n = m_t cos β_p.
fn of_transverse(transverse: &Located<Length>, helix_angle: Angle) -> Option<Located<Length>> {
    let module = Length::nearest(femtometres(transverse.value) * trig::sin_cos_of(helix_angle).1, "the normal module");
    Some(Located { value: module.ok()?, span: transverse.span.clone() })
}

fn check_modules(given: &Located<Length>, converted: &Located<Length>, source: &Arc<Source>) -> Option<Diagnostic> {
    if (given.value - converted.value).abs() <= MODULES_APART {
        return None;
    }
    let message = format!(
        "the normal module is given as {}, and the transverse one of the pinion makes it {}",
        given.value, converted.value
    );
    let diagnostic = Diagnostic::error(Code::BadGeometry, message)
        .help("m_n = m_t cos β_p: leave one of them out, or check `pinion.helix_angle`");
    Some(diagnostic.at(source, converted.span.clone(), ""))
}

fn check_shaft_angle(given: &Located<Angle>, helix_angles: HelixAngles, source: &Arc<Source>) -> Option<Diagnostic> {
    let HelixAngles { rack, pinion } = helix_angles;
    let agrees = |shaft_angle: Angle| (shaft_angle.abs() - given.value).abs() <= SHAFT_ANGLES_APART;
    if agrees(rack + pinion) {
        return None;
    }
    let message = format!(
        "the shaft angle is given as {}, and helix angles of {rack} (rack) and {pinion} (pinion) make it {}",
        given.value,
        (rack + pinion).abs()
    );
    let help = if agrees(rack - pinion) {
        "with the other sign of one helix angle they agree: check `rack.helix_angle` and `pinion.helix_angle`, right hand positive"
    } else {
        "Σ = |β_r + β_p|, right hand positive: check the helix angles and their signs"
    };
    Some(Diagnostic::error(Code::BadGeometry, message).help(help).at(source, given.span.clone(), ""))
}

#[cfg(test)]
mod tests {
    use crate::diagnostic::{Code, Diagnostics};
    use crate::spec::Spec;

    fn spec(pair: &str, rack: &str, pinion: &str) -> Result<Spec, Diagnostics> {
        Spec::parse("test", &format!("[pair]\n{pair}\n[rack]\n{rack}\n[pinion]\n{pinion}\n"))
    }

    fn normal_module(pair: &str, pinion: &str) -> f64 {
        spec(pair, "", pinion).unwrap().pair.normal_module.unwrap().value.mm()
    }

    fn refused(pair: &str, rack: &str, pinion: &str) -> Vec<Code> {
        spec(pair, rack, pinion).unwrap_err().0.iter().map(|problem| problem.code).collect()
    }

    #[test]
    fn a_transverse_module_is_that_of_the_pinion() {
        assert_eq!(normal_module("transverse_module = 2.5", "helix_angle = 60"), 1.25);
        assert_eq!(normal_module("transverse_module = 2.5", "helix_angle = -60"), 1.25);
        assert_eq!(normal_module("transverse_module = 2.5", ""), 2.5);
    }

    #[test]
    fn two_modules_agree_or_are_refused() {
        let both = |normal: &str| format!("normal_module = {normal}\ntransverse_module = 2.5");
        assert_eq!(normal_module(&both("1.250000001"), "helix_angle = 60"), 1.250_000_001);
        for normal in ["1.250000002", "1.249999998", "2.5"] {
            assert_eq!(refused(&both(normal), "", "helix_angle = 60"), [Code::BadGeometry], "{normal}");
        }
    }

    #[test]
    fn a_shaft_angle_is_the_sum_of_signed_helix_angles() {
        let with = |shaft_angle: &str, rack: &str| {
            let pair = format!("shaft_angle = {shaft_angle}");
            spec(&pair, &format!("helix_angle = {rack}"), "helix_angle = 25")
        };
        for (shaft_angle, rack, agrees) in [
            ("15", "-10", true),
            ("35", "10", true),
            ("15", "-40", true),
            ("35", "-10", false),
            ("15.01", "-10", true),
            ("15.0101", "-10", false),
            ("14.9899", "-10", false),
            ("0", "-25", true),
            ("-15", "-10", false),
        ] {
            assert_eq!(with(shaft_angle, rack).is_ok(), agrees, "{shaft_angle} {rack}");
        }
    }

    /// A helix angle that cannot be read is the only thing to blame.
    #[test]
    fn what_cannot_be_read_is_not_held_against_the_rest() {
        let both = "shaft_angle = 15\nnormal_module = 2\ntransverse_module = 2.2";
        assert_eq!(refused(both, "helix_angle = -10", "helix_angle = 95"), [Code::OutOfDomain]);
    }
}
