//! Motion in time. Called through [`Scene::dynamic`]; knows the contact only by its forces.
//!
//! # The implicit scheme
//! TR-BDF2 as a singly diagonally implicit Runge-Kutta method of three stages, the first explicit (Bank et al.
//! 1985; Hosea and Shampine 1996): a trapezoidal stage to t + γh, γ = 2 − √2, and a backward difference to t + h. It is
//! of second order, L-stable and stiffly accurate, so vibrations that a step does not resolve die at once instead
//! of ringing, and its third-order companion gives the error of a step. With d = γ/2 a stage's velocity is
//! V = (Q − C)/(hd), C known, so each stage is a balance of forces for its position Q alone,
//!
//! ```text
//! F(Q, V) + [M v + h Σ a_j F_j − M V]/(h d) = 0,   tangent K + D/(h d) + M/(h d)²,
//! ```
//!
//! in which masses are never divided by: they may be 0. Steps are as long as the error of the positions allows. A stage
//! takes the rack's speed from its positions in the same way: beside the drive's own the pinion's would lag in the run-up,
//! and the contacts would seem to close at that difference and lose several times the energy that is driven in.
//!
//! # Contact events
//! A sphere touches and leaves once for every passage of its tooth: with the default grid about a hundred thousand
//! events in 50 mm of stroke, some two hundred in each of 500 steps. Stopping at each would cost that many steps and
//! gain nothing, because for a > 1 a force starts with the slope 0 and one sphere carries a two-hundredth of the load.
//! What matters is that no event is missed: every stage finds its contacts anew, Newton's method with a line search
//! closes and opens them within the stage, and an event that the step is too long for (a tooth's first contact, a rack
//! that snaps from one roll to another) shows in the error of the step, which is made again, shorter, until the event
//! lies between two steps as closely as the tolerance asks.
//!
//! # A rack that rocks
//! With a lead deviation the equilibrium of a rack that may roll lies in a kink: one flank flat on the pinion's. The
//! first deviating tooth snaps the rack into it, and since nothing but the contact damps the roll, it goes on rocking
//! from one end of the face width to the other, about 6 ms from impact to impact, for the rest of the stroke. Each of
//! these times takes some 25 steps, those at the impacts as short as 20 µs: thousands in 50 mm of stroke, where a rack
//! that cannot roll takes 500. They resolve what happens; a tolerance ten times as large saves two thirds of them and
//! moves the steady ΔCD by 0.3 µm.
//!
//! # The balance of energy
//! The drift is the energy of vibrations that a step does not resolve and therefore damps, in addition to the contact's own
//! damping. A step that adds more drift than a small share of the driven, stored and lost energy is repeated with a shorter
//! step, mostly at a tooth's first contact. Without damping and friction a vibration never dies by itself and no step is
//! repeated for it: the drift then is what the scheme damps.

use super::drive::{Drive, Driven};
use super::energy::{Flow, Ledger};
use super::load::Work;
use super::newton::{Balance, Limits, newton};
use super::outcome::{Energy, Outcome, Watch};
use super::state::{Coordinates, State};
use super::{Scene, SimulationError};
use crate::linear::solve;

/// γ = 2 − √2.
const GAMMA: f64 = 0.585_786_437_626_905;
/// d = γ/2, the diagonal.
const D: f64 = 0.5 * GAMMA;
/// w = √2/4: weights of the first two stages.
const W: f64 = 0.353_553_390_593_273_8;
/// Weights of the third-order companion.
const THIRD: [f64; 3] = [(1.0 - W) / 3.0, (3.0 * W + 1.0) / 3.0, D / 3.0];
/// Weights less those.
const ERROR: [f64; 3] = [W - THIRD[0], W - THIRD[1], D - THIRD[2]];

/// Unbalanced force over the closing force at which a stage is solved.
const BALANCE: f64 = 1e-5;
/// Iterations per stage; three are usual, and a step that needs more is better halved.
const ITERATIONS: u32 = 25;
/// A step is made at most this much longer than the last one.
const GROWTH: f64 = 4.0;
/// Share of the step that the error would allow exactly.
const SAFETY: f64 = 0.85;
/// Share of the circulating energy that a step may lose or make up, where that is more than the energy tolerance.
const CIRCULATING: f64 = 1e-6;
/// Share of the run below which no step is shortened for its energy.
const SHORT: f64 = 2e-7;
/// The smallest step, as a share of the run.
const SMALLEST: f64 = 1e-13;

/// One step's outcome.
struct Step {
    state: State,
    /// Largest error of a position, mm.
    error: f64,
    gained: Flow,
}

impl Scene {
    /// The motion over the stroke, from rest in equilibrium.
    #[must_use]
    pub fn dynamic(&self, watch: &mut Watch<'_>) -> Outcome {
        let mut begun = None;
        self.record(watch, |index, work| {
            let run = match &mut begun {
                Some(run) => run,
                none => none.insert(MotionRun::new(self, work)?),
            };
            let until = if index > 0 { run.drive.time(self.sample_stroke(index), self.is_back(index)) } else { 0.0 };
            while run.here.time < until {
                run.advance(until, work)?;
            }
            Ok((run.here, run.energy(&run.here, &run.ledger)))
        })
    }

    /// The forces in a position at a velocity, the rack where and as fast as it is driven.
    pub(super) fn state(&self, driven: Driven, q: [f64; 3], v: [f64; 3], work: &mut Work) -> State {
        let Driven { time, stroke, speed } = driven;
        let rates = Coordinates::from_free(v, speed);
        let contact = self.contact(&self.law, &Coordinates::from_free(q, stroke), &rates, work);
        State { time, q, v, stroke, speed, f: self.unbalanced(&q, &contact), contact }
    }

    /// One TR-BDF2 step; `None` if a stage is not solved.
    fn implicit(&self, drive: &Drive, from: &State, before: Option<&State>, end: f64, work: &mut Work) -> Option<Step> {
        let h = end - from.time;
        let acceleration = before
            .map_or([0.0; 3], |before| std::array::from_fn(|i| (from.v[i] - before.v[i]) / (from.time - before.time)));
        let guess = |t: f64| std::array::from_fn(|i| from.q[i] + t * (from.v[i] + 0.5 * t * acceleration[i]));
        let two = self.stage(
            drive,
            &Stage { time: from.time + GAMMA * h, h, from, known: &[(from, D)], guess: guess(GAMMA * h) },
            work,
        )?;
        // the same curvature to the end as to the middle
        let bend: [f64; 3] = std::array::from_fn(|i| (two.q[i] - from.q[i] - GAMMA * h * from.v[i]) / (GAMMA * GAMMA));
        let guess = std::array::from_fn(|i| from.q[i] + h * from.v[i] + bend[i]);
        let end = self.stage(drive, &Stage { time: end, h, from, known: &[(from, W), (&two, W)], guess }, work)?;
        let error = self.filtered(h, from, &two, &end);
        let gained = Flow::of(&[(from, W * h), (&two, W * h), (&end, D * h)]);
        Some(Step { state: end, error, gained })
    }

    /// The largest error of a position, mm, as the system itself would have damped it: with the errors e and e' of
    /// positions and velocities, the solution x of (I − h d J)(x, x') = (e, e'), J the Jacobian of the motion (Hosea
    /// and Shampine 1996, sect. 4). What a stiff contact corrects within the step does not count.
    fn filtered(&self, h: f64, from: &State, two: &State, end: &State) -> f64 {
        let n = self.coordinates() as usize;
        let scale = self.limits(0.0).scale;
        let per = 1.0 / (D * h);
        let (mut matrix, mut right) = (self.tangent(&end.q, &end.contact), [0.0; 3]);
        for i in 0..n {
            let position = |j: usize| h * (ERROR[0] * from.v[j] + ERROR[1] * two.v[j] + ERROR[2] * end.v[j]);
            let momentum = h * (ERROR[0] * from.f[i] + ERROR[1] * two.f[i] + ERROR[2] * end.f[i]);
            right[i] = (self.inertia[i] * position(i) * per + momentum) * per;
            matrix[i][i] += self.inertia[i] * per * per;
            for (j, entry) in matrix[i].iter_mut().enumerate().take(n) {
                let damping = per * end.contact.damping[i][j];
                *entry += damping;
                right[i] += damping * position(j);
            }
        }
        let scaled = std::array::from_fn(|i| std::array::from_fn(|j| matrix[i][j] / (scale[i] * scale[j])));
        let right: [f64; 3] = std::array::from_fn(|i| right[i] / scale[i]);
        match solve(scaled, right, n) {
            Some(x) => x[..n].iter().fold(0.0, |largest, value| value.abs().max(largest)),
            // a coordinate without mass follows the contact
            None => 0.0,
        }
    }

    fn stage(&self, drive: &Drive, stage: &Stage<'_>, work: &mut Work) -> Option<State> {
        let Stage { time, h, from, known, guess } = *stage;
        let (mut c, mut momentum) = (from.q, [0.0; 3]);
        for i in 0..3 {
            momentum[i] = self.inertia[i] * from.v[i];
            for (state, weight) in known {
                c[i] += h * weight * state.v[i];
                momentum[i] += h * weight * state.f[i];
            }
        }
        let per = 1.0 / (D * h);
        let mut driven = drive.at(time);
        let covered: f64 = known.iter().map(|(state, weight)| h * weight * state.speed).sum();
        driven.speed = (driven.stroke - from.stroke - covered) * per;
        let limits = Limits { iterations: ITERATIONS, ..self.limits(BALANCE * self.load_n()) };
        let velocity = |q: &[f64; 3]| -> [f64; 3] { std::array::from_fn(|i| (q[i] - c[i]) * per) };
        let solution = newton(guess, &limits, &mut |q: &[f64; 3]| {
            let v = velocity(q);
            let state = self.state(driven, *q, v, work);
            let (mut residual, mut tangent) = (state.f, self.tangent(q, &state.contact));
            for i in 0..3 {
                residual[i] += (momentum[i] - self.inertia[i] * v[i]) * per;
                tangent[i][i] += self.inertia[i] * per * per;
                for (entry, damping) in tangent[i].iter_mut().zip(state.contact.damping[i]) {
                    *entry += per * damping;
                }
            }
            Balance { residual, tangent, potential: None, with: state }
        });
        work.counters.iterations += u64::from(solution.iterations);
        solution.converged.then_some(solution.with)
    }
}

/// A stage of a step of `h` seconds: the states that lead to it, with their weights, and the start of its search.
struct Stage<'a> {
    time: f64,
    h: f64,
    from: &'a State,
    known: &'a [(&'a State, f64)],
    guess: [f64; 3],
}

/// A run under way.
struct MotionRun<'a> {
    scene: &'a Scene,
    drive: Drive,
    /// How long it takes, s.
    total: f64,
    start: State,
    here: State,
    before: Option<State>,
    ledger: Ledger,
    /// The next step, s.
    step: f64,
}

impl<'a> MotionRun<'a> {
    fn new(scene: &'a Scene, work: &mut Work) -> Result<Self, SimulationError> {
        let p = &scene.parameters;
        let drive = Drive::new(p);
        let law = scene.law.without_damping().without_friction();
        let (q, _) = scene.equilibrium((p.start_mm, p.speed_mm_per_s), None, &law, work)?;
        let start = scene.state(drive.at(0.0), q, [0.0; 3], work);
        Ok(Self {
            scene,
            total: drive.time(scene.sample_stroke(scene.last_sample()), p.returns),
            step: drive.time(scene.sample_stroke(1), false),
            drive,
            start,
            here: start,
            before: None,
            ledger: Ledger::default(),
        })
    }

    /// Makes a step towards a time, or reports that it has to be shorter.
    fn advance(&mut self, until: f64, work: &mut Work) -> Result<(), SimulationError> {
        let (scene, here) = (self.scene, &self.here);
        let p = &scene.parameters;
        let left = until - here.time;
        // the rest in equal steps, none longer than allowed
        let parts = (left / self.step * (1.0 - 1e-9)).ceil().max(1.0);
        let end = if parts <= 1.0 { until } else { here.time + left / parts };
        if work.counters.steps + work.counters.rejected >= p.max_steps {
            let steps = work.counters.steps;
            return Err(SimulationError::TooManySteps { time_s: here.time, stroke_mm: here.stroke, steps });
        }
        let h = end - here.time;
        let made = scene.implicit(&self.drive, here, self.before.as_ref(), end, work);
        let ratio = made.as_ref().map_or(f64::INFINITY, |made| made.error / p.tolerance_mm);
        let drift = made.as_ref().map_or(0.0, |made| self.lost(made));
        let floor = SHORT * self.total;
        let is_too_large = ratio > 1.0 || (drift > 1.0 && h > floor);
        let Some(made) = made.filter(|_| !is_too_large) else {
            work.counters.rejected += 1;
            return self.shorten(h, ratio, if h > floor { drift } else { 0.0 });
        };
        work.counters.steps += 1;
        scene.check(made.state.stroke, &made.state.q, &made.state.contact)?;
        self.ledger.add(&made.gained, here.time < self.drive.run_up_s());
        let by_error = h * (SAFETY / libm::cbrt(ratio)).clamp(0.2, GROWTH);
        self.step = by_error.min((h * (SAFETY / drift.sqrt()).clamp(0.2, GROWTH)).max(floor));
        self.before = Some(std::mem::replace(&mut self.here, made.state));
        Ok(())
    }

    /// Repeats a step whose error or drift is too large.
    fn shorten(&mut self, h: f64, ratio: f64, drift: f64) -> Result<(), SimulationError> {
        // the error is of third order in the step, that of the work between second and first
        let shrink = (SAFETY / libm::cbrt(ratio)).min(SAFETY / drift.sqrt());
        self.step = h * if ratio.is_finite() { shrink.clamp(0.1, 0.9) } else { 0.25 };
        if self.step < SMALLEST * self.total {
            let State { time, stroke, .. } = self.here;
            return Err(SimulationError::StepTooSmall { time_s: time, stroke_mm: stroke, step_s: self.step });
        }
        Ok(())
    }

    /// The drift that a step of a run with losses adds, over the drift that it may add.
    fn lost(&self, made: &Step) -> f64 {
        let p = &self.scene.parameters;
        if p.energy_tolerance >= 1.0 || p.damping == 0.0 && p.friction == 0.0 {
            return 0.0;
        }
        let mut with = self.ledger;
        with.add(&made.gained, false);
        let [before, after] = [self.energy(&self.here, &self.ledger), self.energy(&made.state, &with)];
        let exchanged = made.gained.exchanged * self.total / (made.state.time - self.here.time);
        let largest = after.driven.abs().max(after.stored.abs()).max(after.dissipated + after.settling);
        (after.drift - before.drift).abs()
            / (p.energy_tolerance * largest.max(CIRCULATING * exchanged)).max(f64::MIN_POSITIVE)
    }

    fn energy(&self, now: &State, ledger: &Ledger) -> Energy {
        let inertia = &self.scene.inertia;
        let stored = |state: &State| {
            let kinetic: f64 = (0..3).map(|i| 0.5 * inertia[i] * state.v[i] * state.v[i]).sum();
            kinetic + self.scene.potential(state)
        };
        ledger.balance(stored(now) - stored(&self.start), inertia[1] * (now.v[1] - self.start.v[1]))
    }
}
