//! Every input that a fuzzer found worth keeping, checked as the fuzzer checks it.

#[path = "../../fuzz/src/lib.rs"]
#[allow(unreachable_pub, clippy::pedantic)]
mod fuzz;

use std::path::Path;

fn replay(target: &str, check: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let mut inputs = 0;
    for entry in std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.unwrap().path();
        // the name of the input that fails is printed with the failure
        println!("{}", path.display());
        check(&std::fs::read(&path).unwrap());
        inputs += 1;
    }
    assert!(inputs > 0, "no inputs in {}", folder.display());
}

#[test]
fn specs() {
    replay("spec", fuzz::spec::check);
}

#[test]
fn meshes() {
    replay("mesh", fuzz::mesh::check);
}

#[test]
fn tables() {
    replay("table", fuzz::table::check);
}
