"""Random racks in ranges, through Spark's mapInArrow, merged and compared with one process: the same bits.

    python python/examples/spark_study.py SPEC RACKS sail                      # starts Sail in this process
    python python/examples/spark_study.py SPEC RACKS sc://localhost:50051      # Spark Connect, or a Sail server
    python python/examples/spark_study.py SPEC RACKS "local-cluster[2,1,1024]" # Spark itself
"""

import os
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pyarrow
import rackmesh
from pyspark.sql import SparkSession

spec = rackmesh.Spec.from_file(sys.argv[1])
racks, where = int(float(sys.argv[2])), sys.argv[3]
RANGES = 16
SIZE = -(-racks // RANGES)


def solve(batches: Iterator[pyarrow.RecordBatch]) -> Iterator[pyarrow.RecordBatch]:
    """A study for each first rack; the spec comes to each worker with this function."""
    for batch in batches:
        studies = []
        for first in batch["first"].to_pylist():
            with tempfile.TemporaryDirectory() as folder:
                study = Path(folder) / "study.json"
                spec.monte_carlo(first_rack=first, racks=min(SIZE, racks - first), study=study, threads=1)
                studies.append(study.read_text())
        yield pyarrow.record_batch({"study": studies})


def main() -> None:
    begun = time.perf_counter()
    address, server = where, None
    if where == "sail":
        from pysail.spark import SparkConnectServer

        server = SparkConnectServer("127.0.0.1", 0)
        server.start()
        address = "sc://{}:{}".format(*server.listening_address)
    builder = SparkSession.builder
    spark = (builder.remote(address) if address.startswith("sc://") else builder.master(address)).getOrCreate()
    firsts = spark.range(0, racks, SIZE, numPartitions=RANGES).withColumnRenamed("id", "first")
    with tempfile.TemporaryDirectory() as folder:
        files = []
        for number, row in enumerate(firsts.mapInArrow(solve, "study string").collect()):
            files.append(str(Path(folder) / f"{number}.json"))
            Path(files[-1]).write_text(row["study"])
        merged = spec.monte_carlo(merge=files)
    engine = time.perf_counter() - begun
    one = spec.monte_carlo(racks=racks)
    alone = time.perf_counter() - begun - engine
    mean = merged["delta_cd"]["mean"]
    print(f"{merged['racks']} racks, mean of ΔCD {mean['mean_mm']} mm, verdict {merged['verdict']}")
    print("the same bits as one process" if merged == one else "NOT what one process says", flush=True)
    print(f"{engine:.1f} s, one process with all cores {alone:.1f} s", file=sys.stderr, flush=True)
    if server is not None:
        # threads of the workers stay behind
        os._exit(0 if merged == one else 1)
    sys.exit(merged != one)


if __name__ == "__main__":
    main()
