"""Parts in Parquet files through Spark's mapInArrow: on Spark itself, or on Sail, which speaks its protocol without a JVM.

    python python/examples/spark_map_in_arrow.py FOLDER sc://localhost:50051   # Spark Connect, or a Sail server
    python python/examples/spark_map_in_arrow.py FOLDER sail                   # starts Sail in this process
    python python/examples/spark_map_in_arrow.py FOLDER "local-cluster[2,1,1024]"   # Spark itself, two executors
"""

import os
import sys
from collections.abc import Iterator

import pyarrow
import rackmesh
from parts import SPEC
from pyspark.sql import SparkSession

plan = rackmesh.Plan(rackmesh.Spec.from_toml(SPEC), columns=["verdict"])


def judge(batches: Iterator[pyarrow.RecordBatch]) -> Iterator[pyarrow.RecordBatch]:
    """The plan comes to each worker with this function."""
    return map(plan.evaluate, batches)


def main(folder: str, where: str) -> None:
    server = None
    if where == "sail":
        from pysail.spark import SparkConnectServer

        server = SparkConnectServer("127.0.0.1", 0)
        server.start()
        where = "sc://{}:{}".format(*server.listening_address)
    builder = SparkSession.builder
    spark = (builder.remote(where) if where.startswith("sc://") else builder.master(where)).getOrCreate()
    judged = spark.read.parquet(folder).mapInArrow(judge, "verdict string, reason string")
    counts = {row["verdict"]: row["count"] for row in judged.groupBy("verdict").count().collect()}
    print(", ".join(f"{verdict}: {counts.get(verdict, 0)}" for verdict in ("pass", "fail", None)), flush=True)
    spark.stop()
    if server is not None:
        server.stop()
        # threads of the workers stay behind
        os._exit(0)


if __name__ == "__main__":
    main(*sys.argv[1:3])
