//! How far manufacturing errors move the operating centre distance (ΔCD) of a rack and pinion.
//!
//! A steering rack and its pinion are measured: the measure over a roller, the pitches and the lead of the
//! rack, the radial measures, the pitches and the lead of the pinion. From the deviations rackmesh predicts how
//! far the pinion's axis moves away from the rack, without backlash.
//!
//! # The map
//! Data flows one way:
//!
//! | module | what it is |
//! |---|---|
//! | [`quantity`] | lengths and angles on a grid finer than any measurement; domains and their errors |
//! | [`trig`] | the only place that computes sines, the same bits everywhere |
//! | [`deviation`] | the deviations of a part |
//! | [`formula`] | ΔCD of one error: a law for each, with its inverse and sensitivities |
//! | [`standard`] | accuracy grades: permissible deviations by standard and edition |
//! | [`gear`] | the nominal pair, valid by construction |
//! | [`mesh`] | ΔCD along the stroke: the exact zero-backlash mesh of every tooth's own deviations |
//! | [`multibody`] | elastic contact simulated: equilibrium along the stroke, motion in time |
//! | [`reproduction`] | the paper's tables and figure, recomputed |
//! | [`statistics`] | distribution functions, quantiles, capability |
//! | [`judge`] | bounds of ΔCD for errors with extents, their combination, limits, decision rules, classes and grades |
//! | [`uncertainty`] | from the uncertainties of inputs to that of ΔCD |
//! | [`evaluation`] | the errors of a part, judged |
//! | [`function`] | the yoke's play and its setting, the pinion's torque and lift-off, from the curve |
//! | [`chance`] | random parts and random racks |
//! | [`budget`] | the largest tolerances that a limit leaves |
#![cfg_attr(feature = "spec", doc = "| [`spec`] | the gear spec: TOML as written, and what it means |")]
#![cfg_attr(feature = "table", doc = "| [`table`] | tables of measured values |")]
#![cfg_attr(feature = "batch", doc = "| [`batch`] | tables with a row per part, of any length |")]
#![cfg_attr(feature = "report", doc = "| [`report`] | results as tables, Markdown, CSV and JSON |")]
//! | [`diagnostic`] | what is wrong with an input, where, and what to do |
#![cfg_attr(feature = "cli", doc = "| [`cli`] | the command line |")]
//!
//! # For a calculation
//! ```
//! use rackmesh::formula::{Law, Model};
//! use rackmesh::quantity::Length;
//!
//! let law = Law::rack_pitch("20 deg".parse()?, "12 deg".parse()?)?;
//! let delta_cd = law.delta_cd("20 um".parse::<Length>()?, Model::Exact)?;
//! assert_eq!(format!("{:.4} mm", delta_cd.mm()), "0.0269 mm");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # For a check
//! ```
//! use rackmesh::evaluation::evaluate;
//! use rackmesh::judge::{Limit, LimitTarget, Stack, Verdict};
//! use rackmesh::formula::{Law, Model, PartDeviation};
//! use rackmesh::judge::bound::Basis;
//! use rackmesh::quantity::Length;
//!
//! let (measured, nominal): (Length, Length) = ("25.0131".parse()?, "25.0000".parse()?);
//! let limits = vec![(LimitTarget::CenterDistance, Limit::symmetric("0.0131".parse()?))];
//! let errors = [PartDeviation::new(Law::rack_over_roller(), measured - nominal)];
//! let evaluation = evaluate(&errors, &limits, Model::Exact, Stack::Range, &Basis::default())?;
//! assert_eq!(evaluation.verdict, Some(Verdict::Pass)); // equal to the limit is inside it
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![cfg_attr(
    feature = "spec",
    doc = r#"
# For a file
```
use rackmesh::spec::Spec;

let spec = Spec::parse("rack.toml", "[errors]\nrack_over_roller = \"13 um\"")?;
assert_eq!(spec.part_deviations()?.len(), 1);
# Ok::<(), rackmesh::diagnostic::Diagnostics>(())
```
"#
)]

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}

/// Implements `Display` with the name of a value.
macro_rules! display_by_name {
    ($type:ty) => {
        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}

/// Declares an enum whose variants have names.
macro_rules! named {
    (
        $(#[$of_type:meta])*
        pub enum $type:ident {
            $($(#[$of_variant:meta])* $variant:ident = $name:literal),+ $(,)?
        }
    ) => {
        $(#[$of_type])*
        pub enum $type {
            $($(#[$of_variant])* $variant),+
        }

        impl $type {
            /// Every variant.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$variant),+];

            #[doc = concat!("Its name" $(, " `", $name, "`")+, ".")]
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
        }
    };
}

#[cfg(feature = "batch")]
pub mod batch;
pub mod budget;
pub mod chance;
#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "spec")]
pub mod design;
pub mod deviation;
pub mod diagnostic;
pub mod evaluation;
pub mod formula;
pub mod function;
pub mod gear;
pub mod judge;
mod linear;
pub mod mesh;
pub mod multibody;
mod parallel;
pub mod quantity;
#[cfg(feature = "report")]
pub mod report;
pub mod reproduction;
#[cfg(feature = "spec")]
pub mod spec;
pub mod standard;
pub mod statistics;
#[cfg(feature = "table")]
#[cfg_attr(
    not(feature = "cli"),
    allow(dead_code, unused_imports, reason = "only batches and the command line use some of it")
)]
pub mod table;
pub mod trace;
pub mod trig;
pub mod uncertainty;
