//! The README and the manual: every command in them runs, and measured numbers are copied from the files that the
//! examples wrote, never typed.
//!
//! `RACKMESH_UPDATE=1 cargo test --test it readme` copies them anew. Transcripts are compared by `tests/cli.rs`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// A page of the manual: its path from the root, and its text.
struct Page {
    path: String,
    text: String,
}

/// The README and the chapters.
fn pages() -> Vec<Page> {
    let chapters = in_docs().into_iter().filter(|path| Path::new(path).extension() == Some("md".as_ref()));
    std::iter::once("README.md".to_owned())
        .chain(chapters)
        .map(|path| Page { text: std::fs::read_to_string(root().join(&path)).unwrap(), path })
        .collect()
}

fn in_docs() -> BTreeSet<String> {
    let entries = std::fs::read_dir(root().join("docs")).unwrap();
    entries.map(|entry| format!("docs/{}", entry.unwrap().file_name().to_str().unwrap())).collect()
}

/// The lines of a page, each with the language of the block that it stands in.
fn lines(text: &str) -> Vec<(Option<&str>, &str)> {
    let mut block = None;
    let mut found = Vec::new();
    for line in text.lines() {
        match (line.strip_prefix("```"), block) {
            (Some(language), None) => block = Some(language),
            (Some(_), Some(_)) => block = None,
            (None, _) => found.push((block, line)),
        }
    }
    found
}

/// A command of a page, and the exit status that stands behind it in brackets, or 0.
struct Shown {
    command: String,
    status: i32,
}

impl Shown {
    fn new(command: &str, behind: &str) -> Self {
        let stated = behind.trim_start_matches([' ', '#']).strip_prefix("(exit status ");
        let status = stated.map_or(0, |status| status.split(')').next().unwrap().parse().unwrap());
        Self { command: command.to_owned(), status }
    }
}

/// The commands of a page that are no transcript: in text and tables, and in blocks of a shell or a workflow.
fn commands(page: &Page) -> Vec<Shown> {
    let mut found = Vec::new();
    for (block, line) in lines(&page.text) {
        match block {
            None => {
                let pieces: Vec<_> = line.split('`').collect();
                let code = pieces.windows(2).skip(1).step_by(2);
                found.extend(
                    code.filter(|code| code[0].starts_with("rackmesh ")).map(|code| Shown::new(code[0], code[1])),
                );
            }
            Some("sh" | "yaml") => {
                let (command, behind) = line.split_once(" #").unwrap_or((line, ""));
                let command = command.trim_start().trim_start_matches("- run: ");
                if ["rackmesh ", "mkdir "].iter().any(|program| command.starts_with(program)) {
                    found.push(Shown::new(command, behind));
                }
            }
            Some(_) => {}
        }
    }
    found
}

/// As a new user does: in a fresh folder with the examples, in the order in which they stand there.
#[cfg(unix)]
#[test]
fn every_command_runs() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("commands-of-the-manual");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(folder.join("examples")).unwrap();
    for example in std::fs::read_dir(root().join("examples")).unwrap() {
        let example = example.unwrap();
        std::fs::copy(example.path(), folder.join("examples").join(example.file_name())).unwrap();
    }
    let program = Path::new(env!("CARGO_BIN_EXE_rackmesh")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let mut done = BTreeSet::new();
    // the changelog speaks of options, with placeholders
    for page in pages().iter().filter(|page| page.path != "docs/changelog.md") {
        for Shown { command, status } in commands(page) {
            if !done.insert(command.clone()) {
                continue;
            }
            let mut shell = Command::new("sh");
            shell.args(["-c", &command]).current_dir(&folder).env("PATH", &path).env("HOME", &folder);
            let output = shell.stdin(Stdio::null()).output().unwrap();
            let said = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(status), "{}: {command}: {said}", page.path);
        }
    }
    assert!(done.len() > 30, "{} commands", done.len());
    every_picture_is_drawn_by_a_command(&folder);
}

/// A picture in text without what a file has and a page has not: its name space and its style.
fn drawing(svg: &str) -> String {
    let (head, body) = svg.split_once("</desc>\n").unwrap();
    let body = body.split_once("</style>\n").map_or(body, |(_, body)| body);
    format!("{}</desc>\n{}", head.replace("xmlns=\"http://www.w3.org/2000/svg\" ", ""), body.trim_end())
}

/// The manual's pictures are those that its commands write into this folder, as files or on pages.
fn every_picture_is_drawn_by_a_command(folder: &Path) {
    // what example programs draw, and one of a rack that is in no example
    const OTHERS: [&str; 4] =
        ["docs/along-the-stroke.svg", "docs/laws.svg", "docs/decision-rules.svg", "docs/every-pitch-off.svg"];
    let written = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_drawn = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "svg" || ending == "html");
    let drawn: Vec<_> = written.filter(is_drawn).map(|path| std::fs::read_to_string(path).unwrap()).collect();
    let pictures = in_docs().into_iter().filter(|path| is_drawn(&PathBuf::from(path)));
    for picture in pictures.filter(|path| !OTHERS.contains(&path.as_str())) {
        let drawing = drawing(&std::fs::read_to_string(root().join(&picture)).unwrap());
        let is_it =
            |text: &String| text.contains(&drawing) || text.starts_with("<svg") && self::drawing(text) == drawing;
        assert!(drawn.iter().any(is_it), "no command of the manual draws {picture} as it is");
    }
}

/// What a page links to: the path from the root, and the heading.
struct Link {
    path: String,
    heading: Option<String>,
}

fn links(page: &Page) -> Vec<Link> {
    let folder = page.path.rsplit_once('/').map_or("", |(folder, _)| folder);
    let text = lines(&page.text).into_iter().filter(|(block, _)| block.is_none()).map(|(_, line)| line);
    let targets = text.flat_map(|line| line.split("](").skip(1).map(|behind| behind.split(')').next().unwrap()));
    let own = targets.filter(|target| !target.starts_with("https://"));
    own.map(|target| {
        let (path, heading) = target.split_once('#').map_or((target, None), |(path, heading)| (path, Some(heading)));
        let path = match path.strip_prefix("../") {
            _ if path.is_empty() => page.path.clone(),
            Some(path) => path.to_owned(),
            None if folder.is_empty() => path.to_owned(),
            None => format!("{folder}/{path}"),
        };
        Link { path, heading: heading.map(str::to_owned) }
    })
    .collect()
}

/// What a heading is called in a link.
fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|sign| sign.is_alphanumeric() || " -_".contains(*sign));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

#[test]
fn every_link_leads_somewhere() {
    for page in pages() {
        for Link { path, heading } in links(&page) {
            assert!(root().join(&path).exists(), "{}: there is no {path}", page.path);
            let Some(heading) = heading else { continue };
            let text = std::fs::read_to_string(root().join(&path)).unwrap();
            let headings = lines(&text).into_iter().filter(|(block, line)| block.is_none() && line.starts_with('#'));
            let mut anchors = headings.map(|(_, line)| anchor(line.trim_start_matches('#').trim()));
            assert!(anchors.any(|anchor| anchor == heading), "{}: {path} has no heading {heading}", page.path);
        }
    }
}

#[test]
fn every_file_of_the_manual_is_linked() {
    let linked: BTreeSet<String> = pages()
        .iter()
        .flat_map(|page| links(page).into_iter().map(|link| link.path).filter(|path| *path != page.path))
        .collect();
    let alone: Vec<_> = in_docs().into_iter().filter(|file| !linked.contains(file)).collect();
    assert!(alone.is_empty(), "nothing links to {alone:?}");
}

#[test]
fn the_readme_is_one_page() {
    assert!(pages()[0].text.lines().count() <= 200);
}
/// Holds the text of a page between `<!-- name -->` and `<!-- end -->` against `text`, or replaces it.
fn check(page: &str, name: &str, text: &str) {
    let path = root().join(page);
    let written = std::fs::read_to_string(&path).unwrap();
    let begin = format!("<!-- {name} -->\n");
    let start = written.find(&begin).unwrap_or_else(|| panic!("{page} has no {begin}")) + begin.len();
    let end = start + written[start..].find("<!-- end -->").unwrap();
    if std::env::var_os("RACKMESH_UPDATE").is_some() {
        std::fs::write(&path, format!("{}{text}{}", &written[..start], &written[end..])).unwrap();
    } else {
        assert_eq!(&written[start..end], text, "RACKMESH_UPDATE=1 cargo test --test it readme copies the numbers anew");
    }
}

/// A number of the file with two digits: 3.5 µs, 0.12 s; 1.4 µm, 0.03 nm.
fn in_words(value: f64, unit: &str) -> String {
    let (size, prefix) = [(1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p")]
        .into_iter()
        .find(|(size, _)| value >= 0.999 * size)
        .unwrap_or((1e-12, "p"));
    let value = value / size;
    let decimals = if value >= 10.0 {
        0
    } else if value >= 1.0 {
        1
    } else {
        2
    };
    format!("{value:.decimals$} {prefix}{unit}")
}

/// Case, run time in s, error in mm.
type Measured<'a> = (&'a str, f64, f64);

#[test]
fn run_time_and_error() {
    let file = std::fs::read_to_string(root().join("benches/results/run-time-and-error.csv")).unwrap();
    let mut rows: BTreeMap<(&str, &str), Vec<Measured<'_>>> = BTreeMap::new();
    for line in file.lines().skip(1) {
        let cells: Vec<_> = line.split(',').collect();
        let [case, model, setting, time, error, _] = cells[..] else { panic!("{line}") };
        rows.entry((model, setting)).or_default().push((case, time.parse().unwrap(), error.parse().unwrap()));
    }
    let mut table =
        "| model | setting | run time | error: over-roller | pitch | lead |\n|---|---|---|---|---|---|\n".to_owned();
    for key in [
        ("formula", "exact model"),
        ("exact mesh", "tolerance 1e-3"),
        ("exact mesh", "tolerance 1e-6"),
        ("equilibrium (spheres)", "48 × 96 spheres"),
        ("equilibrium (exact surfaces)", "64 strips"),
        ("in time (spheres)", "48 × 96 spheres"),
        ("in time (spheres)", "96 × 192 spheres"),
    ] {
        let cases = &rows[&key];
        let names: Vec<_> = cases.iter().map(|case| case.0).collect();
        assert_eq!(names, ["over-roller", "pitch", "lead"]);
        let (fastest, slowest) =
            cases.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), case| (low.min(case.1), high.max(case.1)));
        let errors: Vec<_> = cases
            .iter()
            .map(|case| if case.2 < 1e-11 { "none".to_owned() } else { in_words(1e-3 * case.2, "m") })
            .collect();
        let time = format!("{} … {}", in_words(fastest, "s"), in_words(slowest, "s"));
        table.push_str(&format!("| {} | {} | {time} | {} |\n", key.0, key.1, errors.join(" | ")));
    }
    check("docs/models.md", "run time and error", &table);
}

#[test]
fn accuracy() {
    let written = std::fs::read_to_string(root().join("benches/results/accuracy.md")).unwrap();
    // the promise of src/formula/precision.md, which rounding to the last digit nearly fills by half
    let formulas = written.lines().take_while(|line| !line.is_empty()).skip(2);
    let errors = formulas.map(|line| line.trim_end_matches(" |").rsplit(' ').next().unwrap().parse::<f64>().unwrap());
    let worst = errors.fold(0.0, f64::max);
    assert!(worst > 0.4 && worst <= 1.0, "{worst}");
}
