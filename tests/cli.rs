//! The transcripts in the README, the manual and `tests/cmd`, each compared with its whole output.
//!
//! After a wanted change, `TRYCMD=overwrite cargo test --test cli` writes the new outputs.

#[test]
fn transcripts() {
    trycmd::TestCases::new().case("README.md").case("docs/*.md").case("tests/cmd/*.md");
}
