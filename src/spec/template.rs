//! The commented spec that `rackmesh init` writes; a test reads it back.

/// A spec with every key, explained, ready to evaluate.
pub const TEMPLATE: &str = include_str!("template.toml");
