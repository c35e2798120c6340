"""Parts in Parquet files through polars, lazily.

    python python/examples/polars_lazy.py FOLDER [THREADS]
"""

import sys
from pathlib import Path

import polars
import rackmesh
from parts import SPEC

threads = int(sys.argv[2]) if len(sys.argv) > 2 else 1
plan = rackmesh.Plan(rackmesh.Spec.from_toml(SPEC), columns=["verdict"], threads=threads)
files = polars.scan_parquet(Path(sys.argv[1]) / "*.parquet")
judged = files.map_batches(plan.evaluate, schema={"verdict": polars.String, "reason": polars.String})
counts = dict(judged.group_by("verdict").len().collect().iter_rows())
print(", ".join(f"{verdict}: {counts.get(verdict, 0)}" for verdict in ("pass", "fail", None)))
