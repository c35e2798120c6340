//! The equilibrium at each stroke, without inertia and damping. Called through [`Scene::quasi_static`]; also finds the
//! position from which a dynamic run starts.

use super::energy::Ledger;
use super::law::Law;
use super::load::Work;
use super::newton::{Balance, Bend, Limits, Solution, System, newton};
use super::outcome::{Counters, Energy, Outcome, RunEnd, Sample, Watch, steady};
use super::state::{Coordinates, Forces, State};
use super::{Scene, SimulationError};

/// Unbalanced force over the closing force: it moves a contact by less than 1e-6 of its penetration.
const BALANCE: f64 = 1e-6;
/// Rounding errors of the centre distance in a potential, times the closing force.
const ROUNDINGS: f64 = 4.0;
/// Iterations after which a rack that rolls is solved roll by roll, and how many of those there are.
const QUICK: u32 = 12;
const ROLLS: u32 = 60;
/// First and longest step of a search for the roll, rad.
const FIRST_ROLL: f64 = 1e-5;
const WIDEST_ROLL: f64 = 1e-3;
/// Elements that a step may make touch: those with gaps below this share of the deepest penetration.
const NEAR: f64 = 0.05;
/// Iterations per stroke; a warm start needs one or two.
const ITERATIONS: u32 = 200;

/// The balance of a scene at a stroke.
struct AtRest<'a> {
    scene: &'a Scene,
    law: &'a Law,
    stroke: f64,
    rates: Coordinates,
    /// Whether the energy must fall, where there is one.
    descend: bool,
    work: &'a mut Work,
}

impl<'a> AtRest<'a> {
    fn new(scene: &'a Scene, (stroke, speed): (f64, f64), law: &'a Law, work: &'a mut Work) -> Self {
        let pinion_angle = speed * scene.mesh.pair().rotation_per_stroke_rad();
        let rates = Coordinates { pinion_angle, stroke: speed, ..Coordinates::default() };
        Self { scene, law, stroke, rates, descend: false, work }
    }

    /// The balance of the coordinates that `limits` names.
    fn solve(&mut self, start: [f64; 3], limits: &Limits) -> Solution<Forces> {
        let solution = newton(start, limits, self);
        self.work.counters.iterations += u64::from(solution.iterations);
        solution
    }

    fn settle(&mut self, start: [f64; 3], descend: bool) -> Solution<Forces> {
        let mut limits = self.scene.limits(BALANCE * self.scene.load_n());
        if self.scene.rolls {
            limits.iterations = QUICK;
        }
        self.descend = descend;
        self.solve(start, &limits)
    }

    /// The balance with the roll in an outer search: for each roll the balance of the other coordinates, then the roll at which the
    /// remaining torque vanishes while falling. Slower, but follows any valley.
    fn settle_rolling(&mut self, start: [f64; 3]) -> Solution<Forces> {
        let mut limits = self.scene.limits(BALANCE * self.scene.load_n());
        let half_face = limits.scale[2];
        limits.unknowns = 2;
        limits.iterations = 3 * QUICK;
        let mut x = start;
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut step = FIRST_ROLL;
        self.descend = true;
        let mut last = self.solve(x, &limits);
        for iteration in 0..ROLLS {
            x = last.x;
            let torque = last.with.generalized[2];
            let residual = torque.abs() / half_face;
            last.converged &= residual <= limits.force;
            last.residual = last.residual.max(residual);
            last.iterations = iteration;
            if last.converged {
                break;
            }
            if torque > 0.0 {
                low = x[2];
            } else {
                high = x[2];
            }
            // the tangent without the other coordinates, which follow
            let k = self.scene.tangent(&x, &last.with);
            let det = k[0][0] * k[1][1] - k[0][1] * k[1][0];
            let follow =
                [k[1][1] * k[0][2] - k[0][1] * k[1][2], k[0][0] * k[1][2] - k[1][0] * k[0][2]].map(|x| x / det);
            let tangent = k[2][2] - k[2][0] * follow[0] - k[2][1] * follow[1];
            let newton = x[2] + torque / tangent;
            let roll = if low.is_finite() && high.is_finite() {
                if newton > low && newton < high && iteration % 3 != 2 { newton } else { 0.5 * (low + high) }
            } else {
                step = (2.0 * step).min(WIDEST_ROLL);
                if tangent > 0.0 && (newton - x[2]).abs() < step { newton } else { x[2] + step.copysign(torque) }
            };
            if det > 0.0 {
                for i in 0..2 {
                    x[i] -= follow[i] * (roll - x[2]);
                }
            }
            if roll == x[2] || (high - low) <= f64::EPSILON * roll.abs() {
                last.converged = true;
                break;
            }
            x[2] = roll;
            last = self.solve(x, &limits);
        }
        last
    }
}

impl System for AtRest<'_> {
    type With = Forces;

    fn balance(&mut self, x: &[f64; 3]) -> Balance<Forces> {
        let scene = self.scene;
        let at = Coordinates::from_free(*x, self.stroke);
        let forces = scene.contact(self.law, &at, &self.rates, self.work);
        let with_energy = self.descend && scene.law.friction.is_none();
        let potential = with_energy.then(|| forces.energy + scene.closing_energy(x[1]));
        Balance { residual: scene.unbalanced(x, &forces), tangent: scene.tangent(x, &forces), potential, with: forces }
    }

    fn bend(&self, step: &[f64; 3]) -> Option<Bend> {
        Some(self.work.bend(self.law, step))
    }
}

impl Scene {
    /// The equilibrium at each sample's stroke. Friction acts as it does at the nominal sliding velocities.
    #[must_use]
    pub fn quasi_static(&self, watch: &mut Watch<'_>) -> Outcome {
        let law = self.law.without_damping();
        let p = &self.parameters;
        let turn = self.mesh.pair().rotation_per_stroke_rad();
        let (mut start, mut before, mut here): (Option<State>, Option<State>, Option<State>) = (None, None, None);
        let mut ledger = Ledger::default();
        self.record(watch, |index, work| {
            let stroke = self.sample_stroke(index);
            let guess = here.map(|here| {
                let known = |State { q, stroke, .. }: State| [q[0] - stroke * turn, q[1], q[2]];
                let (last, before) = (known(here), known(before.unwrap_or(here)));
                let guess: [f64; 3] = std::array::from_fn(|i| 2.0 * last[i] - before[i]);
                [guess[0] + stroke * turn, guess[1], guess[2]]
            });
            let (travel, v) = (stroke - p.start_mm, p.speed_mm_per_s);
            let (way, speed) = if self.is_back(index) { (2.0 * p.stroke_mm - travel, -v) } else { (travel, v) };
            let (q, contact) = self.equilibrium((stroke, speed), guess, &law, work)?;
            let time = way / v;
            let next = State { time, q, v: [0.0; 3], stroke, speed: 0.0, f: self.unbalanced(&q, &contact), contact };
            if let Some(here) = here {
                ledger.add(&self.flow_at_rest(&here, &next), false);
            }
            (before, here) = (here, Some(next));
            work.margin = NEAR * contact.penetration;
            let gained = self.potential(&next) - self.potential(start.get_or_insert(next));
            Ok((next, ledger.balance(gained, 0.0)))
        })
    }

    /// Positions along the stroke, each made by `step` with the balance of energy there, until the last one or until
    /// `watch` ends the run.
    pub(super) fn record(
        &self,
        watch: &mut Watch<'_>,
        mut step: impl FnMut(u32, &mut Work) -> Result<(State, Energy), SimulationError>,
    ) -> Outcome {
        let mut work = Work::default();
        let last = self.last_sample();
        let mut samples = Vec::with_capacity(last as usize + 1);
        let (mut energy, mut end) = (None, RunEnd::Completed);
        for index in 0..=last {
            let (state, balance) = match step(index, &mut work) {
                Ok(made) => made,
                Err(error) => {
                    end = RunEnd::Failed(error);
                    break;
                }
            };
            let sample = self.sample(&state, balance.driven, &work);
            samples.push(sample);
            energy = Some(balance);
            if watch(&sample).is_break() && index < last {
                end = RunEnd::Interrupted;
                break;
            }
        }
        self.outcome(samples, energy, work.counters, end)
    }

    /// Number of the last sample: at the end of the stroke, or back at its start.
    pub(super) fn last_sample(&self) -> u32 {
        if self.parameters.returns { 2 * self.intervals() } else { self.intervals() }
    }

    /// Whether a sample is on the way back.
    pub(super) fn is_back(&self, index: u32) -> bool {
        index > self.intervals()
    }

    /// Number of samples less 1 on the way there.
    pub(super) fn intervals(&self) -> u32 {
        let p = &self.parameters;
        (p.stroke_mm / p.spacing_mm * (1.0 - 1e-12)).ceil().clamp(1.0, 1e9) as u32
    }

    pub(super) fn sample_stroke(&self, index: u32) -> f64 {
        let p = &self.parameters;
        let index = index.min(2 * self.intervals() - index);
        let intervals = f64::from(self.intervals());
        // whole numbers of decimal spacings come out rounded once
        let travel = if (intervals * p.spacing_mm / p.stroke_mm - 1.0).abs() < 1e-9 {
            p.stroke_mm * f64::from(index) / intervals
        } else {
            (p.spacing_mm * f64::from(index)).min(p.stroke_mm)
        };
        p.start_mm + travel
    }

    pub(super) fn coordinates(&self) -> u32 {
        if self.rolls { 3 } else { 2 }
    }

    pub(super) fn limits(&self, force: f64) -> Limits {
        let pair = self.mesh.pair();
        Limits {
            unknowns: self.coordinates() as usize,
            scale: [pair.pinion().base_radius_mm, 1.0, 0.5 * pair.rack().face_width_mm],
            force,
            step: 0.01 * pair.normal_module_mm(),
            noise: ROUNDINGS * f64::EPSILON * pair.nominal_center_distance_mm() * self.load_n(),
            iterations: ITERATIONS,
        }
    }

    /// The equilibrium at a stroke, the rack moving at a speed, from a guess or from the rigid mesh.
    pub(super) fn equilibrium(
        &self,
        (stroke, speed): (f64, f64),
        guess: Option<[f64; 3]>,
        law: &Law,
        work: &mut Work,
    ) -> Result<([f64; 3], Forces), SimulationError> {
        let start = match guess {
            Some(guess) => guess,
            None => self.rigid(stroke)?,
        };
        let mut at_rest = AtRest::new(self, (stroke, speed), law, work);
        let mut found = at_rest.settle(start, self.rolls);
        if self.rolls && !found.converged {
            found = at_rest.settle_rolling(found.x);
        } else if !found.converged {
            found = at_rest.settle(self.rigid(stroke)?, false);
            if !found.converged {
                // elements that fade out at a face's end bend the balance: the energy leads through
                found = at_rest.settle(found.x, true);
            }
        }
        self.check(stroke, &found.x, &found.with)?;
        if !found.converged {
            return Err(SimulationError::NoEquilibrium {
                stroke_mm: stroke,
                iterations: found.iterations,
                residual_n: found.residual,
            });
        }
        Ok((found.x, found.with))
    }

    fn rigid(&self, stroke: f64) -> Result<[f64; 3], SimulationError> {
        let rigid = self.mesh.at(stroke)?;
        Ok([rigid.pinion_angle_rad, rigid.center_distance_mm, rigid.roll_rad])
    }

    /// Whether a position is still valid.
    pub(super) fn check(&self, stroke: f64, x: &[f64; 3], forces: &Forces) -> Result<(), SimulationError> {
        if forces.penetration > self.deepest() {
            let (penetration_mm, limit_mm) = (forces.penetration, self.deepest());
            return Err(SimulationError::TooDeep { stroke_mm: stroke, penetration_mm, limit_mm });
        }
        let nominal = stroke * self.mesh.pair().rotation_per_stroke_rad();
        let off = (x[0] - nominal) / self.shared.angular_pitch;
        let teeth = &self.deviating;
        // a pitch error that adds up moves the pinion on permanently
        if !teeth.contains(&true) && off.abs() > 0.75 || !off.is_finite() {
            return Err(SimulationError::Jumped { stroke_mm: stroke });
        }
        Ok(())
    }

    fn sample(&self, at: &State, driven_n_mm: f64, work: &Work) -> Sample {
        let State { time, q: [pinion_angle_rad, center_distance_mm, roll_rad], stroke, contact, .. } = *at;
        // a drive without force pushes neither way
        let rack_force_n = 0.0 - contact.generalized[3];
        Sample {
            time_s: time,
            stroke_mm: stroke,
            delta_cd_mm: center_distance_mm - self.mesh.pair().nominal_center_distance_mm(),
            center_distance_mm,
            pinion_angle_rad,
            roll_rad,
            normal_force_right_n: contact.normal_right,
            normal_force_left_n: contact.normal_left,
            rack_force_n,
            pinion_torque_n_m: 1e-3 * rack_force_n / self.mesh.pair().rotation_per_stroke_rad(),
            driven_n_mm,
            yoke: self.yoke(center_distance_mm),
            contacts: contact.contacts,
            penetration_mm: contact.penetration,
            indentation_mm: work.touching.indentation(),
            teeth: contact.teeth,
            carrying: contact.carrying,
        }
    }

    fn outcome(&self, samples: Vec<Sample>, energy: Option<Energy>, mut counters: Counters, end: RunEnd) -> Outcome {
        let run_up = if counters.steps > 0 { 2.0 * self.parameters.ramp_mm } else { 0.0 };
        let p = &self.parameters;
        // it comes to rest as it starts
        let speed_to_mm = if p.returns { p.start_mm + p.stroke_mm - run_up } else { f64::MAX };
        let at_speed_mm = p.start_mm + run_up..=speed_to_mm;
        let there = samples.len().min(self.intervals() as usize + 1);
        // how far from the middle any tooth touches
        let pitch = self.shared.pitch;
        let place = |tooth: i64, sample: &Sample| (tooth as f64 * pitch - sample.stroke_mm).abs();
        let reach = samples
            .iter()
            .filter_map(|sample| sample.teeth.map(|(low, high)| place(low, sample).max(place(high, sample))))
            .fold(0.0, f64::max);
        let all = |deviating: bool| {
            let at_speed_mm = &at_speed_mm;
            move |sample: &Sample| {
                let (low, high) = (
                    ((sample.stroke_mm - reach) / pitch).ceil() as i64,
                    ((sample.stroke_mm + reach) / pitch).floor() as i64,
                );
                at_speed_mm.contains(&sample.stroke_mm)
                    && (low..=high).all(|tooth| self.is_deviating(tooth) == deviating)
            }
        };
        let nominal = steady(&samples[..there], pitch, all(false));
        let deviating = steady(&samples[..there], pitch, all(true));
        counters.coordinates = self.coordinates();
        Outcome { samples, nominal, deviating, energy, counters, end, there, at_speed_mm }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deviation::{PinionFlanks, RackFlanks};
    use crate::multibody::{Parameters, Support};
    use crate::reproduction;

    /// A step that includes the curvature of the contacts ends nearer to the balance than one along the tangent, also where spheres
    /// come into contact on the way.
    #[test]
    fn a_step_minds_how_contacts_bend() {
        let pair = reproduction::pair().unwrap();
        for support in [Support::Fixed, Support::FreeRoll { axis_depth_mm: 8.0 }] {
            let (rack, pinion) = (RackFlanks::new(&pair, &[]).unwrap(), PinionFlanks::nominal(&pair));
            let scene = Scene::new(pair, rack, pinion, Parameters { support, ..Parameters::default() }).unwrap();
            let law = scene.law.without_damping();
            let (mut work, stroke) = (Work::default(), 20.0);
            let (at, forces) = scene.equilibrium((stroke, 20.0), None, &law, &mut work).unwrap();
            work.margin = NEAR * forces.penetration;
            let mut limits = scene.limits(1e-12);
            limits.iterations = 1;
            for share in [-0.03, 0.03] {
                let mut off = at;
                off[1] += share * forces.penetration;
                let rates = Coordinates::default();
                let mut system = AtRest { scene: &scene, law: &law, stroke, rates, descend: false, work: &mut work };
                let along_the_tangent = newton(off, &limits, &mut |x: &[f64; 3]| system.balance(x)).residual;
                let bent = newton(off, &limits, &mut system).residual;
                assert!(bent < 0.01 * along_the_tangent, "{support:?} {share}: {bent} {along_the_tangent}");
                assert!(bent < 1e-6 * scene.load_n());
            }
        }
    }
}
