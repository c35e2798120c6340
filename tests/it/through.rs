//! Nothing of an input steers what shows it: no character that moves a cursor, colours, turns the direction of a text or
//! ends a line comes through a command, whatever it stands in and wherever it goes.

use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

use rackmesh::diagnostic::is_steering;

/// Characters that steer: C0, DEL, C1, directions.
const STEERING: &str = "\u{1b}[41m\u{7}\u{8}\u{7f}\u{9b}2J\u{85}\u{202e}\u{2066}\u{2028}";

const SPEC: &str = "[pair]\nnormal_module = 1.9\nnormal_pressure_angle = 20\n[rack]\nface_width = 19.7\n[pinion]\nteeth = 7\n\
                    helix_angle = 25\n[errors]\nrack_over_roller = { nominal = 25.0 }\n[limits]\ncenter_distance = \"±0.05\"\n";

/// A folder with a spec and tables in which the characters stand, one place each.
struct Inputs(PathBuf);

impl Inputs {
    fn new() -> Self {
        static MADE: AtomicU32 = AtomicU32::new(0);
        let one = MADE.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("rackmesh-through-{}-{one}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let inputs = Self(folder);
        let toml = STEERING.chars().map(|c| format!("\\u{:04x}", u32::from(c))).collect::<Vec<_>>().concat();
        inputs.write("title.toml", &format!("title = \"a{toml}b\\n::error::c\"\n{SPEC}"));
        inputs.write("plain.toml", SPEC);
        inputs.write("key.toml", &format!("{SPEC}[errors.\"x{toml}\"]\nvalue = 1\n"));
        inputs.write("text.toml", &SPEC.replace("\"±0.05\"", &format!("\"{toml}\"")));
        inputs.write("raw.toml", &format!("{SPEC}# {STEERING}\nx = \"{STEERING}\"\n"));
        let quoted = STEERING.replace('"', "\"\"");
        // a text that is mostly control characters is none
        let rows = |more: &str| (0..300).map(|part| format!("p{part},25.01{more}\n")).collect::<Vec<_>>().concat();
        inputs.write(
            "name.csv",
            &format!("part_id,rack_over_roller\n\"a{quoted}\n::error::b\",25.01\n\"{quoted}\",26\n{}", rows("")),
        );
        inputs.write("heading.csv", &format!("part_id,rack_over_roller,\"x{quoted}\"\na,25.01,7\n{}", rows(",7")));
        inputs.write(
            "rack_pich.csv",
            &format!("part_id,rack_over_roller,\"rack_pich{quoted}\"\na,25.01,7\n{}", rows(",7")),
        );
        inputs.write("cell.csv", &format!("part_id,rack_over_roller\n\"b{quoted}\",\"2{quoted}\"\nc,25\n{}", rows("")));
        inputs.write("unit.csv", &format!("part_id,\"rack_over_roller [{quoted}]\"\nb,25\n{}", rows("")));
        inputs.write("mail.txt", &format!("Hello {STEERING},\nrack_over_roller: 25.012 mm\n{STEERING}foo: 12 mm\n"));
        #[cfg(unix)]
        inputs.write(&format!("file{STEERING}.csv"), "part_id,rack_over_roller\na,25.01\nb,x\n");
        inputs
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).unwrap();
    }

    /// What a command writes to its two streams, and to the files that it makes.
    fn outputs(&self, arguments: &[&str]) -> Vec<(String, Vec<u8>)> {
        let made = self.0.join("made");
        std::fs::create_dir_all(&made).unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_rackmesh"))
            .args(arguments)
            .current_dir(&self.0)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let mut outputs = vec![("stdout".to_owned(), output.stdout), ("stderr".to_owned(), output.stderr)];
        for entry in std::fs::read_dir(&made).unwrap() {
            let path = entry.unwrap().path();
            outputs.push((path.display().to_string(), std::fs::read(&path).unwrap()));
        }
        std::fs::remove_dir_all(&made).unwrap();
        outputs
    }
}

impl Drop for Inputs {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The text without the program's own colours.
fn without_colours(text: &str) -> String {
    let own = ["0", "1", "31", "32", "33", "91", "92", "93", "94", "96"];
    let mut parts = text.split("\u{1b}[");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        match part.split_once('m').filter(|(code, _)| code.split(';').all(|code| own.contains(&code))) {
            Some((_, rest)) => plain += rest,
            None => plain += &format!("\u{1b}{part}"),
        }
    }
    plain
}

fn assert_harmless(arguments: &[&str], (place, bytes): (String, Vec<u8>), is_coloured: bool) {
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let text = if is_coloured { without_colours(&text) } else { text };
    let text = if arguments.contains(&"tsv") { text.replace('\t', " ") } else { text };
    let found = text.find(|c| is_steering(c) && c != '\n');
    let near = |at: usize| text[at..].chars().take(40).collect::<String>().escape_debug().to_string();
    assert!(found.is_none(), "{arguments:?} lets through, in {place}: {}", near(found.unwrap_or(0)));
    // nobody takes a line of a page for a command
    assert!(
        std::path::Path::new(&place).extension().is_some_and(|ending| ending == "html")
            || !text.lines().any(|line| line.starts_with("::error::")),
        "{arguments:?} begins a line of its own in {place}"
    );
}

#[test]
fn nothing_of_an_input_steers_what_shows_it() {
    let inputs = Inputs::new();
    let file = format!("file{STEERING}.csv");
    let tables = ["name.csv", "heading.csv", "rack_pich.csv", "cell.csv", "unit.csv", "mail.txt", file.as_str()];
    for table in tables {
        for format in ["csv", "tsv", "jsonl"] {
            let arguments = ["batch", "title.toml", table, "--format", format, "--annotations", "github"];
            inputs.outputs(&arguments).into_iter().for_each(|output| assert_harmless(&arguments, output, false));
        }
        for format in ["table", "json", "csv", "markdown"] {
            for command in ["paste", "read"] {
                let spec = if command == "read" { None } else { Some("title.toml") };
                let arguments: Vec<_> =
                    [command].into_iter().chain(spec).chain([table, "--format", format, "--quiet"]).collect();
                inputs.outputs(&arguments).into_iter().for_each(|output| assert_harmless(&arguments, output, false));
            }
        }
        let summary = ["batch", "title.toml", table, "--summary", "--junit", "made/j.xml", "--ignore", "x*"];
        inputs.outputs(&summary).into_iter().for_each(|output| assert_harmless(&summary, output, false));
        for name in ["made/x.csv", "made/x.json", "made/x.md", "made/x.txt", "made/x.html"] {
            let arguments = ["paste", "title.toml", table, "--output", name, "--ignore", "x*"];
            inputs.outputs(&arguments).into_iter().for_each(|output| assert_harmless(&arguments, output, false));
        }
    }
    for spec in ["title.toml", "key.toml", "text.toml", "raw.toml"] {
        for command in ["eval", "report", "budget", "mesh", "simulate", "class"] {
            let arguments = [command, spec];
            inputs.outputs(&arguments).into_iter().for_each(|output| assert_harmless(&arguments, output, false));
        }
        let arguments = ["eval", spec, "--color", "always"];
        inputs.outputs(&arguments).into_iter().for_each(|output| assert_harmless(&arguments, output, true));
    }
    let unknown = format!("--x{STEERING}");
    for arguments in
        [vec!["eval", "plain.toml", &unknown], vec![&unknown], vec!["explain", &unknown[2..]], vec!["eval", &file]]
    {
        inputs.outputs(&arguments).into_iter().for_each(|output| assert_harmless(&arguments, output, false));
    }
}

#[test]
fn a_remedy_names_a_column_as_the_program_takes_it() {
    let inputs = Inputs::new();
    let refused = inputs.outputs(&["batch", "plain.toml", "heading.csv"]);
    let text = String::from_utf8(refused[1].1.clone()).unwrap();
    let block = text.split_once("in the spec:\n").and_then(|(_, rest)| rest.split_once("\n = help"));
    let block = block.unwrap_or_else(|| panic!("a block: {text}")).0;
    inputs.write("layout.toml", block);
    let read = inputs.outputs(&["batch", "plain.toml", "heading.csv", "--quiet", "--layout", "layout.toml"]);
    assert!(String::from_utf8_lossy(&read[0].1).contains("a,0.01"), "{read:?}");
}

#[test]
fn a_text_that_a_spreadsheet_would_compute_is_text() {
    let inputs = Inputs::new();
    let table = "part_id,rack_over_roller\n\"=HYPERLINK(\"\"x\"\")\",25.01\n+1+2,25.01\n@SUM(A1),25.01\n-7,25.01\n";
    inputs.write("f.csv", table);
    let plain = inputs.outputs(&["batch", "plain.toml", "f.csv", "--quiet"]).remove(0).1;
    let safe = inputs.outputs(&["batch", "plain.toml", "f.csv", "--quiet", "--safe-csv"]).remove(0).1;
    let names = |bytes: &[u8]| -> Vec<String> {
        let text = String::from_utf8(bytes.to_vec()).unwrap();
        text.lines().skip(1).map(|line| line.rsplitn(9, ',').last().unwrap_or_default().to_owned()).collect()
    };
    assert_eq!(names(&plain), ["\"=HYPERLINK(\"\"x\"\")\"", "+1+2", "@SUM(A1)", "-7"]);
    assert_eq!(names(&safe), ["\"'=HYPERLINK(\"\"x\"\")\"", "'+1+2", "'@SUM(A1)", "-7"]);
}

/// A spec that is wrong in many places is refused as soon as one that is wrong in few.
#[test]
fn many_problems_are_counted() {
    let inputs = Inputs::new();
    let unknown = (0..2_000).map(|index| format!("k{index} = 1\n")).collect::<Vec<_>>().concat();
    inputs.write("many.toml", &format!("[errors]\n{unknown}"));
    let said = String::from_utf8(inputs.outputs(&["eval", "many.toml"]).remove(1).1).unwrap();
    assert_eq!(said.matches("has no key").count(), 100);
    assert!(said.contains("`k99`") && said.contains("and 1900 more problems"), "{said}");
    inputs.write("large.toml", &format!("#{}\n", "x".repeat(4 << 20)));
    let said = String::from_utf8(inputs.outputs(&["eval", "large.toml"]).remove(1).1).unwrap();
    assert!(said.contains("it is larger than 4 MiB"), "{said}");
    inputs.write("nested.toml", &format!("a{} = 1\n", ".a".repeat(1_000_000)));
    let said = String::from_utf8(inputs.outputs(&["eval", "nested.toml"]).remove(1).1).unwrap();
    assert!(said.contains("would take more than 110 MB of memory"), "{said}");
    let of = |teeth: u32| (0..teeth).map(|tooth| format!("[[rack.deviation]]\nteeth = {tooth}\nlead = 1\n"));
    inputs.write("teeth.toml", &of(1_001).collect::<Vec<_>>().concat());
    let said = String::from_utf8(inputs.outputs(&["eval", "teeth.toml"]).remove(1).1).unwrap();
    assert!(said.contains("1001 of `rack.deviation` are more than 1000"), "{said}");
}
