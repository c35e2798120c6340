//! Everything that the library and the program promise, a module for each subject.
//!
//! The default run is short; `RACKMESH_LONG_TESTS=1` runs many times as many cases where a module says so.
#![allow(missing_docs)]

mod api;
mod batch;
mod batch_exact;
mod batch_parquet;
mod command_line;
mod common;
mod compare;
mod decimal_exactness;
mod dependencies;
mod domains;
mod followed;
mod formula_accuracy;
mod function;
mod function_parts;
mod function_simulated;
mod fuzz_corpus;
mod goldens;
mod house;
mod mesh_brute_force;
mod mesh_curve;
mod mesh_degenerate;
mod mesh_relations;
mod mesh_work;
mod multibody;
mod multibody_friction;
mod multibody_sweep;
mod one_answer;
mod outputs;
mod pages;
mod plausible;
mod process;
mod proposals;
mod reading;
mod readme;
mod set;
mod slips;
mod spec;
mod stability;
mod sweep;
mod tables;
mod teeth;
mod through;
mod trace;
mod unknowns;
mod verdicts;
