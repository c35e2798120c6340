use std::fs;

use super::*;
use crate::batch::Packing;

const NONE: [&str; 0] = [];

/// A folder of its own for one test, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("rackmesh-target-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn path(&self, file: &str) -> String {
        self.0.join(file).to_str().unwrap().to_owned()
    }

    /// A file of this folder that holds its own name.
    fn with(&self, file: &str) -> String {
        fs::write(self.path(file), file).unwrap();
        self.path(file)
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn text(path: &str) -> String {
    fs::read_to_string(path).unwrap()
}

fn message(failure: &Failure) -> String {
    match failure {
        Failure::Diagnostics(diagnostics) => crate::diagnostic::render(&diagnostics[0], false, None),
        other => format!("{other:?}"),
    }
}

fn refusal(path: &str, input: &str) -> String {
    Target::create(path, &["other", input]).err().map_or_else(String::new, |failure| message(&failure))
}

#[test]
fn a_file_that_is_read_is_not_written_by_any_name() {
    let folder = Folder::new("same");
    let input = folder.with("parts.csv");
    fs::create_dir(folder.path("inner")).unwrap();
    for name in ["parts.csv", "./parts.csv", "inner/../parts.csv"] {
        let refused = refusal(&folder.path(name), &input);
        assert!(refused.contains("would be written over"), "{name}: {refused}");
        assert!(refused.contains("another name"), "{name}: {refused}");
    }
    assert_eq!(refusal(&folder.path("results.csv"), &input), "");
    assert_eq!(text(&input), "parts.csv");
    assert_eq!(folder.names(), ["inner", "parts.csv"]);
}

#[test]
#[cfg(unix)]
fn links_are_names_too() {
    let folder = Folder::new("links");
    let input = folder.with("parts.csv");
    let (hard, soft, second) = (folder.path("hard.csv"), folder.path("soft.csv"), folder.path("second.csv"));
    fs::hard_link(&input, &hard).unwrap();
    std::os::unix::fs::symlink("parts.csv", &soft).unwrap();
    std::os::unix::fs::symlink("soft.csv", &second).unwrap();
    for name in [&hard, &soft, &second] {
        assert!(refusal(name, &input).contains("would be written over"), "{name}");
        assert!(refusal(&input, name).contains("would be written over"), "{name}");
    }
}

#[test]
fn two_files_to_be_written_are_two() {
    let folder = Folder::new("two");
    let (a, b, again) = (folder.path("a.csv"), folder.path("b.csv"), folder.path("./a.csv"));
    assert!(refuse_same(&[a.as_ref(), b.as_ref()]).is_ok());
    // before there is a file, and after
    for _ in 0..2 {
        let refused = message(&refuse_same(&[a.as_ref(), b.as_ref(), again.as_ref()]).unwrap_err());
        assert!(refused.contains("a.csv are the same file"), "{refused}");
        folder.with("a.csv");
    }
    #[cfg(unix)]
    assert!(refuse_same(&["/dev/null".as_ref(); 2]).is_ok());
}

#[test]
fn the_old_file_stays_until_the_other_is_complete() {
    let folder = Folder::new("old");
    let path = folder.with("results.csv");
    let mut target = Target::create(&path, &NONE).unwrap();
    target.write_all(b"whole").unwrap();
    assert_eq!((text(&path).as_str(), folder.names().len()), ("results.csv", 2));
    target.finish().unwrap();
    assert_eq!((text(&path).as_str(), folder.names().len()), ("whole", 1));
    // and where there is none, none comes to be
    drop(Target::create(folder.path("none.csv"), &NONE).unwrap());
    assert_eq!(folder.names(), ["results.csv"]);
}

#[test]
fn a_file_that_is_new_replaces_none() {
    let folder = Folder::new("new");
    let (old, new) = (folder.with("old.toml"), folder.path("new.toml"));
    for (path, is_written) in [(&old, false), (&new, true)] {
        let mut target = Target::create(path, &NONE).unwrap();
        target.write_all(b"new").unwrap();
        assert_eq!(target.finish_new().is_ok(), is_written, "{path}");
    }
    assert_eq!((text(&old).as_str(), text(&new).as_str()), ("old.toml", "new"));
    assert_eq!(folder.names(), ["new.toml", "old.toml"]);
}

#[test]
fn what_was_computed_is_kept_under_a_name_of_its_own() {
    let folder = Folder::new("partial");
    let path = folder.with("results.csv");
    let partial = |inputs: &[&str], bytes: &[u8]| {
        let mut target = Target::create(&path, inputs).unwrap();
        target.write_all(bytes).unwrap();
    };
    partial(&[], b"");
    assert_eq!(folder.names(), ["results.csv"]);
    let kept = folder.path("results.csv.partial");
    partial(&[], b"half");
    assert_eq!((text(&path).as_str(), text(&kept).as_str()), ("results.csv", "half"));
    partial(&[], b"more");
    partial(&[&kept], b"other");
    assert_eq!(text(&kept), "more");
    assert_eq!(folder.names(), ["results.csv", "results.csv.partial", "results.csv.partial-2"]);
    // a place that cannot be written is told
    let path = folder.with("rows.csv");
    std::fs::create_dir(folder.path("rows.csv.partial")).unwrap();
    let mut target = Target::create(&path, &NONE).unwrap();
    target.write_all(b"half").unwrap();
    drop(target);
    assert!(said().iter().any(|line| line.contains("rows.csv.partial: ")), "what is lost is told");
}

#[test]
fn a_report_that_is_not_completed_takes_the_place_of_an_older_one_alone() {
    let folder = Folder::new("reports");
    let report = |file: &str, old: Option<&str>| {
        let path = folder.path(file);
        if let Some(old) = old {
            fs::write(&path, old).unwrap();
        }
        let unless_complete = UnlessComplete::Report(|why| format!("<testsuites/>{why}"));
        drop(Target::with(&path, &NONE, unless_complete).unwrap());
        super::end_reports("no spec");
        text(&path)
    };
    for (file, old) in [("none.xml", None), ("empty.xml", Some("")), ("old.xml", Some("<?xml?>\n<testsuites>"))] {
        assert!(report(file, old).starts_with("<testsuites/>no spec"), "{file}");
    }
    assert_eq!(report("parts.csv", Some("part_id\n")), "part_id\n");
    assert_eq!(folder.names(), ["empty.xml", "none.xml", "old.xml", "parts.csv"]);
}

#[test]
fn what_a_killed_process_leaves_is_removed_by_the_next_for_the_same_place() {
    let folder = Folder::new("left");
    let (left, others) = (".results.csv.123-AbCdEf.part", [".other.csv.123-AbCdEf.part", ".results.csv.mine-x.part"]);
    others.iter().chain([&left]).for_each(|name| {
        folder.with(name);
    });
    let path = folder.path("results.csv");
    let (first, second) = (Target::create(&path, &NONE).unwrap(), Target::create(&path, &NONE).unwrap());
    // both of this process are locked, and stay
    assert_eq!(folder.names().len(), 4);
    assert!(!folder.names().contains(&left.to_owned()));
    second.write_whole(b"second").unwrap();
    first.write_whole(b"first").unwrap();
    assert_eq!(text(&path), "first");
    assert_eq!(folder.names(), [others[0], others[1], "results.csv"]);
}

#[test]
#[cfg(unix)]
fn permissions_and_links_stay() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = Folder::new("permissions");
    let (path, link, dangling) = (folder.with("results.csv"), folder.path("link.csv"), folder.path("dangling.csv"));
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    std::os::unix::fs::symlink("results.csv", &link).unwrap();
    std::os::unix::fs::symlink("later.csv", &dangling).unwrap();
    write(&link, &NONE, b"through the link").unwrap();
    write(&dangling, &NONE, b"later").unwrap();
    assert_eq!(text(&path), "through the link");
    assert_eq!(text(&folder.path("later.csv")), "later");
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    assert!([link, dangling].iter().all(|link| fs::symlink_metadata(link).unwrap().is_symlink()));
}

#[test]
fn what_cannot_be_written_says_why() {
    let folder = Folder::new("unwritable");
    for path in [folder.path(""), folder.path("none/a.csv"), folder.path("none/")] {
        let failure = write(&path, &NONE, b"x").unwrap_err();
        assert!(message(&failure).contains("cannot write"), "{path}");
    }
    assert!(folder.names().is_empty());
}

#[test]
#[cfg(target_os = "linux")]
fn devices_are_written_as_they_are() {
    write("/dev/null", &["/dev/null"], b"x").unwrap();
    assert!(write("/dev/full", &NONE, b"x").is_err_and(|failure| format!("{failure:?}").contains("/dev/full")));
}

#[test]
fn endings_are_those_that_are_known() {
    let known = ["csv", "svg"];
    for (path, ending) in [("a.csv", "csv"), ("b.c/A.SVG", "svg")] {
        assert_eq!(known_ending(path, path, &known).unwrap(), Some(ending), "{path}");
    }
    for path in ["a.pdf", "a", "csv", ".csv", "a.csv.gz", ""] {
        let refused = message(&known_ending(path, path, &known).unwrap_err().into());
        assert!(refused.contains("it ends in .csv or .svg"), "{path}: {refused}");
    }
    for path in ["a.csv.gz", "a.csv.ZST", "a.csv"] {
        assert_eq!(known_ending(path, Packing::of_name(path).1, &known).unwrap(), Some("csv"), "{path}");
    }
    for path in ["a.gz", "a.pdf.gz", "a.csv.zip", "ü.gz"] {
        assert!(known_ending(path, Packing::of_name(path).1, &known).is_err(), "{path}");
    }
    assert_eq!(known_ending("-", "-", &known).unwrap(), None);
    #[cfg(unix)]
    assert_eq!(known_ending("/dev/null", "/dev/null", &known).unwrap(), None);
}
