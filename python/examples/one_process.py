"""What the engines are compared with: one process, and one thread unless told otherwise.

    python python/examples/one_process.py FOLDER [THREADS]
"""

import sys
from collections import Counter
from pathlib import Path

import pyarrow
import pyarrow.compute
import pyarrow.parquet
import rackmesh
from parts import SPEC

threads = int(sys.argv[2]) if len(sys.argv) > 2 else 1
pyarrow.set_cpu_count(threads)
plan = rackmesh.Plan(rackmesh.Spec.from_toml(SPEC), columns=["verdict"], threads=threads)
counts: Counter = Counter()
for file in sorted(Path(sys.argv[1]).glob("*.parquet")):
    judged = plan.evaluate(pyarrow.parquet.read_table(file, use_threads=threads > 1))
    counts.update({count["values"]: count["counts"] for count in pyarrow.compute.value_counts(judged["verdict"]).to_pylist()})
print(", ".join(f"{verdict}: {counts[verdict]}" for verdict in ("pass", "fail", None)))
