//! What a touch says of itself beside its demand: its place, what it lies on, what it goes with.

use super::*;
use crate::mesh::contact::PoseRates;

/// What touches where it is free to along the flank is named by its middle.
#[test]
fn the_middle_is_named_of_what_is_free() {
    let mut named = [0; 3];
    for narrow in [false, true] {
        contacts(narrow, |contact, pose| {
            let Some(touch) = contact.touch(pose, NO_FLOOR, None) else { return };
            // without a helix edges lie along generators; the search knows no better than to name an end
            let (line, edge) = (touch.kind == ContactKind::Line, touch.at_rack_edge || touch.spot.kind == touch.kind);
            if !line && (contact.kappa != 0.0 || !contact.slides || !edge) {
                return;
            }
            let (lo, hi) = contact.interval(pose, &contact.coordinates(pose, touch.spot.delta));
            if !line
                && !touch.at_rack_edge
                && lo.w.max(-hi.w).abs() == contact.half_face
                && touch.kind == ContactKind::Corner
            {
                return;
            }
            named[if line { 0 } else { 1 + usize::from(touch.at_rack_edge) }] += 1;
            let middle = 0.5 * (lo.w + hi.w);
            assert!((touch.spot.w - middle).abs() < 1e-9, "{middle} {touch:?}\n{contact:?}\n{pose:?}");
        });
    }
    println!("{named:?}");
    assert!(named.iter().all(|&count| count > 200), "{named:?}");
}

/// On the rack tooth's tip nothing changes with its flank.
#[test]
fn on_the_tip_the_flank_does_not_count() {
    let mut counts = [0; 2];
    tilted(|contact, pose, _| {
        let h = 1e-6;
        let at = |h: f64| contact.touch(&Pose { shift: pose.shift + h, ..*pose }, NO_FLOOR, None);
        let (Some(before), Some(touch), Some(after)) = (at(-h), at(0.0), at(h)) else { return };
        let moved = (after.demand - touch.demand).abs().max((touch.demand - before.demand).abs()) / h;
        let on_tip = touch.is_on_tip();
        counts[usize::from(on_tip)] += 1;
        assert!(if on_tip { moved < 1e-5 } else { moved > 1e-5 }, "{moved:e} {touch:?}\n{contact:?}\n{pose:?}");
    });
    assert!(counts[0] > 4000 && counts[1] > 20, "{counts:?}");
}

/// Which of two peaks alike is named does not hang on rounding.
#[test]
fn rounding_does_not_name_a_contact() {
    tilted(|contact, pose, _| {
        let Some(touch) = contact.touch(pose, NO_FLOOR, None) else { return };
        for step in 1..=3 {
            let pose = Pose { shift: pose.shift + 1e-13 * f64::from(step), ..*pose };
            let again = contact.touch(&pose, NO_FLOOR, None).expect("it touched before");
            assert_eq!(again.kind, touch.kind, "{again:?}\n{touch:?}\n{contact:?}\n{pose:?}");
        }
    });
}

/// A flank that is turned away by more than half a turn has nothing to look at.
#[test]
fn a_flank_turned_away_is_not_looked_at() {
    contacts(false, |contact, pose| {
        let reach = contact.kappa.abs() * contact.half_face;
        let ends = [PI - contact.start_roll + reach, -PI - contact.tip_roll - reach];
        for turned in ends.map(|end| (1.0 + 1e-9) * end) {
            let (touch, looked) = looks(|| contact.touch(&Pose { c: contact.nu + turned, ..*pose }, NO_FLOOR, None));
            assert!(touch.is_none() && looked == 0, "{touch:?} {looked}");
        }
    });
}

/// The derivatives by the rack's roll and by the centre distance that is assumed, against differences. What is compared is
/// counted.
pub(in crate::mesh::contact) fn compare_roll_rates(
    (mesh, side): (&Mesh, FlankSide),
    (angle, depth): (f64, f64),
    random: &mut Random,
    wanted: impl Fn(&Touch) -> bool,
    compared: &mut [u32; 2],
) {
    const H: f64 = 1e-6;
    let nominal = mesh.pair().nominal_center_distance_mm();
    let prepared = mesh.prepare(side, 0, &Roll::new(angle, depth));
    positions(random, mesh, &prepared.contact, 0.0, &mut |_, pose| {
        let place = pose.shift / prepared.per_shift;
        let posed = |angle: f64, distance: f64| {
            let roll = Roll::new(angle, depth);
            let prepared = mesh.prepare(side, 0, &roll);
            let shift = prepared.per_shift * place;
            let pose = Pose { shift, across: roll.sin * (depth + distance), ..*pose };
            (pose, prepared.contact.touch(&pose, NO_FLOOR, None).filter(&wanted))
        };
        let (here, touch) = posed(angle, nominal);
        let Some(touch) = touch else { return };
        let (sin, cos) = trig::sin_cos(angle);
        let moved = PoseRates { shift: prepared.rates.per_shift * place, across: [cos * (depth + nominal), sin] };
        let rates = prepared.contact.roll_rate(&here, &touch, &prepared.rates, &moved);
        let of_roll = (posed(angle - H, nominal).1, posed(angle + H, nominal).1);
        let of_distance = (posed(angle, nominal - H).1, posed(angle, nominal + H).1);
        for ((rate, neighbours), compared) in rates.into_iter().zip([of_roll, of_distance]).zip(compared.iter_mut()) {
            let (Some(before), Some(after)) = neighbours else { continue };
            let bend = (after.demand - 2.0 * touch.demand + before.demand).abs() / H;
            // not across a corner of the demand
            if before.kind == touch.kind && after.kind == touch.kind && bend < 1e-3 {
                *compared += 1;
                let off = rate - (after.demand - before.demand) / (2.0 * H);
                // as near as the generators that meet in a corner have come, where it is not a vertex
                let meets = touch.other.filter(|_| touch.kind == ContactKind::Corner && touch.vertex.is_none());
                let apart = meets.map_or(0.0, |(spot, _)| (spot.delta - touch.spot.delta).abs());
                assert!(off.abs() < 1e-6 + bend + 1e3 * apart, "{off:e} {touch:?}\n{:?}\n{here:?}", prepared.contact);
            }
        }
    });
}

/// Where a corner is a vertex of the flank, the rack's end face may be what moves as the rack rolls.
#[test]
fn the_rates_of_the_roll_hold_at_vertices() {
    let (mut random, mut made, mut compared) = (Random(4), 0, [0; 2]);
    while made < 300 {
        let Some(pair) = pair(&mut random, true) else { continue };
        made += 1;
        let mesh = Mesh::new(pair, RackFlanks::nominal(&pair), off_axis(PinionFlanks::nominal(&pair)), Support::Fixed);
        let mesh = mesh.expect("teeth in order");
        let side = if made % 2 == 0 { FlankSide::Right } else { FlankSide::Left };
        let roll = (random.next(-0.07, 0.07), random.next(-5.0, 20.0));
        compare_roll_rates((&mesh, side), roll, &mut random, |touch| touch.vertex.is_some(), &mut compared);
    }
    assert!(compared.iter().all(|&count| count > 200), "{compared:?}");
}
