//! The house itself: every source file is part of the program or its tests.

use std::path::{Path, PathBuf};

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The files that may declare the module in a file.
fn parents(file: &Path) -> Vec<PathBuf> {
    let is_folder = file.ends_with("mod.rs");
    let folder = file.parent().unwrap();
    let folder = if is_folder { folder.parent().unwrap() } else { folder };
    vec![folder.join("mod.rs"), folder.join("lib.rs"), folder.join("main.rs"), folder.with_extension("rs")]
}

/// A file that nothing declares is neither compiled nor tested, and nothing says so.
#[test]
fn every_source_file_is_declared() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in ["src", "tests/it"] {
        sources(&root.join(folder), &mut files);
    }
    assert!(files.len() > 200, "{} files", files.len());
    for file in files.iter().filter(|file| !["lib.rs", "main.rs"].iter().any(|crate_root| file.ends_with(crate_root))) {
        let name = if file.ends_with("mod.rs") { file.parent().unwrap().file_name() } else { file.file_stem() };
        let declaration = format!("mod {};", name.unwrap().to_str().unwrap());
        let is_declared = |parent: &PathBuf| {
            let text = std::fs::read_to_string(parent).unwrap_or_default();
            text.lines().any(|line| line.trim_start().trim_start_matches("pub ").ends_with(&declaration))
        };
        assert!(parents(file).iter().any(is_declared), "nothing declares {}", file.display());
    }
}
