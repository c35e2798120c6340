//! The `rackmesh` program.
fn main() {}
