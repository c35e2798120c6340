"""What the engines are compared with: one process, one thread.

    python python/examples/one_process.py FOLDER
"""

import sys
from collections import Counter
from pathlib import Path

import pyarrow.dataset
import rackmesh
from parts import SPEC

plan = rackmesh.Plan(rackmesh.Spec.from_toml(SPEC), columns=["verdict"])
counts: Counter = Counter()
for batch in pyarrow.dataset.dataset(Path(sys.argv[1]), format="parquet").to_batches():
    counts.update(plan.evaluate(batch)["verdict"].to_pylist())
print(", ".join(f"{verdict}: {counts[verdict]}" for verdict in ("pass", "fail", None)))
