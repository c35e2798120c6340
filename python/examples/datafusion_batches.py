"""Parts in Parquet files through DataFusion: its record batches, one after the other.

    python python/examples/datafusion_batches.py FOLDER
"""

import sys
from collections import Counter

import rackmesh
from datafusion import SessionContext
from parts import SPEC

plan = rackmesh.Plan(rackmesh.Spec.from_toml(SPEC), columns=["verdict"])
counts: Counter = Counter()
for batch in SessionContext().read_parquet(sys.argv[1]).execute_stream():
    counts.update(plan.evaluate(batch.to_pyarrow())["verdict"].to_pylist())
print(", ".join(f"{verdict}: {counts[verdict]}" for verdict in ("pass", "fail", None)))
