//! Resolves `[pair]`: the normal module from whichever module is given, and a shaft angle, which only checks the helix angles.
//!
//! # Values that are given twice
//! Two values of one quantity agree if they do within the digits that are written: a value is rounded to its last digit, and
//! a whole number is exact. Of two modules, the one with fewer decimals is taken as exact, too, because the other one was
//! computed from it. Results always use the normal module as written.

use std::sync::Arc;

use super::found::Found;
use super::value::{Value, Values};
use super::{Located, keys};
use crate::diagnostic::{Code, Diagnostic, Source};
use crate::formula::femtometres;
use crate::quantity::{Angle, Length};
use crate::trig;

/// How far two modules of the same teeth may differ beyond their digits: 1e-9 mm.
const MODULES_APART: f64 = 1e-9;
/// How far a shaft angle may differ from the sum of the helix angles if their digits do not allow more: 0.01°, as drawings
/// round.
const SHAFT_ANGLES_APART: Angle = Angle::from_nas(36_000_000_000);

/// Adds the normal module that follows from a transverse one, and compares values that are given twice. With `diagnostics`
/// already present nothing is compared: a value that cannot be read would put the blame on the wrong one.
pub(super) fn complete(values: &mut Values, source: &Arc<Source>, diagnostics: &mut Found) {
    let helix_angle = |key| values.located(key).unwrap_or_default();
    let helix_angles = [keys::RACK_HELIX_ANGLE, keys::PINION_HELIX_ANGLE].map(helix_angle);
    let transverse = values.located(keys::PAIR_TRANSVERSE_MODULE);
    let given = values.located(keys::PAIR_NORMAL_MODULE);
    if diagnostics.is_empty() {
        let shaft_angle = values.located(keys::PAIR_SHAFT_ANGLE);
        let shaft_angle = shaft_angle.and_then(|given| check_shaft_angle(&given, &helix_angles, source));
        let modules = given.as_ref().zip(transverse.as_ref());
        let modules = modules.and_then(|(given, other)| check_modules(given, other, &helix_angles[1], source));
        diagnostics.extend(shaft_angle.into_iter().chain(modules));
    }
    let converted = transverse.and_then(|module| of_transverse(&module, helix_angles[1].value));
    if let (None, Some(Located { value, span })) = (given, converted) {
        values.insert(keys::PAIR_NORMAL_MODULE.any.path, Located { value: Value::Length(value), span });
    }
}

/// The normal module from a transverse one, m_n = m_t cos β_p.
fn of_transverse(transverse: &Located<Length>, helix_angle: Angle) -> Option<Located<Length>> {
    let module = Length::nearest(femtometres(transverse.value) * trig::sin_cos_of(helix_angle).1, "the normal module");
    Some(Located { value: module.ok()?, span: transverse.span.clone() })
}

/// A value as it is written in the spec, without the quotes of a text.
fn as_written<T>(value: &Located<T>, source: &Arc<Source>) -> String {
    let (source, span) = source.holding(value.span.clone());
    let text = source.text.get(span).unwrap_or_default();
    let inside = ['"', '\''].iter().find_map(|quote| text.strip_prefix(*quote)?.strip_suffix(*quote));
    inside.unwrap_or(text).replace("\\\"", "\"")
}

/// Compares a transverse module with the normal one.
fn check_modules(
    normal: &Located<Length>,
    transverse: &Located<Length>,
    helix_angle: &Located<Angle>,
    source: &Arc<Source>,
) -> Option<Diagnostic> {
    let rounding = |module| Length::rounding_of(&as_written(module, source)).mm();
    let (of_normal, of_transverse) = (rounding(normal), rounding(transverse));
    let turned = Angle::rounding_of(&as_written(helix_angle, source)).radians();
    let (sin, cos) = trig::sin_cos_of(helix_angle.value);
    // the module with the coarser rounding is the one from which the other follows, and counts as exact
    let is_finer = |own: f64, other: f64| own <= other || other == 0.0;
    let digits = if is_finer(of_normal, of_transverse) { of_normal } else { 0.0 }
        + if is_finer(of_transverse, of_normal) { of_transverse * cos } else { 0.0 }
        + transverse.value.mm() * sin.abs() * turned;
    let converted = transverse.value.mm() * cos;
    if (normal.value.mm() - converted).abs() <= digits + MODULES_APART * (1.0 + 1e-6) {
        return None;
    }
    let of_normal = normal.value.mm() / cos;
    let message = format!(
        "the normal module is given as {} and the transverse one of the pinion as {}, and at β_p = {} they do not agree within \
         the digits that are written: m_n = m_t cos β_p makes the normal one {converted:.6} mm, or the transverse one {of_normal:.6} mm",
        normal.value, transverse.value, helix_angle.value
    );
    let help = "leave out the one that was computed from the other, or check `pinion.helix_angle`";
    let diagnostic = Diagnostic::error(Code::BadGeometry, message).help(help);
    Some(diagnostic.at(source, transverse.span.clone(), ""))
}

/// Compares a shaft angle with the helix angles of both parts, right hand positive.
fn check_shaft_angle(
    given: &Located<Angle>,
    helix_angles: &[Located<Angle>; 2],
    source: &Arc<Source>,
) -> Option<Diagnostic> {
    let [rack, pinion] = [helix_angles[0].value, helix_angles[1].value];
    let rounding = |angle| Angle::rounding_of(&as_written(angle, source));
    let digits = rounding(given) + rounding(&helix_angles[0]) + rounding(&helix_angles[1]);
    let apart = digits.max(SHAFT_ANGLES_APART);
    let agrees = |shaft_angle: Angle| (shaft_angle.abs() - given.value).abs() <= apart;
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

    /// The one with fewer decimals is exact, and so is a whole number; the helix angle is rounded too.
    #[test]
    fn two_modules_agree_within_the_digits_that_are_written() {
        for (normal, transverse, helix_angle, agree) in [
            ("3", "3.18310", "-19.528333", true),
            ("3.0", "3.18310", "-19.528333", true),
            ("\"3 mm\"", "\"3.18310 mm\"", "'-19° 31′ 42″'", true),
            ("3", "3.1831", "19.53", true),
            ("3", "3.18310", "19.53", true),
            ("3", "3.18312", "19.528333", false),
            ("3", "3.19", "19.528333", false),
            ("3", "3.2", "20", true),
            ("3", "3.20", "20", false),
            ("2.8274", "3", "19.528333", true),
            ("2.8275", "3", "19.528333", false),
            ("2.5", "2.65", "19.528333", true),
            ("2.5", "2.70", "19.528333", false),
            ("3", "3", "19.528333", false),
            ("2", "2", "", true),
            ("2", "2.2", "", false),
        ] {
            let pair = format!("normal_module = {normal}\ntransverse_module = {transverse}");
            let pinion = if helix_angle.is_empty() { String::new() } else { format!("helix_angle = {helix_angle}") };
            let read = spec(&pair, "", &pinion);
            assert_eq!(read.is_ok(), agree, "{pair} {pinion}");
            let used = read.map(|spec| spec.get(PAIR_NORMAL_MODULE).unwrap());
            assert!(used.is_err() || used.unwrap() == normal.trim_matches('"').parse().unwrap(), "{pair}");
        }
    }

    #[test]
    fn a_shaft_angle_agrees_within_the_digits_that_are_written() {
        for (shaft_angle, rack, pinion, agrees) in [
            ("15.0", "-9.53", "24.57", true),
            ("15.0", "-9.53", "24.59", true),
            ("15.0", "-9.53", "24.60", false),
            ("'15° 2′'", "-9.53", "24.57", true),
            ("15.00", "-9.53", "24.57", false),
        ] {
            let read = spec(
                &format!("shaft_angle = {shaft_angle}"),
                &format!("helix_angle = {rack}"),
                &format!("helix_angle = {pinion}"),
            );
            assert_eq!(read.is_ok(), agrees, "{shaft_angle} {rack} {pinion}");
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

    /// A helix angle that cannot be read is the only one reported.
    #[test]
    fn what_cannot_be_read_is_not_held_against_the_rest() {
        let both = "shaft_angle = 15\nnormal_module = 2\ntransverse_module = 2.2";
        assert_eq!(refused(both, "helix_angle = -10", "helix_angle = 95"), [Code::OutOfDomain]);
    }
}
