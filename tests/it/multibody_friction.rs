//! Coulomb friction in the contact: its direction and size against a balance by hand, its fading at low speed, and
//! where the energy goes.
#![allow(clippy::pedantic, clippy::disallowed_methods)]

use std::ops::ControlFlow;

use crate::common::paper::{self, spur};
use rackmesh::deviation::{PinionFlanks, RackFlanks};
use rackmesh::multibody::*;

fn go_on(_: &Sample) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn scene(friction: f64, contact: ContactModel, change: impl FnOnce(&mut Parameters)) -> Scene {
    let pair = spur();
    let mut parameters = Parameters {
        friction,
        contact,
        friction_speed_mm_per_s: 1e-4,
        start_mm: -3.0,
        stroke_mm: 6.0,
        spacing_mm: 0.05,
        preload_n: 200.0,
        stiffness: 1e8,
        ..Parameters::default()
    };
    change(&mut parameters);
    Scene::new(pair, RackFlanks::nominal(&pair), PinionFlanks::nominal(&pair), parameters).unwrap()
}

const SPHERES: ContactModel =
    ContactModel::Spheres(SphereGrid { profile_nodes: 400, width_nodes: 16, radius_mm: 0.5, patch_cells: 1 });
const LINES: ContactModel = ContactModel::Analytic(StripGrid { strips: 16 });

/// Normal forces (right, left) of one tooth on each side that hold the preload and no torque, the flanks' X at the
/// reference plane given. On a right flank the normal is (cos α, sin α), up the flank (−sin α, cos α); a left one is
/// its mirror image. The contact point is the foot of the pitch point, and there the pinion slides as it turns about
/// that.
fn by_hand(mu: f64, right_x: f64, left_x: f64) -> (f64, f64) {
    let (sin, cos) = 20_f64.to_radians().sin_cos();
    let radius = 20.0;
    let side = |sign: f64, x: f64| {
        let (normal, up) = ([sign * cos, sin], [-sign * sin, cos]);
        // from the pitch point, which lies on the reference plane
        let behind = -normal[0] * x;
        let foot = [-behind * normal[0], -behind * normal[1]];
        // as the stroke rises rack and pinion's lowest point move to −X: against the rack the pinion turns by (x, z) →
        // (z, −x)
        let velocity = [foot[1], -foot[0]];
        let along = velocity[0] * up[0] + velocity[1] * up[1];
        let force = [normal[0] - mu * along.signum() * up[0], normal[1] - mu * along.signum() * up[1]];
        // about the pinion's axis, above the pitch point
        let torque = foot[0] * force[1] - (foot[1] - radius) * force[0];
        (force[1], torque)
    };
    let (right, left) = (side(1.0, right_x), side(-1.0, left_x));
    let det = right.0 * left.1 - left.0 * right.1;
    (200.0 * left.1 / det, -200.0 * right.1 / det)
}

#[test]
fn forces_tilt_as_a_balance_by_hand_says() {
    let pair = spur();
    let half = 0.5 * pair.rack().tooth_thickness_mm;
    for contact in [SPHERES, LINES] {
        for mu in [0.0, 0.05, 0.15] {
            let outcome = scene(mu, contact, |_| ()).quasi_static(&mut go_on);
            assert_eq!(outcome.end, RunEnd::Completed);
            let (mut compared, mut tilted) = (0, 0.0_f64);
            for sample in &outcome.samples {
                // the teeth whose flanks may carry: one of each side
                let (low, high) = sample.teeth.unwrap();
                let place = |tooth: i64| tooth as f64 * pair.rack().pitch_mm - sample.stroke_mm;
                if high - low != 1 {
                    continue;
                }
                // the pinion's tooth stands in the space between: the left tooth's right flank and the right one's left
                let (right_x, left_x) = (place(low) + half, place(high) - half);
                let (right, left) = by_hand(mu, right_x, left_x);
                // whether a flank's foot of the pitch point lies this far inside its path of contact, mm
                let in_path = |sign: f64, x: f64, inside: f64| {
                    let (sin, cos) = 20_f64.to_radians().sin_cos();
                    let foot = [cos * cos * x, sign * sin * cos * x];
                    foot[1] < 1.2 - inside && foot[0].hypot(foot[1] - 20.0) < 21.05 - inside
                };
                let alone = !in_path(1.0, place(high) + half, -0.15) && !in_path(-1.0, place(low) - half, -0.15);
                if !alone || !in_path(1.0, right_x, 0.05) || !in_path(-1.0, left_x, 0.05) {
                    continue;
                }
                // where the sliding turns round at the pitch point the sign is open
                if right_x.abs().min(left_x.abs()) < 0.2 {
                    continue;
                }
                let (r, l) = (sample.normal_force_right_n, sample.normal_force_left_n);
                println!("{mu} {:.2}: {r:.3} {right:.3}, {l:.3} {left:.3}", sample.stroke_mm);
                assert!(
                    (r / right - 1.0).abs() < 1e-4 && (l / left - 1.0).abs() < 1e-4,
                    "{mu} {sample:?} {right} {left}"
                );
                compared += 1;
                tilted = tilted.max((r - 200.0 / (2.0 * 20_f64.to_radians().sin())).abs() / r);
            }
            assert!(compared > 10, "{compared}");
            assert!(mu == 0.0 || tilted > 0.3 * mu, "{tilted}");
        }
    }
}

/// The mean torque that friction of the teeth asks for: r_w μ F / sin α_n times the mean of sliding over the rack's speed, which
/// is |sin Σ| / cos β_p lengthwise and x / r_w along the profile at the distance x from the pitch point on the path of contact.
#[test]
fn the_mean_torque_is_that_of_theory() {
    let pair = paper::pair();
    let (p, rack) = (pair.pinion(), pair.rack());
    let radius = 1.0 / pair.rotation_per_stroke_rad();
    let lengthwise = pair.shaft_angle_rad().sin().abs() / p.helix_angle_rad.cos();
    let tan = pair.normal_pressure_angle_rad().tan() / p.helix_angle_rad.cos();
    let (cos, sin) = (tan.atan().cos(), tan.atan().sin());
    // where the rack's tip and the pinion's end the path
    let depth = pair.nominal_center_distance_mm() - rack.addendum_mm;
    let first = p.start_roll_rad.max((depth / p.base_radius_mm - cos) / sin);
    let sliding = |share: f64| {
        let roll = first + share * (p.tip_roll_rad - first);
        lengthwise.hypot(p.base_radius_mm * (roll - tan) / radius)
    };
    let mean = (0..1000).map(|k| sliding((f64::from(k) + 0.5) / 1000.0)).sum::<f64>() / 1000.0;
    for friction in [0.05, 0.1] {
        let parameters = Parameters { friction, stroke_mm: 4.0 * rack.pitch_mm, ..Parameters::default() };
        let torque = |outcome: Outcome| outcome.forces().unwrap().pinion_torque_n_m.mean;
        let scene = paper::scene(None, parameters);
        let theory = 1e-3 * radius * friction * 500.0 / pair.normal_pressure_angle_rad().sin() * mean;
        for found in [torque(scene.quasi_static(&mut go_on)), torque(scene.dynamic(&mut go_on))] {
            println!("{friction}: {found} {theory}");
            assert!((found / theory - 1.0).abs() < 0.05, "{friction}: {found} {theory}");
        }
    }
}

/// There and back: friction turns round with the stroke, and the loop is what is lost; without friction there is none.
#[test]
fn there_and_back_is_a_loop_of_what_is_lost() {
    let run = |friction: f64, is_dynamic: bool| {
        let parameters = Parameters { friction, returns: true, stroke_mm: 13.0, ..Parameters::default() };
        let scene = paper::scene(None, parameters);
        let outcome = if is_dynamic { scene.dynamic(&mut go_on) } else { scene.quasi_static(&mut go_on) };
        assert_eq!((outcome.end, outcome.samples.len(), outcome.there), (RunEnd::Completed, 261, 131));
        let (first, last) = (outcome.samples[0], outcome.samples[260]);
        assert!((first.stroke_mm - last.stroke_mm).abs() < 1e-12 && last.time_s > 1.2, "{last:?}");
        outcome
    };
    for is_dynamic in [false, true] {
        let rough = run(0.1, is_dynamic);
        let mean = |forces: Option<RunForces>| forces.unwrap().pinion_torque_n_m.mean;
        let (there, back) = (mean(rough.forces()), mean(rough.forces_back()));
        assert!(there > 0.4 && (there + back).abs() < 0.01 * there, "{there} {back}");
        let energy = rough.energy.unwrap();
        assert!((energy.driven - energy.dissipated - energy.settling).abs() < 0.01 * energy.driven, "{energy:?}");
        let smooth = run(0.0, is_dynamic);
        assert!(smooth.energy.unwrap().driven.abs() < 1e-3 * energy.driven, "{:?}", smooth.energy);
        // the same place either way
        for (there, back) in smooth.samples.iter().zip(smooth.samples.iter().rev()) {
            assert!((there.delta_cd_mm - back.delta_cd_mm).abs() < 1e-5, "{there:?} {back:?}");
        }
    }
    let once = paper::scene(None, Parameters { stroke_mm: 13.0, ..Parameters::default() }).quasi_static(&mut go_on);
    assert_eq!(once.forces_back(), None);
}

fn position(scene: &Scene, stroke: f64) -> Coordinates {
    let rigid = scene.mesh().at(stroke).unwrap();
    Coordinates {
        pinion_angle: rigid.pinion_angle_rad,
        center_distance: rigid.center_distance_mm - 1e-3,
        roll: 0.0,
        stroke,
    }
}

#[test]
fn it_opposes_the_sliding_and_fades_with_it() {
    let turn = spur().rotation_per_stroke_rad();
    for contact in [SPHERES, LINES] {
        let made = |mu| scene(mu, contact, |p| (p.friction_speed_mm_per_s, p.damping) = (0.1, 0.0));
        let (rough, smooth) = (made(0.1), made(0.0));
        for stroke in [-2.3, -0.4, 0.9, 1.7] {
            let at = position(&rough, stroke);
            let forces = |speed: f64| {
                let rates = Coordinates { pinion_angle: speed * turn, stroke: speed, ..Coordinates::default() };
                (rough.forces(&at, &rates), smooth.forces(&at, &rates), rates)
            };
            // nothing at rest, to the last bit
            let (a, b, _) = forces(0.0);
            assert_eq!(a.generalized, b.generalized);
            assert_eq!(a.dissipation(), 0.0);
            let power = |speed: f64| {
                let (a, b, rates) = forces(speed);
                let rates = [rates.pinion_angle, rates.center_distance, rates.roll, rates.stroke];
                let done: f64 = (0..4).map(|k| (a.generalized[k] - b.generalized[k]) * rates[k]).sum();
                // what the friction forces do is what is lost, and never gained
                assert!(
                    (done + a.dissipation()).abs() < 1e-9 * a.dissipation().abs() && done < 0.0,
                    "{done} {}",
                    a.dissipation()
                );
                // and no more than μ f |v|, the sliding speed being at most ω times the path of contact's length
                assert!(-done <= 0.1 * (a.normal_right + a.normal_left) * speed.abs() * turn * 8.0);
                -done
            };
            assert!((power(20.0) / power(-20.0) - 1.0).abs() < 1e-9);
            // fast: force is constant, power grows with speed; slow: both fade, power with the square
            assert!((power(4000.0) / power(2000.0) - 2.0).abs() < 1e-2, "{}", power(4000.0) / power(2000.0));
            assert!((power(2e-4) / power(1e-4) - 4.0).abs() < 1e-3);
        }
    }
}

#[test]
fn the_drive_pays_for_what_is_lost() {
    for contact in [SPHERES, LINES] {
        let run = |mu: f64| {
            let scene = scene(mu, contact, |p| {
                (p.damping, p.energy_tolerance, p.stroke_mm, p.friction_speed_mm_per_s) = (0.0, 1.0, 12.6, 0.1);
            });
            let outcome = scene.dynamic(&mut go_on);
            assert_eq!(outcome.end, RunEnd::Completed);
            outcome.energy.unwrap()
        };
        let (one, two) = (run(0.05), run(0.1));
        for energy in [one, two] {
            assert!(energy.dissipated > 0.0 && energy.drift.abs() < 0.02 * energy.dissipated, "{energy:?}");
            assert!((energy.driven - energy.stored - energy.dissipated).abs() < 0.02 * energy.dissipated, "{energy:?}");
        }
        // to first order loss is in proportion to μ
        assert!((two.dissipated / one.dissipated - 2.0).abs() < 0.05, "{one:?} {two:?}");
    }
}
