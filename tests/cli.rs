//! The README's commands and the transcripts in `tests/cmd`, each compared with its whole output.
//!
//! After a wanted change, `TRYCMD=overwrite cargo test --test cli` writes the new outputs.

#[test]
fn readme_and_transcripts() {
    let cases = trycmd::TestCases::new();
    cases.case("README.md").case("tests/cmd/*.md");
    if cfg!(not(feature = "xlsx")) {
        cases.skip("tests/cmd/workbooks.md");
    }
}
