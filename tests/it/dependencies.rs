//! What rackmesh is built from: licences that go with its own, and no C. Which licences go with it says `deny.toml`.
//!
//! `RACKMESH_UPDATE=1 cargo test --test it dependencies` writes the list in `LICENSE-THIRD-PARTY.md` anew. Nothing is
//! asked of the network: Cargo knows every package that it has built. The list is that of 64-bit Linux.
#![cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// Packages whose build scripts compile C or look for C libraries.
const C_BUILDERS: &[&str] = &["bindgen", "cc", "cmake", "pkg-config", "vcpkg"];

/// What Cargo says of the packages that this test was built with; others need not be there.
fn metadata() -> Value {
    let output = Command::new(env!("CARGO"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["metadata", "--format-version=1", "--locked", "--offline"])
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

#[test]
fn licences_are_listed() {
    let metadata = metadata();
    let mut by_licence: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for ((name, version), package) in packages(&metadata, false) {
        let licence = package["license"].as_str().unwrap_or_else(|| panic!("{name} {version} names no licence"));
        by_licence.entry(licence).or_default().push(format!("{name} {version}"));
    }
    let mut list = "# Licences of what rackmesh is built from\n\nOn 64-bit Linux. Each allows use in a program under the MIT licence.\n"
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

/// Packages of which the program has two versions, each with its reason in `docs/developers.md`.
#[test]
fn two_versions_of_a_package_have_a_reason() {
    let metadata = metadata();
    let packages = packages(&metadata, false);
    let names: Vec<_> = packages.keys().map(|(name, _)| *name).collect();
    let mut twice: Vec<_> = names.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
    twice.dedup();
    assert_eq!(twice, ["getrandom", "syn"]);
}

#[test]
fn nothing_compiles_or_links_c() {
    let metadata = metadata();
    for ((name, version), package) in packages(&metadata, true) {
        assert!(package["links"].is_null() || name == "rayon-core", "{name} {version} links {}", package["links"]);
        assert!(!C_BUILDERS.contains(&name), "{name} {version} builds C");
    }
}
