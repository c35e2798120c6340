"""Parts in Parquet files through polars, lazily.

    python python/examples/polars_lazy.py FOLDER
"""

import sys
from pathlib import Path

import polars
import rackmesh
from parts import SPEC

plan = rackmesh.Plan(rackmesh.Spec.from_toml(SPEC), columns=["verdict"])
files = polars.scan_parquet(Path(sys.argv[1]) / "*.parquet")
judged = files.map_batches(plan.evaluate, schema={"verdict": polars.String, "reason": polars.String})
counts = dict(judged.group_by("verdict").len().collect().iter_rows())
print(", ".join(f"{verdict}: {counts.get(verdict, 0)}" for verdict in ("pass", "fail", None)))
