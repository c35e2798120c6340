//! The `rackmesh` program; all of it is in [`rackmesh::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    rackmesh::cli::run()
}
