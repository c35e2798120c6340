//! The commented spec that `rackmesh init` writes; a test reads it back.

/// A short spec with the keys that most pairs need, ready for every command that takes one.
pub const TEMPLATE: &str = include_str!("template.toml");
