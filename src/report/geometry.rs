//! A pair's geometry, for comparison with its drawings: a wrong sign of a helix angle shows in the hands and the shaft angle. Part
//! of the report of `mesh`.

use serde_json::{Value, json};

use super::number::tidy;
use super::{Block, Table};
use crate::gear::{Hand, Pair};
use crate::quantity::{Degrees, Length};

/// For people; the measure M over the pin is nominal, with its name, if it is known.
pub(super) fn table(pair: &Pair, over_pin: Option<(&'static str, Length)>) -> Block {
    let ratio = pair.contact_ratio();
    let rows = [
        ("hand of the rack", hand(pair.rack().helix_angle_rad)),
        ("hand of the pinion", hand(pair.pinion().helix_angle_rad)),
        ("shaft angle Σ", Degrees(pair.shaft_angle_rad().abs()).to_string()),
        ("contact ratio ε", format!("{:.3}", ratio.total)),
        ("offset of the contact c", format!("{:.3} pitches", ratio.offset)),
        ("centre distance a_0", millimetres(pair.nominal_center_distance_mm())),
    ];
    let over_pin = over_pin.map(|(name, measure)| (name, millimetres(measure.mm())));
    Table::of(rows.into_iter().chain(over_pin))
        .text("nominal pair", |(name, _)| *name)
        .number("value", |(_, value)| value.clone())
        .block()
}

/// For programs.
pub(super) fn json(pair: &Pair, over_pin: Option<(&'static str, Length)>) -> Value {
    let (rack, pinion, ratio) = (pair.rack(), pair.pinion(), pair.contact_ratio());
    json!({
        "rack_hand": Hand::of(rack.helix_angle_rad).name(),
        "pinion_hand": Hand::of(pinion.helix_angle_rad).name(),
        "shaft_angle_deg": tidy(pair.shaft_angle_rad().abs().to_degrees()),
        "contact_ratio": tidy(ratio.total),
        "contact_offset": tidy(ratio.offset),
        "nominal_center_distance_mm": pair.nominal_center_distance_mm(),
        "nominal_over_pin_mm": over_pin.map(|(_, measure)| measure),
    })
}

/// Hand and helix angle, as drawings give them: without a sign.
fn hand(helix_angle_rad: f64) -> String {
    match Hand::of(helix_angle_rad) {
        Hand::Spur => Hand::Spur.name().to_owned(),
        hand => format!("{} {}", hand.name(), Degrees(helix_angle_rad.abs())),
    }
}

fn millimetres(mm: f64) -> String {
    format!("{mm:.4} mm")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::law::RADIANS_PER_DEGREE;
    use crate::gear::example;

    #[test]
    fn hands_and_the_shaft_angle_between_them() {
        let degrees = |degrees: f64| degrees * RADIANS_PER_DEGREE;
        for (rack, pinion, hands, shaft_angle) in [
            (-12.5, 25.0, ["left 12.5°", "right 25°"], "12.5°"),
            (12.5, 25.0, ["right 12.5°", "right 25°"], "37.5°"),
            (0.0, -21.0, ["spur", "left 21°"], "21°"),
        ] {
            let pair = Pair::new(&example(20, degrees(rack), degrees(pinion))).unwrap();
            let Block::Table(table) = table(&pair, None) else { panic!("no table") };
            let values: Vec<_> = table.rows.into_iter().map(|row| row[1].clone()).collect();
            assert_eq!(values[..3], [hands[0], hands[1], shaft_angle]);
            assert_eq!(values.len(), 6);
        }
    }
}
