//! Every input that a fuzzer found worth keeping, checked as the fuzzer checks it.

#[path = "../../fuzz/src/lib.rs"]
#[allow(unreachable_pub, clippy::pedantic)]
mod fuzz;

use std::panic::catch_unwind;
use std::path::{Path, PathBuf};

use crate::common::is_long;
use crate::common::random::Random;

/// The folders of valid inputs that are changed, beside a target's corpus.
const SPECS: [&str; 2] = ["examples", "tests/specs"];
const TABLES: [&str; 2] = ["tests/pasted", "tests/tables"];

/// The files in a folder and those below it.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.unwrap().path();
        if path.is_dir() { files(&path, found) } else { found.push(path) }
    }
}

/// An input with some of its bytes changed, taken out, repeated, or put in from another one.
fn changed(random: &mut Random, of: &[u8], other: &[u8]) -> Vec<u8> {
    const TEXTS: [&[u8]; 12] = [
        b"-",
        b"1e999",
        b"nan",
        b"inf",
        b"\"",
        b"\0",
        b"\n",
        b";",
        b"\xff",
        b"{",
        b"99999999999999999999",
        "\u{b5}".as_bytes(),
    ];
    let mut input = of.to_vec();
    for _ in 0..random.int(1, 6) {
        let at = random.int(0, input.len() as i64) as usize;
        let end = (at + random.int(0, 12) as usize).min(input.len());
        let piece = match random.int(0, 4) {
            0 => Vec::new(),
            1 => input[at..end].repeat(2),
            2 => input[at..end].iter().map(|byte| byte ^ 1 << random.int(0, 7)).collect(),
            3 => TEXTS[random.int(0, 11) as usize].to_vec(),
            _ => {
                let from = random.int(0, other.len() as i64) as usize;
                other[from..(from + random.int(0, 60) as usize).min(other.len())].to_vec()
            }
        };
        input.splice(at..end, piece);
    }
    input
}

/// Changed inputs, checked as the fuzzer checks them; `RACKMESH_LONG_TESTS=1` checks so many.
fn mutate(target: &str, folders: &[&str], (short, long): (usize, usize), check: fn(&[u8])) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    files(&root.join("fuzz/corpus").join(target), &mut found);
    for folder in folders {
        files(&root.join(folder), &mut found);
    }
    found.sort();
    let read = |path: &PathBuf| std::fs::read(path).unwrap();
    let inputs: Vec<_> = found.iter().map(read).filter(|input| input.len() < 20_000).collect();
    let mut random = Random(46);
    let mut some = || (inputs[random.int(0, inputs.len() as i64 - 1) as usize].clone(), Random(random.next()));
    let mut failed = 0;
    let count = if is_long() { long } else { short };
    for _ in 0..count {
        let ((of, mut by), (other, _)) = (some(), some());
        let input = changed(&mut by, &of, &other);
        if catch_unwind(|| check(&input)).is_err() {
            failed += 1;
            println!("{target}: \"{}\"", input.escape_ascii());
        }
    }
    println!("{target}: {count} changed inputs, {failed} failed");
    assert_eq!(failed, 0);
}

#[test]
fn changed_specs() {
    mutate("spec", &SPECS, (60, 22_000), fuzz::spec::check);
}

#[test]
fn changed_meshes() {
    mutate("mesh", &[], (6, 2_000), fuzz::mesh::check);
}

#[test]
fn changed_tables() {
    mutate("table", &TABLES, (60, 30_000), fuzz::table::check);
}

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
