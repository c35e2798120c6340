"""Parts in Parquet files through DataFusion: the record batches of its partitions, each on a thread of its own.

    python python/examples/datafusion_batches.py FOLDER [THREADS]
"""

import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

import pyarrow.compute
import rackmesh
from datafusion import RecordBatchStream, SessionConfig, SessionContext
from parts import SPEC

threads = int(sys.argv[2]) if len(sys.argv) > 2 else 1
plan = rackmesh.Plan(rackmesh.Spec.from_toml(SPEC), columns=["verdict"])


def judged(stream: RecordBatchStream) -> Counter:
    counts: Counter = Counter()
    for batch in stream:
        found = pyarrow.compute.value_counts(plan.evaluate(batch.to_pyarrow())["verdict"])
        counts.update({count["values"]: count["counts"] for count in found.to_pylist()})
    return counts


config = SessionConfig().with_target_partitions(threads).with_batch_size(65_536)
streams = SessionContext(config).read_parquet(sys.argv[1]).execute_stream_partitioned()
with ThreadPoolExecutor(threads) as pool:
    counts = sum(pool.map(judged, streams), Counter())
print(", ".join(f"{verdict}: {counts[verdict]}" for verdict in ("pass", "fail", None)))
