//! What `[pair]` comes to: the normal module from whichever module is given, and a shaft angle, which only checks the helix angles.

use std::sync::Arc;

use super::found::Found;
use super::value::{Value, Values};
use super::{Located, keys};
use crate::diagnostic::{Code, Diagnostic, Source};
use crate::formula::femtometres;
use crate::quantity::{Angle, Length};
use crate::trig;

/// How far two modules of the same teeth may lie apart: 1e-9 mm.
const MODULES_APART: Length = Length::from_fm(1_000);
/// How far a shaft angle may lie from that of the helix angles: 0.01°, as drawings round.
const SHAFT_ANGLES_APART: Angle = Angle::from_nas(36_000_000_000);

/// Adds the normal module that a transverse one comes to, and holds what the sections say twice against each other. What
/// is held against a value that cannot be read would be blamed on the wrong one, so that nothing is if there are
/// `diagnostics` already.
pub(super) fn complete(values: &mut Values, source: &Arc<Source>, diagnostics: &mut Found) {
    let helix_angle = |key| values.located(key).map_or(Angle::ZERO, |angle: Located<Angle>| angle.value);
    let (rack, pinion) = (helix_angle(keys::RACK_HELIX_ANGLE), helix_angle(keys::PINION_HELIX_ANGLE));
    let transverse = values.located(keys::PAIR_TRANSVERSE_MODULE);
    let converted = transverse.and_then(|module| of_transverse(&module, pinion));
    let given = values.located(keys::PAIR_NORMAL_MODULE);
    if diagnostics.is_empty() {
        let shaft_angle = values.located(keys::PAIR_SHAFT_ANGLE);
        let shaft_angle = shaft_angle.and_then(|given| check_shaft_angle(&given, [rack, pinion], source));
        let modules = given.as_ref().zip(converted.as_ref());
        let modules = modules.and_then(|(given, converted)| check_modules(given, converted, source));
        diagnostics.extend(shaft_angle.into_iter().chain(modules));
    }
    if let (None, Some(Located { value, span })) = (given, converted) {
        values.insert(keys::PAIR_NORMAL_MODULE.any.path, Located { value: Value::Length(value), span });
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

/// What a shaft angle says against the helix angles of both parts, right hand positive.
fn check_shaft_angle(given: &Located<Angle>, [rack, pinion]: [Angle; 2], source: &Arc<Source>) -> Option<Diagnostic> {
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
    use crate::spec::keys::PAIR_NORMAL_MODULE;

    fn spec(pair: &str, rack: &str, pinion: &str) -> Result<Spec, Diagnostics> {
        Spec::parse("test", &format!("[pair]\n{pair}\n[rack]\n{rack}\n[pinion]\n{pinion}\n"))
    }

    fn normal_module(pair: &str, pinion: &str) -> f64 {
        spec(pair, "", pinion).unwrap().get(PAIR_NORMAL_MODULE).unwrap().mm()
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
