//! What a yoke does, held against the simulation of elastic teeth: its travel, the work of the drive, forces where flanks carry
//! along lines, and the mean torque with friction, both ways.
#![allow(clippy::pedantic, clippy::disallowed_methods)]

use std::ops::ControlFlow;

use crate::common::paper::{self, spur};
use rackmesh::deviation::*;
use rackmesh::function::{Function, SetAt, Yoke};
use rackmesh::gear::Pair;
use rackmesh::mesh::{ContactKind, Kink, Mesh, MeshPoint, Sampler};
use rackmesh::multibody::{
    ContactModel, Masses, Parameters, RunEnd, Sample, Scene, StripGrid, Support, Yoke as SimulatedYoke,
};

const PRELOAD_N: f64 = 500.0;
const RATE: f64 = 100.0;

/// Two pairs with five racks each; every other pinion sits off its axis.
fn specs() -> Vec<(Pair, RackFlanks, PinionFlanks)> {
    use RackDeviationKind::{OverRoller, Pitch, Right, Shift, Thickness};
    let mut specs = Vec::new();
    for pair in [paper::pair(), spur()] {
        for (index, kind) in
            [Shift(0.006), Pitch(0.004), Thickness(0.008), OverRoller(-0.008), Right(0.004)].into_iter().enumerate()
        {
            let teeth = if index < 2 { "2.." } else { "1..=2" }.parse().unwrap();
            let rack = RackFlanks::new(&pair, &[RackDeviation { teeth, kind }]).unwrap();
            let off = [PinionDeviation::eccentricity(0.02, 2)];
            let pinion = PinionFlanks::new(&pair, if index % 2 == 0 { &off } else { &[] }).unwrap();
            specs.push((pair, rack, pinion));
        }
    }
    specs
}

fn scene(spec: &(Pair, RackFlanks, PinionFlanks), at_mm: f64, friction: f64) -> Scene {
    let yoke = SimulatedYoke {
        preload_n: PRELOAD_N - RATE * at_mm,
        rate_n_per_mm: RATE,
        bush_n_per_mm: 0.0,
        clearance_mm: 1.0,
        ..SimulatedYoke::default()
    };
    let parameters = Parameters {
        start_mm: 2.0,
        stroke_mm: 2.5 * spec.0.rack().pitch_mm,
        spacing_mm: 0.1,
        returns: true,
        friction,
        stiffness: 1e10,
        contact: ContactModel::Analytic(StripGrid { strips: 48 }),
        support: Support::Yoke(yoke),
        masses: Masses::default(),
        ..Parameters::default()
    };
    Scene::new(spec.0, spec.1.clone(), spec.2.clone(), parameters).unwrap()
}

fn carries_by_lines(point: &MeshPoint) -> bool {
    point.right.contact == ContactKind::Line && point.left.contact == ContactKind::Line
}

#[test]
fn the_simulation_finds_the_same_travel_work_forces_and_torque() {
    let [mut travel, mut work, mut force, mut torque] = [0.0_f64; 4];
    let mut compared = 0;
    for spec in specs() {
        let mesh = Mesh::new(spec.0, spec.1.clone(), spec.2.clone(), rackmesh::mesh::Support::Fixed).unwrap();
        let yoke = Yoke {
            preload_n: Some(PRELOAD_N),
            rate_n_per_mm: Some(RATE),
            set_at: SetAt::Stroke(0.0),
            tooth_friction: Some(0.08),
            ..Yoke::default()
        };
        let curve = mesh.curve(2.0, 2.0 + 2.5 * spec.0.rack().pitch_mm, 1e-6).unwrap();
        let function = Function::of(&mesh, &curve, &yoke, None).unwrap().unwrap();
        let spring = |mm: f64| PRELOAD_N * (mm - function.at_mm()) + 0.5 * RATE * (mm - function.at_mm()).powi(2);
        let run = scene(&spec, function.at_mm(), 0.0).quasi_static(&mut |_| ControlFlow::Continue(()));
        assert_eq!(run.end, RunEnd::Completed);
        let mut sampler = Sampler::new(&mesh);
        let mut at_lines: Vec<(&Sample, MeshPoint)> = Vec::new();
        for (index, sample) in run.samples.iter().enumerate() {
            let point = sampler.at(sample.stroke_mm).unwrap();
            // where a tooth just comes in or goes, elastic corners carry a little earlier and later
            let at_corner = |kink: &Kink| {
                let of = [kink.before.0, kink.before.1, kink.after.0, kink.after.1];
                of.iter().any(|carrier| carrier.contact != ContactKind::Line)
            };
            let is_near = |kink: &Kink| (kink.stroke_mm - sample.stroke_mm).abs() < 0.3 && at_corner(kink);
            if !carries_by_lines(&point) || curve.kinks.iter().any(is_near) {
                continue;
            }
            let rates = sampler.rates(&point).unwrap();
            let held = sample.yoke.unwrap();
            travel = travel.max((held.travel_mm + sample.indentation_mm - point.delta_cd_mm).abs());
            let forces = function.at(&point, Some(rates)).forces.unwrap();
            let (cos_n, cos_b) = (spec.0.normal_pressure_angle_rad().cos(), spec.0.rack().helix_angle_rad.cos());
            let drive = (sample.normal_force_left_n - sample.normal_force_right_n) * cos_n * cos_b;
            force = force.max((drive - forces.yoke_n * rates.delta_cd).abs());
            if index < run.there {
                at_lines.push((sample, point));
            }
            compared += 1;
        }
        let largest = curve.points.iter().map(|point| spring(point.delta_cd_mm).abs()).fold(1e-3, f64::max);
        let (first, last) = (at_lines.first().unwrap(), at_lines.last().unwrap());
        let driven = last.0.driven_n_mm - first.0.driven_n_mm;
        let lifted = spring(last.1.delta_cd_mm) - spring(first.1.delta_cd_mm);
        work = work.max((driven - lifted).abs() / largest);
        let rough = scene(&spec, function.at_mm(), 0.08).quasi_static(&mut |_| ControlFlow::Continue(()));
        let expected = function.forces.unwrap();
        for (found, expected) in [
            (rough.forces().unwrap().pinion_torque_n_m.mean, expected.rising.extent.mean),
            (-rough.forces_back().unwrap().pinion_torque_n_m.mean, expected.falling.extent.mean),
        ] {
            torque = torque.max((found / expected - 1.0).abs());
        }
        println!("travel {travel} mm, work {work}, force {force} N, torque {torque}");
    }
    assert!(compared > 1000, "{compared}");
    assert!(travel < 1e-9 && work < 0.01 && force < 0.5 && torque < 0.05, "{travel} {work} {force} {torque}");
}
