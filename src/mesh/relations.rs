#![doc = include_str!("relations.md")]
