#!/usr/bin/env python3
"""The same batch in rackmesh, polars and DuckDB: do the answers agree, and what does each cost?

    cargo build --release && python3 benches/peers/batch.py [ROWS]

Needs Linux, and polars and duckdb for the peers that are to be compared (a peer that is not installed is left out).
Each job reads a table of six columns and writes nine; a second one only sums up. CPU time and peak memory are those
of the whole process, median of three runs in turn.
"""
import csv
import importlib
import importlib.util
import math
import os
import subprocess
import sys
import tempfile
import textwrap
import time

ROWS = int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000
RACKMESH = os.path.join(os.path.dirname(__file__), "..", "..", "target", "release", "rackmesh")
COLUMNS = ["part_id"] + [f"delta_cd_{name}_mm" for name in
           ("rack_over_roller", "rack_pitch", "rack_lead", "pinion_radial", "pinion_pitch")] + \
          ["range_lower_mm", "range_upper_mm", "verdict"]
SPEC = """
[pair]
normal_pressure_angle = 20
[rack]
face_width = 19.8
[errors]
rack_over_roller = { nominal = 25.0 }
pinion_radial = { nominal = 8.5 }
[limits]
center_distance = "±0.15"
[table.columns]
rack_over_roller = { name = "over_roller", unit = "mm" }
rack_pitch = { name = "dp", unit = "mm" }
rack_lead = { name = "dbeta", unit = "deg" }
pinion_radial = { name = "radial", unit = "mm" }
pinion_pitch = { name = "dfp", unit = "mm" }
"""
TWICE_TAN = 2 * math.tan(math.radians(20))
POLARS = f"""
import sys, polars as pl
mode, source, target = sys.argv[1:]
c = pl.col
parts = pl.scan_csv(source).select("part_id", d1=c("over_roller") - 25, d2=c("dp").abs() / {TWICE_TAN!r},
    d3=(19.8 * c("dbeta").radians().sin() / {TWICE_TAN!r}).abs(), d4=c("radial") - 8.5, d5=c("dfp").abs() / {TWICE_TAN!r},
    cos=c("dbeta").radians().cos())
parts = parts.with_columns(way=c("d2") + c("d3") / c("cos") + 4.95 * (1 / c("cos") - 1) + c("d5"))
parts = parts.select("part_id", "d1", "d2", "d3", "d4", "d5", lower=c("d1") + c("d4").clip(upper_bound=0) - c("way"),
    upper=c("d1") + c("d4").clip(lower_bound=0) + c("way"))
inside = (c("lower") >= -0.15) & (c("upper") <= 0.15)
if mode == "summary":
    w = c("upper")
    row = parts.select(pl.len(), (~inside).sum().alias("fail"), w.min().alias("min"), w.mean().alias("mean"),
        w.max().alias("max"), w.std().alias("s"), w.quantile(0.5).alias("median")).collect(engine="streaming").row(0)
    open(target, "w").write(" ".join(map(str, row)))
else:
    parts = parts.with_columns(verdict=pl.when(inside).then(pl.lit("pass")).otherwise(pl.lit("fail")))
    parts.sink_csv(target, float_precision=6)
"""
DUCKDB = f"""
import sys, duckdb
mode, source, target = sys.argv[1:]
columns = "{{'part_id':'VARCHAR','over_roller':'DOUBLE','dp':'DOUBLE','dbeta':'DOUBLE','radial':'DOUBLE','dfp':'DOUBLE'}}"
parts = f'''with a as (select part_id, over_roller-25 d1, abs(dp)/{TWICE_TAN!r} d2, abs(19.8::double*sin(radians(dbeta))/{TWICE_TAN!r}) d3,
  radial-8.5 d4, abs(dfp)/{TWICE_TAN!r} d5, cos(radians(dbeta)) c from read_csv('{{source}}', header=true, columns={{columns}})),
  w as (select *, d2+d3/c+4.95::double*(1/c-1)+d5 way from a),
  b as (select *, d1+least(d4,0)-way lower, d1+greatest(d4,0)+way upper from w)'''
inside = "lower>=-0.15::double and upper<=0.15::double"
con = duckdb.connect()
con.execute("set preserve_insertion_order=true")
if mode == "summary":
    row = con.execute(parts + f" select count(*), count(*) filter (not ({{inside}})), min(upper), avg(upper), max(upper), "
        "stddev_samp(upper), quantile_cont(upper, 0.5) from b").fetchone()
    open(target, "w").write(" ".join(map(str, row)))
else:
    numbers = ",".join(f"printf('%.6f',{{x}}) {{x}}" for x in "d1 d2 d3 d4 d5 lower upper".split())
    con.execute(f"copy ({{parts}} select part_id,{{numbers}},case when {{inside}} then 'pass' else 'fail' end verdict "
        f"from b) to '{{target}}' (header, delimiter ',')")
"""


def generate(path):
    """Deterministic random parts (splitmix64)."""
    state, mask = 20261121, (1 << 64) - 1

    def random(most):
        nonlocal state
        state = (state + 0x9E3779B97F4A7C15) & mask
        z = state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        return ((z ^ (z >> 31)) % (2 * most + 1)) - most

    with open(path, "w") as out:
        out.write("part_id,over_roller,dp,dbeta,radial,dfp\n")
        for part in range(1, ROWS + 1):
            values = 250000 + random(200), random(200), random(2500), 85000 + random(200), random(200)
            cells = ["%s%d.%04d" % ("-" if v < 0 else "", abs(v) // 10000, abs(v) % 10000) for v in values]
            out.write("P%07d,%s\n" % (part, ",".join(cells)))


def cost(command):
    """CPU seconds, seconds, peak MiB."""
    start = time.perf_counter()
    with tempfile.TemporaryFile() as messages:
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=messages)
        peak, ended = 0, 0
        # what the system reports at the end includes the Python that it was forked from
        while not ended:
            try:
                text = open(f"/proc/{child.pid}/status").read()
                peak = max(peak, *(int(line.split()[1]) for line in text.splitlines() if line.startswith("VmHWM")), 0)
            except OSError:
                pass
            time.sleep(0.005)
            ended, status, usage = os.wait4(child.pid, os.WNOHANG)
        messages.seek(0)
        errors = messages.read()
    # parts outside the limit are status 1 of rackmesh, and an exception is that of Python
    if os.waitstatus_to_exitcode(status) != (1 if command[0] == RACKMESH else 0):
        sys.exit(f"{command}: {errors.decode()}")
    return usage.ru_utime + usage.ru_stime, time.perf_counter() - start, peak / 1024


def agree(ours, theirs, name):
    """Every number within one unit of its last digit (the peers round binary numbers), every verdict the same."""
    rows = different = 0
    with open(ours) as a, open(theirs) as b:
        for mine, other in zip(csv.reader(a), csv.reader(b), strict=True):
            rows += 1
            if rows == 1:
                continue
            same = mine[0] == other[0] and mine[-1] == other[-1]
            gaps = [abs(float(x) - float(y)) for x, y in zip(mine[1:-1], other[1:-1], strict=True)]
            if not same or max(gaps) > 1.0001e-6:
                sys.exit(f"{name} disagrees in row {rows}: {mine} {other}")
            different += any(gap > 1e-9 for gap in gaps)
    print(f"{name}: {rows - 1} rows agree; in {different} a last digit differs, because a binary number was rounded")


def agree_summary(ours, theirs, name):
    """Counts the same, numbers to 1e-9 mm, the median to 0.05 % of its value, which is what rackmesh promises of it."""
    for index, (key, mine) in enumerate(ours.items()):
        other = float(theirs[index])
        within = {"count": 0, "fail": 0, "q0.5_mm": 0.0005 * abs(other) + 1e-9}.get(key, 1e-9)
        if not abs(float(mine) - other) <= within:
            sys.exit(f"{name} disagrees in the summary: {key} {mine} {other}")
    print(f"{name}: count, fail, min, mean, max, s and median of the upper end agree")


def versions():
    """What was measured, and on what."""
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "?")
    peers = [f"{name} {importlib.import_module(name).__version__}" for name in ("polars", "duckdb")
             if importlib.util.find_spec(name)]
    rackmesh = subprocess.run([RACKMESH, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    print(f"{cpu}, {os.cpu_count()} threads; Python {sys.version.split()[0]}, {rackmesh}, {', '.join(peers)}")


def main():
    versions()
    with tempfile.TemporaryDirectory() as folder:
        at = lambda name: os.path.join(folder, name)
        generate(at("parts.csv"))
        open(at("spec.toml"), "w").write(SPEC)
        ours = [RACKMESH, "batch", at("spec.toml"), at("parts.csv")]
        jobs = {"rackmesh": {
            "rows": ours + ["-o", at("rackmesh.csv"), "--columns", ",".join(COLUMNS)],
            "summary": ours + ["--summary", "--format", "csv", "-o", at("rackmesh.summary.csv")],
        }}
        for name, program in (("polars", POLARS), ("duckdb", DUCKDB)):
            if importlib.util.find_spec(name) is None:
                print(f"{name} is not installed")
                continue
            open(at(f"run_{name}.py"), "w").write(textwrap.dedent(program))
            jobs[name] = {mode: [sys.executable, at(f"run_{name}.py"), mode, at("parts.csv"), at(f"{name}.{end}")]
                          for mode, end in (("rows", "csv"), ("summary", "txt"))}
        costs = {(name, mode): [] for name in jobs for mode in ("rows", "summary")}
        for _ in range(3):
            for name, mode in costs:
                costs[name, mode].append(cost(jobs[name][mode]))
        keys = "count fail min_mm mean_mm max_mm standard_deviation_mm q0.5_mm".split()
        rows = csv.DictReader(open(at("rackmesh.summary.csv")))
        summary = next({key: row[key] for key in keys} for row in rows if row["name"] == "range_upper_mm")
        for name in jobs:
            if name != "rackmesh":
                agree(at("rackmesh.csv"), at(name + ".csv"), name)
                agree_summary(summary, open(at(name + ".txt")).read().split(), name)
        print(f"\n{ROWS} rows          CPU s    wall s   peak MiB   CPU, times rackmesh")
        for mode in ("rows", "summary"):
            for name in jobs:
                cpu, wall, peak = sorted(costs[name, mode])[1]
                ratio = cpu / sorted(costs["rackmesh", mode])[1][0]
                print(f"{mode:8} {name:9} {cpu:8.2f} {wall:9.2f} {peak:10.1f} {ratio:12.1f}")


main()
