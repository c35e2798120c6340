//! Where the energy of a run goes, step by step. Both kinds of run call it; it knows forces and positions, not how they were
//! found.
//!
//! The contact has no mass, so the energy from the drive is stored in it, lost in it or passed on to the bodies. The stored
//! energy is the elastic energy itself and not an integral of the forces: some two hundred spheres touch and leave in a step,
//! and the drive's force, the small difference of two flanks' large forces, at three instants of a step gives an error as
//! large as the driven energy. The lost energy and the energy passed on are the scheme's own sums over the step.
//!
//! The bodies are counted separately: their gain and that of the closing force, less the work that was passed on to them, is the
//! drift of the steps.

use super::Scene;
use super::outcome::Energy;
use super::state::{Forces, State};

/// Energy that flowed during a step, N mm.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Flow {
    pub(super) driven: f64,
    /// To damping and to friction.
    pub(super) damped: f64,
    pub(super) rubbed: f64,
    pub(super) exchanged: f64,
    /// N s.
    pub(super) impulse: f64,
}

impl Flow {
    /// The energy that flows from the first of these states to the last, each with its share of the time, s.
    pub(super) fn of(states: &[(&State, f64)]) -> Self {
        let [(first, _), .., (last, _)] = states else { return Self::default() };
        let mut flow = Self { driven: last.contact.energy - first.contact.energy, ..Self::default() };
        for (state, time) in states {
            let contact = &state.contact;
            let passed_on: f64 = contact.generalized.iter().zip(&state.v).map(|(force, speed)| force * speed).sum();
            flow.driven += time * (passed_on + contact.dissipation());
            flow.damped += time * contact.damped;
            flow.rubbed += time * contact.rubbed;
            flow.exchanged += time * contact.along * state.speed.abs();
            flow.impulse += time * state.f[1];
        }
        flow
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.driven += other.driven;
        self.damped += other.damped;
        self.rubbed += other.rubbed;
        self.exchanged += other.exchanged;
        self.impulse += other.impulse;
    }
}

/// The energy that has flowed since the start of a run.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Ledger {
    pub(super) sum: Flow,
    /// Energy lost to damping until the rack has its speed.
    settling: f64,
}

impl Ledger {
    /// Adds a step; `starting` while the rack has not reached its speed.
    pub(super) fn add(&mut self, step: &Flow, starting: bool) {
        self.sum.add(step);
        if starting {
            self.settling += step.damped;
        }
    }

    /// The balance of a run that has gained this much energy, N mm, and momentum, N s.
    pub(super) fn balance(&self, stored: f64, momentum: f64) -> Energy {
        let Flow { driven, damped, rubbed, exchanged, impulse } = self.sum;
        let dissipated = damped - self.settling + rubbed;
        let drift = driven - stored - dissipated - self.settling;
        Energy { stored, driven, dissipated, settling: self.settling, exchanged, drift, impulse, momentum }
    }
}

impl Scene {
    /// Energy of the contact and of the closing force.
    pub(super) fn potential(&self, at: &State) -> f64 {
        at.contact.energy + self.closing_energy(at.q[1])
    }

    /// The energy that flows from one equilibrium to the next: the contact passes on what the closing force takes.
    pub(super) fn flow_at_rest(&self, from: &State, to: &State) -> Flow {
        let mean = |of: fn(&Forces) -> f64| 0.5 * (of(&from.contact) + of(&to.contact));
        let time = to.time - from.time;
        let closing = |at: &State| self.closing(at.q[1]).0;
        let passed_on = 0.5 * (closing(from) + closing(to)) * (to.q[1] - from.q[1]);
        Flow {
            driven: to.contact.energy - from.contact.energy + passed_on + time * mean(Forces::dissipation),
            damped: time * mean(|contact| contact.damped),
            rubbed: time * mean(|contact| contact.rubbed),
            exchanged: mean(|contact| contact.along) * (to.stroke - from.stroke).abs(),
            impulse: 0.5 * time * (from.f[1] + to.f[1]),
        }
    }
}
