//! The README's commands and the transcripts in `tests/cmd`, each compared with its whole output.
//!
//! After a wanted change, `TRYCMD=overwrite cargo test --test cli` writes the new outputs.

#[test]
fn readme_and_transcripts() {
    trycmd::TestCases::new().case("README.md").case("tests/cmd/*.md");
}
