//! The order in which the program's functions are linked on Linux, so that `rackmesh eval` starts at once.
//!
//! Starting is mostly page faults, and the system brings in code by blocks of 64 KiB. What `eval` runs is an eighth of
//! the program; spread all over it, nearly every block was brought in. `start-order` holds the names of those
//! functions, as `record` saw them run, and this script has the linker put them one behind the other. Without it `eval`
//! takes 1.2 times as long and peaks at 5.1 instead of 3.3 MiB (`cargo bench --bench startup`).
//!
//! It is an order and nothing else: a name that no longer exists costs a little time. Where a linker was chosen (a
//! linker in Cargo's configuration, `-C linker`, `-fuse-ld`) it is left alone, because not every linker reads scripts.

use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=link/start-order");
    let variable = |name: &str| std::env::var(name).unwrap_or_default();
    let is_gnu_linux = variable("CARGO_CFG_TARGET_OS") == "linux" && variable("CARGO_CFG_TARGET_ENV") == "gnu";
    let flags = variable("CARGO_ENCODED_RUSTFLAGS");
    let is_chosen = !variable("RUSTC_LINKER").is_empty() || flags.contains("link") || flags.contains("fuse-ld");
    if !is_gnu_linux || is_chosen || variable("PROFILE") != "release" {
        return;
    }
    let script = Path::new(&variable("OUT_DIR")).join("start.ld");
    match std::fs::write(&script, order(include_str!("start-order"))) {
        Ok(()) => println!("cargo::rustc-link-arg-bin=rackmesh=-Wl,-T,{}", script.display()),
        Err(error) => println!("cargo::warning=the start-up order is left out: {error}"),
    }
}

/// A linker script that puts the named functions before the rest of the code. Functions that the compiler thinks
/// unlikely stand in sections of their own.
fn order(names: &str) -> String {
    let mut script = "SECTIONS {\n  .text.start : {\n".to_owned();
    for name in names.lines() {
        script += &format!("    *(.text.{name} .text.unlikely.{name})\n");
    }
    script + "  }\n}\nINSERT BEFORE .text;\n"
}
