//! What rackmesh is built from: licences that go with its own, and no C.
//!
//! `RACKMESH_UPDATE=1 cargo test --test it dependencies` writes the list in `LICENSE-THIRD-PARTY.md` anew. Nothing is
//! asked of the network: Cargo knows the licence of every package that it has built. The list is that of 64-bit Linux
//! with every feature.
#![cfg(all(target_os = "linux", target_arch = "x86_64"))]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// Licences that allow use in a program under the MIT licence, with no more asked than that they be named.
const ALLOWED: &[&str] = &[
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "MIT",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Packages whose build scripts compile C or look for C libraries.
const C_BUILDERS: &[&str] = &["bindgen", "cc", "cmake", "pkg-config", "vcpkg"];

fn metadata() -> Value {
    let output = Command::new(env!("CARGO"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["metadata", "--format-version=1", "--locked", "--offline", "--all-features"])
        .arg("--filter-platform=x86_64-unknown-linux-gnu")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The packages by name and version that the library and the program need, with those that only their tests need or
/// without.
fn packages<'a>(metadata: &'a Value, with_tests: bool) -> BTreeMap<(&'a str, &'a str), &'a Value> {
    let by_id = |list: &'a Value| -> BTreeMap<&'a str, &'a Value> {
        list.as_array().unwrap().iter().map(|item| (item["id"].as_str().unwrap(), item)).collect()
    };
    let (packages, nodes) = (by_id(&metadata["packages"]), by_id(&metadata["resolve"]["nodes"]));
    let mut open = vec![metadata["resolve"]["root"].as_str().unwrap()];
    let mut found = BTreeSet::new();
    while let Some(id) = open.pop() {
        if found.insert(id) {
            let needed = nodes[id]["deps"].as_array().unwrap().iter().filter(|dependency| {
                with_tests || dependency["dep_kinds"].as_array().unwrap().iter().any(|kind| kind["kind"] != "dev")
            });
            open.extend(needed.map(|dependency| dependency["pkg"].as_str().unwrap()));
        }
    }
    let text = |id: &str, key: &str| packages[id][key].as_str().unwrap();
    let others = found.into_iter().filter(|id| text(id, "name") != "rackmesh");
    others.map(|id| ((text(id, "name"), text(id, "version")), packages[id])).collect()
}

/// Whether one alternative of every part of an SPDX expression is allowed.
fn is_allowed(expression: &str) -> bool {
    let plain = expression.replace(['(', ')'], "").replace('/', " OR ");
    plain.split(" AND ").all(|part| part.split(" OR ").any(|licence| ALLOWED.contains(&licence.trim())))
}

#[test]
fn licences_are_listed_and_compatible() {
    let metadata = metadata();
    let mut by_licence: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for ((name, version), package) in packages(&metadata, false) {
        let licence = package["license"].as_str().unwrap_or_else(|| panic!("{name} {version} names no licence"));
        assert!(is_allowed(licence), "{name} {version}: {licence}");
        by_licence.entry(licence).or_default().push(format!("{name} {version}"));
    }
    let mut list = "# Licences of what rackmesh is built from\n\nWith every feature, on 64-bit Linux. Each allows use in a program under the \
                    MIT licence.\n"
        .to_owned();
    for (licence, packages) in by_licence {
        list += &format!("\n## {licence}\n\n{}\n", packages.join(", "));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("LICENSE-THIRD-PARTY.md");
    if std::env::var_os("RACKMESH_UPDATE").is_some() {
        std::fs::write(&path, list).unwrap();
    } else {
        let written = std::fs::read_to_string(&path).unwrap();
        assert_eq!(written, list, "RACKMESH_UPDATE=1 cargo test --test it dependencies writes the list anew");
    }
}

#[test]
fn expressions_are_read() {
    assert!(is_allowed("(MIT OR Apache-2.0) AND Unicode-3.0"));
    assert!(is_allowed("GPL-3.0/MIT"));
    assert!(!is_allowed("MIT AND GPL-3.0-only"));
    assert!(!is_allowed("MPL-2.0"));
}

#[test]
fn nothing_compiles_or_links_c() {
    let metadata = metadata();
    for ((name, version), package) in packages(&metadata, true) {
        assert!(package["links"].is_null() || name == "rayon-core", "{name} {version} links {}", package["links"]);
        for dependency in
            package["dependencies"].as_array().unwrap().iter().filter(|dependency| dependency["kind"] == "build")
        {
            let builder = dependency["name"].as_str().unwrap();
            assert!(
                !C_BUILDERS.contains(&builder) || dependency["optional"] == true,
                "{name} {version} is built with {builder}"
            );
        }
    }
}
