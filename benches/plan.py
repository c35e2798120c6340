#!/usr/bin/env python3
"""What judging a row costs in Python, and from Parquet to Parquet: nanoseconds of CPU time.

    pip install ./python numpy pyarrow
    python benches/plan.py [ROWS]

`Plan.evaluate` takes one record batch of doubles on one thread, without names and leads and with both; `rackmesh batch` takes
the same rows from a Parquet file to another one, also on one thread. Of five runs the fastest counts; what a table of 1,000 rows
takes is taken off the command.
"""
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy
import pyarrow
import pyarrow.parquet
import rackmesh

ROWS = int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000
RUNS = 5
SPEC = """[pair]
normal_pressure_angle = 20
[rack]
face_width = 19.8
[limits]
center_distance = "±0.15"
[errors]
rack_over_roller = { nominal = 25.0 }
pinion_radial = { nominal = 8.5 }
"""


def table(rows: int, columns: list) -> pyarrow.Table:
    """Random parts, with the four decimals of a measuring machine."""
    random = numpy.random.default_rng(20_261_121)
    middles = {"rack_over_roller": 25.0, "pinion_radial": 8.5}
    spreads = {"rack_lead": 0.25}
    arrays = {name: (middles.get(name, 0.0) + random.uniform(-1, 1, rows) * spreads.get(name, 0.02)).round(4) for name in columns}
    names = {"part_id": [f"P{row:07}" for row in range(rows)]} if "rack_lead" in columns else {}
    return pyarrow.table({**names, **arrays})


def children() -> float:
    """CPU time of all children so far, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def cost(run, clock) -> float:
    times = []
    for _ in range(RUNS):
        start = clock()
        run()
        times.append(clock() - start)
    return min(times)


four = ["rack_over_roller", "rack_pitch", "pinion_radial", "pinion_pitch"]
for what, columns in (("four doubles", four), ("with a lead and a name", [*four, "rack_lead"])):
    [batch] = table(ROWS, columns).combine_chunks().to_batches()
    plan = rackmesh.Plan(rackmesh.Spec.from_toml(SPEC))
    seconds = cost(lambda: plan.evaluate(batch), time.process_time)
    print(f"Plan.evaluate, {what}: {1e9 * seconds / ROWS:.0f} ns a row")

with tempfile.TemporaryDirectory() as folder:
    spec, out = Path(folder) / "rack.toml", Path(folder) / "out.parquet"
    spec.write_text(SPEC)
    times = {}
    for rows in (1_000, ROWS):
        parts = Path(folder) / f"{rows}.parquet"
        pyarrow.parquet.write_table(table(rows, [*four, "rack_lead"]), parts)
        program = os.environ.get("RACKMESH", "rackmesh")
        command = [program, "batch", spec, parts, "-o", out, "--threads", "1", "--quiet"]
        times[rows] = cost(lambda: subprocess.run(command, check=False), children)
    print(f"Parquet to Parquet: {1e9 * (times[ROWS] - times[1_000]) / (ROWS - 1_000):.0f} ns a row")
