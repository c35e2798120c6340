//! A batch gives what `eval` gives, to the last digit and to the limit.

mod uncertain;

use std::fmt::Write as _;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use uncertain::check_uncertain;

use proptest::prelude::*;
use rackmesh::batch::{Batch, Decimals, Layout, Outcome, Packing, Plan, Request, RowSink, Sink, Sinks};
use rackmesh::deviation::Extent;
use rackmesh::evaluation::{evaluate, subject};
use rackmesh::formula::Model;
use rackmesh::judge::{Interval, LimitTarget, Rule, Stack, Verdict};
use rackmesh::quantity::Length;
use rackmesh::spec::Spec;
use rackmesh::table::{Container, Source};
use rackmesh::uncertainty::{Linear, UncertainPart, propagate};

const COLUMNS: [&str; 5] = ["rack_over_roller", "rack_pitch", "rack_lead", "pinion_radial", "pinion_pitch"];

/// Gear data, one limit on two results, and on which teeth each error is.
#[derive(Debug, Clone, Copy)]
struct Case {
    alpha: &'static str,
    helix: &'static str,
    limit: &'static str,
    /// Whether the whole geometry is given.
    is_whole: bool,
    extents: [Option<Extent>; 5],
}

impl Case {
    const fn new(alpha: &'static str, helix: &'static str, limit: &'static str) -> Self {
        Self { alpha, helix, limit, is_whole: false, extents: [None; 5] }
    }

    /// Everything but the errors.
    fn base(&self) -> String {
        let Self { alpha, helix, limit, .. } = self;
        let whole = |keys: &'static str| if self.is_whole { keys } else { "" };
        let (module, addendum) = (whole("normal_module = 2\n"), whole("addendum = 2\n"));
        let pinion = whole("teeth = 12\nprofile_shift = 0.3\ntip_diameter = 29.4\nface_width = 30\n");
        format!(
            "[pair]\nnormal_pressure_angle = {alpha}\n{module}[rack]\nface_width = 19.7\nhelix_angle = {helix}\n{addendum}\
             [pinion]\nhelix_angle = {helix}\n{pinion}[limits]\ncenter_distance = \"±{limit}\"\nrack_lead = {{ upper = {limit} }}\n"
        )
    }

    /// What stands beside the value of an error.
    fn extent(&self, error: usize) -> String {
        self.extents[error].map_or(String::new(), |extent| format!(", extent = \"{}\"", extent.name()))
    }

    /// The spec of a table with these errors.
    fn spec(&self) -> String {
        let entry = |error: usize, nominal: &str| {
            let inside = format!("{nominal}{}", self.extent(error));
            let inside = inside.trim_start_matches(", ");
            if inside.is_empty() { String::new() } else { format!("{} = {{ {inside} }}\n", COLUMNS[error]) }
        };
        let nominals = ["nominal = 25", "", "", "nominal = 8.5", ""];
        let entries: String = nominals.into_iter().enumerate().map(|(error, nominal)| entry(error, nominal)).collect();
        format!("{}[errors]\n{entries}[table.columns]\nrack_pitch = {{ unit = \"um\" }}\n", self.base())
    }
}

fn run(spec: &str, table: &str, request: Request) -> (Vec<String>, Outcome) {
    let (mut rows, outcome) = run_with_header(spec, table, request);
    rows.remove(0);
    (rows, outcome)
}

fn run_with_header(spec: &str, table: &str, request: Request) -> (Vec<String>, Outcome) {
    let spec = Arc::new(Spec::parse("spec.toml", spec).expect("the spec is valid"));
    let want = spec.want();
    let container = Container::open("parts.csv", Source::bytes(table.into()), &want).expect("it is text");
    let table = container.table("parts.csv", &want).expect("there is a header");
    let plan = Plan::new(&spec, &table, request).expect("the plan fits");
    let layout = Layout::new(&plan, &table).expect("the columns are there");
    let mut rows = Vec::new();
    let sink = RowSink::Text(Sink { writer: &mut rows, packing: Packing::None });
    let sinks = Sinks { rows: Some(sink), ..Sinks::default() };
    let mut batch = Batch::new(&plan, sinks, Some(2));
    batch.run(table, &layout, &AtomicBool::new(false), &mut |_| {}).expect("memory is readable");
    let (outcome, _) = batch.finish();
    let rows = String::from_utf8(rows).expect("CSV is text");
    (rows.lines().map(str::to_owned).collect(), outcome)
}

/// The same row by the evaluation of single specs.
fn by_eval(case: &Case, values: &[String; 5], id: &str, decimals: Decimals, model: Model, stack: Stack) -> String {
    let mut text = case.base() + "[errors]\n";
    let _ = writeln!(text, "rack_over_roller = {{ measured = {}, nominal = 25.0{} }}", values[0], case.extent(0));
    let _ = writeln!(text, "rack_pitch = {{ value = \"{} um\"{} }}", values[1], case.extent(1));
    let _ = writeln!(text, "rack_lead = {{ value = {}{} }}", values[2], case.extent(2));
    let _ = writeln!(text, "pinion_radial = {{ measured = {}, nominal = 8.5{} }}", values[3], case.extent(3));
    let _ = writeln!(text, "pinion_pitch = {{ value = {}{} }}", values[4], case.extent(4));
    let spec = Spec::parse("one.toml", &text).expect("the spec is valid");
    let errors = spec.part_deviations().expect("the errors are there");
    let basis = spec.basis().expect("the geometry is valid");
    let evaluation = evaluate(&errors, &spec.limits(), model, stack, &basis).expect("the errors are in their domain");
    let write = |length: Length| match decimals {
        Decimals::Places(places) => length.to_decimal_text(places.into()),
        Decimals::Full => {
            let mm = length.mm();
            if mm != 0.0 && !(1e-7..1e15).contains(&mm.abs()) { format!("{mm:e}") } else { format!("{mm}") }
        }
    };
    let mut row = id.to_owned();
    for contribution in &evaluation.contributions {
        row += &format!(",{}", write(contribution.delta_cd(model)));
    }
    for of in [evaluation.combined.range, evaluation.combined.rss] {
        match of {
            Ok(Interval { lower, upper }) => row += &format!(",{},{}", write(lower), write(upper)),
            Err(_) => row += ",,",
        }
    }
    let judged = || evaluation.limits.iter().filter_map(|check| Some((check, check.result.ok()?)));
    let margins = judged().flat_map(|(check, Interval { lower, upper })| {
        [check.limit.upper.map(|end| end - upper), check.limit.lower.map(|end| lower - end)].into_iter().flatten()
    });
    let margin = margins.min().filter(|_| evaluation.verdict.is_some()).map(write).unwrap_or_default();
    let failed = judged().filter(|(check, _)| check.verdict == Some(Verdict::Fail));
    let failed = failed.map(|(check, result)| {
        let nearest = check.limit.nearest(result).expect("it has ends");
        format!("{} {nearest}", subject(check.on, evaluation.judged_by))
    });
    let why = match evaluation.open_because() {
        Some(why) => format!("not judged: {why}"),
        None => failed.collect::<Vec<_>>().join("; "),
    };
    format!("{row},{margin},{},{why}", evaluation.verdict.map_or("", Verdict::name))
}

fn check(case: &Case, parts: &[[String; 5]], decimals: Decimals, model: Model, stack: Stack) -> Outcome {
    let spec = case.spec();
    let mut table = format!("part_id,{}\n", COLUMNS.join(","));
    for (index, values) in parts.iter().enumerate() {
        let _ = writeln!(table, "P{index},{}", values.join(","));
    }
    let request = Request { decimals, model, stack, ..Request::default() };
    let (rows, outcome) = run(&spec, &table, request);
    assert_eq!(outcome.problems, [], "{table}");
    assert_eq!(rows.len(), parts.len());
    for (index, (row, values)) in rows.iter().zip(parts).enumerate() {
        let id = format!("P{index}");
        assert_eq!(*row, by_eval(case, values, &id, decimals, model, stack), "{case:?} {values:?}");
    }
    outcome
}

#[test]
fn on_ties_and_on_limits() {
    // over-roller and radial errors are exact, so that every half of the last place and every limit is met
    let mut parts = Vec::new();
    for step in 0..200 {
        let zero = || "0".to_owned();
        let (half, sign) = (5 * (step % 40), if step % 3 == 0 { "-" } else { "" });
        parts.push([format!("25.000{half:04}"), zero(), zero(), "8.5".to_owned(), zero()]);
        parts.push([format!("24.99{:03}", step * 5), zero(), zero(), format!("8.50{step:03}"), zero()]);
        // 3/4 µm for each µm at 30°, and 3-4-5
        parts.push([
            format!("25.0{:02}", step % 10 * 4),
            format!("{sign}{}", step % 10 * 40),
            zero(),
            "8.5".to_owned(),
            zero(),
        ]);
    }
    for stack in Stack::ALL {
        for limit in ["0.05", "0.0000125", "0.0300005"] {
            check(&Case::new("30", "30", limit), &parts, Decimals::Places(6), Model::Exact, stack);
        }
    }
    check(&Case::new("45", "0", "0.05"), &parts, Decimals::Places(3), Model::Paper, Stack::Range);
}

/// 40 and 30 µm of either sign are 70 µm at most and 50 µm statistically: limits that they meet, and miss by a nanometre.
#[test]
fn tolerances_on_limits() {
    let extents = [Some(Extent::Each), None, None, Some(Extent::Each), None];
    let parts =
        [["25.04", "0", "0", "8.53", "0"].map(str::to_owned), ["24.97", "0", "0", "8.54", "0"].map(str::to_owned)];
    for (stack, limit, passing) in
        [(Stack::Rss, "0.05", 2), (Stack::Rss, "0.049999", 0), (Stack::Range, "0.07", 2), (Stack::Range, "0.069999", 0)]
    {
        let case = Case { extents, ..Case::new("30", "30", limit) };
        let outcome = check(&case, &parts, Decimals::Full, Model::Exact, stack);
        assert_eq!(outcome.counts.pass, passing, "{stack} {limit}");
    }
}

/// Each row on its own rests on the same bound of the pair as all of them together, in whatever order sizes come.
#[test]
fn with_the_whole_geometry_and_every_extent() {
    let part = |values: [&str; 5]| values.map(str::to_owned);
    let parts = [
        part(["25.013", "12", "0.02", "8.498", "0.009"]),
        part(["24.9991", "-3.5", "-0.004", "8.5", "-0.0021"]),
        part(["25", "0", "0", "8.5", "0"]),
        part(["25.04", "40", "0.1", "8.52", "-0.03"]),
        part(["25.0003", "1", "0", "8.4999", "0.001"]),
        part(["24.96", "-21.25", "0.0333", "8.49", "0.02"]),
    ];
    let whole = |extents| Case { is_whole: true, extents, ..Case::new("20", "12.5", "0.06") };
    let mut verdicts = [0, 0];
    for extent in [None, Some(Extent::One), Some(Extent::Part), Some(Extent::All), Some(Extent::Each)] {
        for stack in Stack::ALL {
            let outcome = check(&whole([extent; 5]), &parts, Decimals::Full, Model::Exact, stack);
            verdicts = [verdicts[0] + outcome.counts.pass, verdicts[1] + outcome.counts.fail];
        }
    }
    assert!(verdicts[0] > 5 && verdicts[1] > 5, "{verdicts:?}");
    let total = Some(Extent::Total);
    check(&whole([None, total, None, None, total]), &parts, Decimals::Full, Model::Paper, Stack::Range);
}

/// Pitches of many teeth have no range where the pair is not known: no number, no verdict.
#[test]
fn without_the_geometry_what_adds_up_is_left_open() {
    let parts = [["25.013", "12", "0.02", "8.498", "0.009"].map(str::to_owned)];
    let case = |extent| Case { extents: [None, Some(extent), None, None, None], ..Case::new("20", "12.5", "0.06") };
    for extent in [Extent::Part, Extent::All, Extent::Each] {
        let outcome = check(&case(extent), &parts, Decimals::Places(6), Model::Exact, Stack::Range);
        assert_eq!((outcome.counts.pass, outcome.counts.fail), (0, 0), "{extent:?}");
    }
    let outcome = check(&case(Extent::One), &parts, Decimals::Places(6), Model::Exact, Stack::Range);
    assert_eq!(outcome.counts.pass, 1);
}

#[test]
fn usual_parts() {
    let parts: Vec<_> = (0..2000i64)
        .map(|n| {
            let value = |factor: i64, range: i64| (n * factor) % (2 * range + 1) - range;
            let decimal = |value: i64, places: i64| {
                let one = 10i64.pow(u32::try_from(places).unwrap());
                let sign = if value < 0 { "-" } else { "" };
                format!(
                    "{sign}{}.{:0width$}",
                    value.abs() / one,
                    value.abs() % one,
                    width = usize::try_from(places).unwrap()
                )
            };
            [
                decimal(250_000 + value(7919, 200), 4),
                decimal(value(104_729, 200), 1),
                decimal(value(15_485_863, 2500), 4),
                decimal(85_000 + value(6151, 200), 4),
                decimal(value(49_979, 200), 4),
            ]
        })
        .collect();
    let outcome = check(&Case::new("20", "12.5", "0.05"), &parts, Decimals::Places(6), Model::Exact, Stack::Range);
    assert!(outcome.counts.fail > 100 && outcome.counts.pass > 100, "{:?}", outcome.counts);
}

/// A number with so many decimals.
fn number(most: i64, places: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = String> {
    (-most..=most, places).prop_map(|(value, places)| decimal(value, places))
}

/// A measured value with so many decimals, no more than a tenth from its nominal value: what is further is not meant.
fn measured(nominal_um: i64, places: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = String> {
    let (least, most) = (nominal_um * 9 / 10, nominal_um * 11 / 10);
    (least..most, 0..1000i64, places).prop_map(|(um, below, places)| {
        let digits = format!("{um}{below:03}000000");
        let (whole, decimals) = digits.split_at(digits.len() - 12);
        format!("{whole}.{}", &decimals[..places])
    })
}

fn decimal(value: i64, places: usize) -> String {
    let one = 10i64.pow(u32::try_from(places).unwrap());
    let sign = if value < 0 { "-" } else { "" };
    if places == 0 {
        return format!("{value}");
    }
    format!("{sign}{}.{:0places$}", value.abs() / one, value.abs() % one)
}

/// What every error may have.
fn extent() -> impl Strategy<Value = Option<Extent>> {
    prop::sample::select(vec![None, Some(Extent::One), Some(Extent::Part), Some(Extent::All), Some(Extent::Each)])
}

fn part() -> impl Strategy<Value = [String; 5]> {
    (
        measured(25_000, 4..=9),
        number(30_000, 0..=3),
        number(40_000_000, 7..=16),
        measured(8_500, 5..=8),
        number(30_000, 4..=12),
    )
        .prop_map(|(a, b, c, d, e)| [a, b, c, d, e])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn on_random_rows(
        parts in prop::collection::vec(part(), 1..12),
        angles in prop::sample::select(vec![("20", "0"), ("19.9", "-21.5"), ("45", "0"), ("30", "30"), ("1", "80")]),
        decimals in prop::sample::select(vec![
            Decimals::Places(0), Decimals::Places(3), Decimals::Places(6), Decimals::Places(9), Decimals::Places(12),
            Decimals::Places(15), Decimals::Places(25), Decimals::Full,
        ]),
        model in prop::sample::select(vec![Model::Exact, Model::Paper]),
        stack in prop::sample::select(Stack::ALL.to_vec()),
        extents in prop::array::uniform5(extent()),
    ) {
        check(&Case { extents, ..Case::new(angles.0, angles.1, "0.05") }, &parts, decimals, model, stack);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3, ..ProptestConfig::default() })]
    #[test]
    fn uncertain_rows(
        parts in prop::collection::vec(part(), 1..6),
        stack in prop::sample::select(Stack::ALL.to_vec()),
        rule in prop::sample::select(vec!["simple", "iso14253", "guard=1.5um"]),
    ) {
        check_uncertain(&parts, stack, rule);
    }
}

/// Gives a chunk of rows at a time, with a pause, as a slow pipe does.
struct Slow {
    chunks: usize,
    at: usize,
}

impl std::io::Read for Slow {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        const ROW: &[u8] = b"25.01\n";
        if self.chunks == 0 {
            return Ok(0);
        }
        self.chunks -= 1;
        std::thread::sleep(std::time::Duration::from_millis(5));
        for byte in &mut *out {
            *byte = ROW[self.at];
            self.at = (self.at + 1) % ROW.len();
        }
        Ok(out.len())
    }
}

#[test]
fn who_watches_is_told_how_far_it_is() {
    use std::io::Read as _;
    let spec =
        Arc::new(Spec::parse("spec.toml", "[errors]\nrack_over_roller = { nominal = 25 }\n").expect("it is valid"));
    for workers in [1, 2] {
        let bytes = std::io::Cursor::new(b"rack_over_roller\n".to_vec()).chain(Slow { chunks: 150, at: 0 });
        let container =
            Container::open("parts.csv", Source::Stream(Box::new(bytes)), &spec.want()).expect("it is text");
        let table = container.table("parts.csv", &spec.want()).expect("there is a header");
        let plan = Plan::new(&spec, &table, Request::default()).expect("the plan fits");
        let layout = Layout::new(&plan, &table).expect("the columns are there");
        let mut batch = Batch::new(&plan, Sinks::default(), Some(workers));
        let mut told = Vec::new();
        batch
            .run(table, &layout, &AtomicBool::new(false), &mut |progress| told.push(progress.rows))
            .expect("it is read");
        assert!(told.len() >= 2 && told.is_sorted(), "{workers}: {told:?}");
        let rows = batch.finish().0.counts.rows;
        assert!(told.iter().all(|told| *told <= rows));
    }
}

#[test]
fn only_what_is_asked_for_is_read_and_computed() {
    let spec = "[pair]\nnormal_pressure_angle = 20\n[table]\nignore = [\"note\"]\n";
    let table = "part_id,rack_over_roller,rack_pitch,note\nP1,25.01,0.01,a\nP2,25.02,0.02,b\n";
    let columns = |names: &[&str]| Some(names.iter().map(|name| (*name).to_owned()).collect());
    let request = Request { columns: columns(&["part_id", "delta_cd_rack_pitch_mm", "note"]), ..Request::default() };
    let (rows, outcome) = run(spec, table, request);
    assert_eq!(rows, ["P1,0.013737,a", "P2,0.027475,b"]);
    assert_eq!(outcome.problems, []);
    // the face width is not needed either: nobody asked about the lead
    let table = "part_id,rack_lead,rack_pitch\nP1,0.1,0.01\n";
    let request = Request { columns: columns(&["delta_cd_rack_pitch_mm"]), ..Request::default() };
    assert_eq!(run(spec, table, request).0, ["0.013737"]);
}
