//! The house itself: every source file is part of the program or its tests, and what `docs/house.md` counts.
//!
//! `cargo test --test it house -- --nocapture` prints the figures.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Attributes that allow or expect a lint, outside the crate's root.
const MOST_ATTRIBUTES: usize = 30;
/// Functions of more than 60 lines of code.
const MOST_LONG_FUNCTIONS: usize = 10;
/// Functions of more than 6 arguments, `self` included.
const MOST_WIDE_FUNCTIONS: usize = 0;
/// Lines of a file of the program or of its tests.
const MOST_LINES_OF_A_FILE: usize = 450;
/// Rooms that use each other, directly or through others.
const MOST_ROOMS_IN_CYCLES: usize = 0;
/// Files that import each other, directly or through others.
const MOST_FILES_IN_CIRCLES: usize = 61;

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

/// A file of the program: its path below `src`, and its lines of code.
struct Code {
    path: PathBuf,
    lines: Vec<String>,
}

impl Code {
    /// The folder, or the file itself at the root.
    fn room(&self) -> String {
        let first = self.path.components().next().unwrap().as_os_str().to_str().unwrap();
        first.trim_end_matches(".rs").to_owned()
    }
}

fn indent(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

/// The line that closes what `lines[first]` opens: the same one if it opens nothing.
fn end(lines: &[&str], first: usize) -> usize {
    let opens = lines[first..].iter().position(|line| line.ends_with(['{', '}', ';'])).map(|by| first + by);
    let Some(opens) = opens.filter(|at| lines[*at].ends_with('{')) else { return opens.unwrap_or(first) };
    let closes = |line: &&str| indent(line) == indent(lines[first]) && line.trim_start().starts_with('}');
    lines[opens..].iter().position(closes).map_or(lines.len() - 1, |by| opens + by)
}

/// The program without tests, comments and blank lines.
fn code() -> Vec<Code> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    files.retain(|file| !file.iter().any(|part| part == "tests" || part == "tests.rs"));
    let mut found = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let is_code = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
        let all: Vec<&str> = text.lines().filter(is_code).collect();
        let mut lines = Vec::new();
        let mut at = 0;
        while at < all.len() {
            if all[at].trim() == "#[cfg(test)]" {
                at += 1;
                while all[at].trim_start().starts_with("#[") {
                    at += 1;
                }
                at = end(&all, at);
            } else {
                lines.push(all[at].to_owned());
            }
            at += 1;
        }
        found.push(Code { path: file.strip_prefix(&root).unwrap().to_owned(), lines });
    }
    found
}

/// A function of the program.
struct Function {
    place: String,
    lines: usize,
    arguments: usize,
}

/// The arguments of a signature, from its name on.
fn arguments(signature: &str) -> usize {
    let signature = signature.replace("->", "");
    let (mut generics, mut depth, mut count, mut is_empty) = (0, 0, 0, true);
    for sign in signature.chars() {
        match sign {
            '<' => generics += 1,
            '>' => generics -= 1,
            '(' | '[' if depth > 0 || generics == 0 => depth += 1,
            ')' | ']' if depth == 1 => break,
            ')' | ']' if depth > 1 => depth -= 1,
            ',' if depth == 1 && generics == 0 => (count, is_empty) = (count + 1, true),
            _ if depth > 0 && !sign.is_whitespace() => is_empty = false,
            _ => {}
        }
    }
    count + usize::from(!is_empty)
}

fn functions(code: &[Code]) -> Vec<Function> {
    let mut found = Vec::new();
    for Code { path, lines } in code {
        let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        for (at, line) in lines.iter().enumerate() {
            let Some((before, name)) = line.split_once("fn ") else { continue };
            let is_function = before.split_whitespace().all(|word| word == "const" || word.starts_with("pub"));
            if is_function && line.contains(['(', '<']) {
                let end = end(&lines, at);
                let signature = name.to_owned() + &lines[at + 1..=end].concat();
                let place = format!("{}: {}", path.display(), name.split(['(', '<']).next().unwrap());
                found.push(Function { place, lines: end + 1 - at, arguments: arguments(&signature) });
            }
        }
    }
    found
}

/// Holds the number of places against the most that there may be.
fn hold(what: &str, places: &[String], most: usize) {
    println!("{}: {what}", places.len());
    assert!(places.len() <= most, "{} {what}, {most} at most:\n{}", places.len(), places.join("\n"));
}

#[test]
fn lines_of_code() {
    let mut rooms: BTreeMap<String, usize> = BTreeMap::new();
    for file in code() {
        *rooms.entry(file.room()).or_default() += file.lines.len();
    }
    println!("{}: lines of code, of which", rooms.values().sum::<usize>());
    for (room, lines) in rooms {
        println!("  {lines:6} {room}");
    }
}

#[test]
fn files_are_short() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in ["src", "tests/it"] {
        sources(&root.join(folder), &mut files);
    }
    let lines = files.iter().map(|file| (file, std::fs::read_to_string(file).unwrap().lines().count()));
    let long = lines.filter(|(_, lines)| *lines > MOST_LINES_OF_A_FILE);
    let long: Vec<_> = long.map(|(file, lines)| format!("{}: {lines} lines", file.display())).collect();
    hold(&format!("files above {MOST_LINES_OF_A_FILE} lines"), &long, 0);
}

#[test]
fn few_lints_are_allowed() {
    let code = code();
    let files = code.iter().filter(|file| !file.path.ends_with("lib.rs"));
    let lines =
        files.flat_map(|file| file.lines.iter().map(|line| format!("{}: {}", file.path.display(), line.trim())));
    let attributes: Vec<_> = lines.filter(|line| line.contains("#[allow(") || line.contains("#[expect(")).collect();
    hold("attributes that allow or expect a lint", &attributes, MOST_ATTRIBUTES);
}

#[test]
fn functions_are_short() {
    let all = functions(&code());
    assert!(all.len() > 2000, "{} functions", all.len());
    let long = all.iter().filter(|function| function.lines > 60);
    let long: Vec<_> = long.map(|function| format!("{}: {} lines", function.place, function.lines)).collect();
    hold("functions above 60 lines", &long, MOST_LONG_FUNCTIONS);
    let wide = all.iter().filter(|function| function.arguments > 6);
    let wide: Vec<_> = wide.map(|function| format!("{}: {} arguments", function.place, function.arguments)).collect();
    hold("functions above 6 arguments", &wide, MOST_WIDE_FUNCTIONS);
}

fn first_name(text: &str) -> &str {
    text.trim_start().split(|sign: char| !sign.is_alphanumeric() && sign != '_').next().unwrap()
}

/// Which rooms a room uses.
fn uses(code: &[Code]) -> BTreeMap<String, BTreeSet<String>> {
    let rooms: BTreeSet<String> = code.iter().map(Code::room).filter(|room| room != "lib" && room != "main").collect();
    let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for file in code.iter().filter(|file| rooms.contains(&file.room())) {
        let behind = file.lines.iter().flat_map(|line| line.split("crate::").skip(1));
        let named = behind.flat_map(|behind| match behind.strip_prefix('{') {
            Some(group) => group.split(',').map(first_name).collect(),
            None => vec![first_name(behind)],
        });
        let named = named.filter(|room| rooms.contains(*room) && **room != file.room()).map(str::to_owned);
        uses.entry(file.room()).or_default().extend(named);
    }
    uses
}

/// Those that reach themselves through what they use.
fn in_cycles<T: Ord + AsRef<Path>>(uses: &BTreeMap<T, BTreeSet<T>>) -> Vec<String> {
    let reaches_itself = |from: &T| {
        let mut reached = BTreeSet::new();
        let mut open: Vec<&T> = uses[from].iter().collect();
        while let Some(next) = open.pop() {
            if reached.insert(next) {
                open.extend(&uses[next]);
            }
        }
        reached.contains(from)
    };
    uses.keys().filter(|from| reaches_itself(from)).map(|from| from.as_ref().display().to_string()).collect()
}

#[test]
fn rooms_use_each_other_one_way() {
    let uses = uses(&code());
    for (room, used) in &uses {
        println!("{room} → {}", used.iter().cloned().collect::<Vec<_>>().join(", "));
    }
    let in_cycles = in_cycles(&uses);
    hold("rooms that use each other", &in_cycles, MOST_ROOMS_IN_CYCLES);
}

/// A `use` of a file outside its tests, each group spelled out.
struct Import {
    path: String,
    /// Whether others see it, so that it only hands a name on.
    is_public: bool,
}

fn imports(file: &Code) -> Vec<Import> {
    fn spell(path: &str, found: &mut Vec<String>) {
        let Some((before, group)) = path.split_once('{') else {
            return found.push(path.split(" as ").next().unwrap().trim().to_owned());
        };
        let (mut depth, mut start) = (0, 0);
        let inside = &group[..group.rfind('}').unwrap()];
        for (at, sign) in inside.char_indices().chain([(inside.len(), ',')]) {
            match sign {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    spell(&format!("{}{}", before.trim(), inside[start..at].trim()), found);
                    start = at + 1;
                }
                _ => {}
            }
        }
    }
    let text = file.lines.join(" ");
    let mut found = Vec::new();
    for statement in text.split(';') {
        // a text may have the word, too
        let is_path = |path: &str| {
            let is_plain = path.chars().all(|sign| sign.is_alphanumeric() || "_:{}, *".contains(sign));
            is_plain && path.matches('{').count() == path.matches('}').count()
        };
        let whole = statement.rsplit_once("use ").filter(|(_, path)| is_path(path));
        let Some((before, path)) = whole else { continue };
        let mut paths = Vec::new();
        spell(path, &mut paths);
        let is_public = before.trim_end().rsplit([' ', '}']).next().is_some_and(|word| word.starts_with("pub"));
        found.extend(paths.into_iter().map(|path| Import { path, is_public }));
    }
    found
}

/// The files of the program with what they import.
type Files<'f> = BTreeMap<PathBuf, (&'f Code, Vec<Import>)>;

/// The file that an import names: the longest module that there is, and of a name that its `mod.rs` only hands on, the file that
/// has it.
fn imported(file: &Path, import: &str, files: &Files<'_>) -> Option<PathBuf> {
    let mut module = if file.ends_with("mod.rs") { file.parent().unwrap().to_owned() } else { file.with_extension("") };
    let (mut found, mut name_in_it) = (None, None);
    for name in import.split("::") {
        match name {
            "crate" => module = PathBuf::new(),
            "super" => module = module.parent()?.to_owned(),
            "self" => {}
            name => module.push(name),
        }
        let as_file =
            [module.with_extension("rs"), module.join("mod.rs")].into_iter().find(|file| files.contains_key(file));
        name_in_it = if as_file.is_some() { None } else { name_in_it.or(Some(name)) };
        found = as_file.or(found);
    }
    let (found, name) = (found?, name_in_it.unwrap_or_default());
    let handed_on = files[&found].1.iter().filter(|import| import.is_public && found.ends_with("mod.rs"));
    let mut handed_on = handed_on.filter(|import| import.path.rsplit("::").next() == Some(name));
    handed_on.find_map(|import| imported(&found, &import.path, files)).or(Some(found)).filter(|found| found != file)
}

#[test]
fn files_do_not_import_in_circles() {
    let code = code();
    let files: Files<'_> = code.iter().map(|file| (file.path.clone(), (file, imports(file)))).collect();
    let of_file = |(path, (_, imports)): (&PathBuf, &(&Code, Vec<Import>))| {
        let own = imports.iter().filter(|import| !import.is_public || !path.ends_with("mod.rs"));
        own.filter_map(|import| imported(path, &import.path, &files)).filter(|file| !file.ends_with("lib.rs")).collect()
    };
    let uses: BTreeMap<PathBuf, BTreeSet<PathBuf>> = files.iter().map(|file| (file.0.clone(), of_file(file))).collect();
    let arrows = uses.values().map(BTreeSet::len).sum::<usize>();
    assert!(arrows > 400, "{arrows} imports of files");
    let in_circles = in_cycles(&uses);
    hold("files that import each other", &in_circles, MOST_FILES_IN_CIRCLES);
    let of_table: Vec<_> = in_circles.into_iter().filter(|file| file.starts_with("table")).collect();
    hold("files of `table` that import each other", &of_table, 0);
}
