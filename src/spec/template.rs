//! The commented spec that `rackmesh init` writes.

/// A spec with every key, explained, ready to evaluate.
pub const TEMPLATE: &str = include_str!("template.toml");
