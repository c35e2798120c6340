#![doc = include_str!("method.md")]
//!
//! Called by the command line, the reports and anyone who has a [`Pair`](crate::gear::Pair) and its deviations. A
//! [`Scene`] holds both with its [`Parameters`], checked; [`Scene::quasi_static`] and [`Scene::dynamic`] run it and
//! give an [`Outcome`]. It must not know TOML, print, or read files. [`Scene::rolls`] tells whether φ exists,
//! [`Support::Yoke`] has the pinion's axis fixed, and the contact's elements are [`ContactModel::Spheres`] or
//! [`ContactModel::Analytic`].

mod bound;
mod closest;
mod compare;
mod drive;
mod dynamics;
mod energy;
mod error;
mod face;
mod flank;
mod law;
mod load;
mod meeting;
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
pub use error::SimulationError;
pub use outcome::{Counters, Energy, Extent, Outcome, RunEnd, RunForces, Sample, Steady, Watch, YokeSample};
pub use parameters::{ContactModel, Masses, ParameterName, Parameters, SphereGrid, StripGrid, Support, Yoke};
pub use scene::Scene;
pub use state::{Coordinates, Forces};
