//! Pages and pictures as a reader sees them: the verdict first, and every text whole.

use crate::process::{Folder, run};

/// Every page has its verdict at the top, that of its exit status; one that decides nothing is not signed.
#[test]
fn every_page_begins_with_its_verdict() {
    let failing = "FAIL</b>free pinion torque: 0.4301 … 1.2867 N m leaves the limit by 0.1699 N m (0.6 … 1.3 N m; over the travel -10 … 60 mm); \
                   fluctuation of the pinion torque";
    for (line, code, begins) in [
        ("examples/function.toml", 1, failing),
        ("examples/everything.toml", 1, "FAIL</b>ΔCD (worst case): "),
        ("examples/mesh-errors.toml", 0, "PASS</b>the limit on ΔCD is met"),
        ("examples/yoke.toml", 0, "NO VERDICT</b>there is no limit"),
        (
            "examples/scatter.toml --contributions --to 5",
            2,
            "NO VERDICT</b>no limit is judged here: `rackmesh monte-carlo` ",
        ),
        ("examples/batch.toml examples/parts.csv", 2, "FAIL</b>2 of 23 parts are outside a limit"),
    ] {
        let page = run(&["report"].into_iter().chain(line.split(' ')).collect::<Vec<_>>(), "");
        assert_eq!(page.code, Some(code), "{line}: {}", page.stderr);
        let (top, below) = page.stdout.split_once("<section").expect("a section");
        let verdicts: Vec<_> = top.split("<p class=\"verdict ").skip(1).collect();
        assert!(verdicts.first().is_some_and(|first| first.contains(begins)), "{line}: {verdicts:?}");
        assert!(!below.contains("class=\"verdict"), "{line}");
        assert_eq!(top.contains("class=\"sign\""), !begins.starts_with("NO VERDICT"), "{line}");
    }
    let lot = run(&["report", "examples/batch.toml", "examples/parts.csv"], "").stdout;
    let title = std::fs::read_to_string("examples/batch.toml").unwrap();
    let title = title.lines().find_map(|line| line.strip_prefix("title = \"")?.strip_suffix('"')).unwrap();
    assert!(lot.contains(&format!("<dt>spec</dt><dd>{title} (examples/batch.toml)</dd>")), "{title}");
}

/// Each error stands with what was measured of it, or as the spec's.
#[test]
fn a_page_of_a_part_says_what_was_measured() {
    let line = "report examples/steering.toml examples/cmm-report.txt --layout examples/cmm-layout.toml";
    let page = run(&line.split(' ').collect::<Vec<_>>(), "").stdout;
    for (error, measured) in [
        ("<span class=\"w\">over-roller</span>", "25.0110 mm"),
        ("rack pitch", "+14.5 µm"),
        ("pinion radial", "not, from the spec"),
    ] {
        assert!(page.contains(&format!("{error}</th><td class=\"n\">{measured}</td>")), "{error}: {page}");
    }
}

/// The part that a page shows in detail is evaluated as its table is: with the extents of the columns.
#[test]
fn a_part_in_detail_has_the_range_of_its_row() {
    let folder = Folder::new("page-of-extents");
    let [spec, table] = ["spec.toml", "lot.csv"].map(|name| folder.path(name));
    let pair = std::fs::read_to_string("examples/steering.toml").unwrap();
    let pair = pair.split_once("[errors]").unwrap().0.to_owned();
    let rest =
        "[limits]\ncenter_distance = \"±0.04\"\n[table.columns]\nrack_pitch = { unit = \"um\", extent = \"each\" }\n";
    std::fs::write(&spec, pair + rest).unwrap();
    std::fs::write(&table, "part_id,rack_pitch\nP1,12\nP2,1\n").unwrap();
    let rows = run(&["batch", &spec, &table, "--columns", "range_upper_mm"], "").stdout;
    let upper: f64 = rows.lines().nth(1).and_then(|row| row.rsplit(',').next()).unwrap().parse().unwrap();
    let page = run(&["report", &spec, &table], "").stdout;
    let detail = page.split_once("by formula: part P1").unwrap().1.split_once("</section>").unwrap().0;
    assert!(upper > 0.02 && detail.contains(&format!("0.0000 … {upper:+.4}")), "{rows}: {detail}");
}

/// The value of an attribute.
fn attribute<'t>(tag: &'t str, name: &str) -> Option<&'t str> {
    tag.split_once(&format!(" {name}=\""))?.1.split('"').next()
}

/// The texts of pictures that leave them sideways, by 0.62 of their size for each character.
fn leaving(pictures: &str) -> Vec<String> {
    let (mut width, mut sizes, mut found) = (0.0, vec![14.0], Vec::new());
    let number = |tag: &str, name: &str| attribute(tag, name).and_then(|text| text.parse::<f64>().ok());
    for tag in pictures.split('<') {
        let (tag, text) = tag.split_once('>').unwrap_or((tag, ""));
        match tag.split(' ').next() {
            Some("svg") => width = number(tag, "width").unwrap_or(width),
            Some("g") => sizes.push(number(tag, "font-size").unwrap_or(14.0)),
            Some("/g") => _ = sizes.pop(),
            Some("text") => {
                let text = text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
                let length = 0.62 * sizes.last().unwrap_or(&14.0) * text.chars().count() as f64;
                let share =
                    ["start", "middle", "end"].iter().position(|anchor| attribute(tag, "text-anchor") == Some(anchor));
                let left = number(tag, "x").unwrap() - 0.5 * share.unwrap() as f64 * length;
                if left < 0.0 || left + length > width {
                    found.push(format!("{text}: {left:.0} … {:.0} of {width}", left + length));
                }
            }
            _ => {}
        }
    }
    found
}

#[test]
fn no_text_leaves_a_picture() {
    let folder = Folder::new("whole-texts");
    let drawn = folder.path("drawn.svg");
    for line in [
        "eval examples/steering.toml --plot",
        "eval examples/mesh-errors.toml --plot",
        "eval examples/everything.toml --plot",
        "eval examples/minimal.toml --plot",
        "mesh examples/mesh-errors.toml --to 20 --plot",
        "mesh examples/function.toml --plot-of torque --plot",
        "budget examples/budget.toml --plot",
        "monte-carlo examples/scatter.toml --racks 20 --to 5 --plot",
        "monte-carlo examples/scatter.toml --racks 20 --to 5 --contributions --plot",
        "sweep examples/mesh-errors.toml --over errors.rack_pitch=1..3:1um --over errors.rack_lead=1..3:1arcmin --plot",
        "compare examples/steering.toml examples/mesh-errors.toml --plot",
    ] {
        let words: Vec<_> = line.split(' ').chain([drawn.as_str()]).collect();
        let ended = run(&words, "");
        let picture = std::fs::read_to_string(&drawn).unwrap_or_else(|_| panic!("{line}: {}", ended.stderr));
        assert!(picture.contains("<text "), "{line}");
        assert_eq!(leaving(&picture), Vec::<String>::new(), "{line}");
        std::fs::remove_file(&drawn).unwrap();
    }
    for line in ["report examples/function.toml", "report examples/batch.toml examples/parts.csv"] {
        let page = run(&line.split(' ').collect::<Vec<_>>(), "");
        assert_eq!(leaving(&page.stdout), Vec::<String>::new(), "{line}");
    }
    // the check sees what is cut
    assert_eq!(leaving("<svg width=\"100\"><text x=\"90\" text-anchor=\"start\">cut</text>").len(), 1);
}

/// What columns say about all parts stands above the verdict, of parts by their teeth too, and is not called left out.
#[test]
fn details_of_parts_with_teeth_stand_in_the_head() {
    let folder = Folder::new("pages-details");
    let (spec, table) = (folder.path("spec.toml"), folder.path("spaces.csv"));
    let pair = "[pair]\nnormal_module = 2\nnormal_pressure_angle = 19.9\n[rack]\nface_width = 19.7\naddendum = 1.7\n[pinion]\nteeth = 8\n\
        helix_angle = 21\nprofile_shift = 0.3\nface_width = 30\ntip_diameter = 19.738\n[limits]\ncenter_distance = \"±0.1\"\n";
    let columns = "[table.columns]\ninspector = \"Prüfer\"\ndate = \"Datum\"\n";
    std::fs::write(&spec, format!("{pair}{columns}")).unwrap();
    let row = |space| format!("{space};0;0;{};3.11.2026\n", if space < 9 { "Frey" } else { "Roth" });
    let rows: String = (0..12).map(row).collect();
    std::fs::write(&table, format!("space;over_pin_deviation [um];position_deviation [um];Prüfer;Datum\n{rows}"))
        .unwrap();
    let page = run(&["report", &spec, &table, "--teeth"], "");
    assert!(page.stdout.contains("<dt>inspector</dt><dd>Frey, Roth</dd>"), "{}{}", page.stdout, page.stderr);
    assert!(page.stdout.contains("<dt>date</dt><dd>3.11.2026</dd>"), "{}", page.stdout);
    assert!(page.stderr.contains("\"Prüfer\" = inspector") && !page.stderr.contains("left out"), "{}", page.stderr);
}

/// What scatters is not judged by the worst case, and both the page and `eval` say so.
#[test]
fn scatter_beside_errors_is_said_not_to_be_judged() {
    let folder = Folder::new("pages-scatter");
    let spec = folder.path("spec.toml");
    let scatter = std::fs::read_to_string("examples/scatter.toml").unwrap();
    let errors = "\n[errors]\nrack_over_roller = \"+4 um\"\n";
    std::fs::write(&spec, format!("{scatter}{errors}")).unwrap();
    for command in ["eval", "report"] {
        let said = run(&[command, &spec], "").stdout;
        assert!(said.contains("[scatter] is not judged here: `rackmesh monte-carlo` "), "{said}");
    }
    let shares = run(&["report", &spec, "--contributions", "--to", "5"], "").stdout;
    assert!(shares.contains(" of 4000 random racks stay within the limits along the stroke: "), "{shares}");
}
