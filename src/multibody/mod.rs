//! The multibody model of the paper (sect. 3): an elastic, damped, rubbing contact between pinion and rack, solved
//! as an equilibrium at each stroke or as a motion in time.
//!
//! Called by the command line, the reports and anyone who has a [`Pair`](crate::gear::Pair) and its deviations. A
//! [`Scene`] holds both with its [`Parameters`], checked; [`Scene::quasi_static`] and [`Scene::dynamic`] run it and give
//! an [`Outcome`]. It must not know TOML, print, or read files.
//!
//! # Bodies and coordinates
//! Ground; the rack, on a cylindrical joint along X whose translation (the stroke s) is imposed; the pinion, on a
//! revolute joint to a massless slider, which a prismatic joint lets move along Z. The coordinates are therefore the
//! pinion's rotation ψ (positive as the stroke rises), the slider's height a (the centre distance) and the rack's roll φ
//! about X. φ exists only where the support leaves it free and a helix or a lead deviation loads it
//! ([`Scene::rolls`]). With [`Support::Yoke`] the pinion's axis is fixed and a − a_0 is how far the rack moves back.
//!
//! # Contact
//! Every contact element has a gap g(ψ, a, φ, s), a penetration δ = −g, and the force (the paper, sect. 3.1.2, with the rate in the damping term)
//!
//! ```text
//! f = max(0, k δ^a + c sgn(δ') |δ'|^b δ^e)   for δ > 0, else 0
//! ```
//!
//! which pushes with f ∂g/∂q on every coordinate q. Elements are spheres ([`ContactModel::Spheres`]) or strips of the
//! exact surfaces ([`ContactModel::Analytic`]); both give g with its first and second derivatives, so that all
//! tangents are analytic.
//!
//! Units: mm, N, s and rad throughout; masses are given in kg.

mod bound;
mod closest;
mod compare;
mod drive;
mod dynamics;
mod error;
mod flank;
mod law;
mod load;
mod newton;
mod outcome;
mod parameters;
mod quasi_static;
mod scene;
mod spheres;
mod state;
mod strips;
mod template;

pub use compare::exact_mean_mm;
pub use error::{ParameterName, SimulationError};
pub use outcome::{Counters, Energy, Outcome, RunEnd, Sample, Steady, Watch, YokeSample};
pub use parameters::{ContactModel, Integrator, Masses, Parameters, SphereGrid, StripGrid, Support, Yoke};
pub use scene::Scene;
pub use state::{Coordinates, Forces};
