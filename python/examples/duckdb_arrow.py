"""Parts in Parquet files through DuckDB: its record batches in, a relation of results out.

    python python/examples/duckdb_arrow.py FOLDER [THREADS]
"""

import sys

import duckdb
import pyarrow
import rackmesh
from parts import SPEC

threads = int(sys.argv[2]) if len(sys.argv) > 2 else 1
plan = rackmesh.Plan(rackmesh.Spec.from_toml(SPEC), columns=["verdict"], threads=threads)
# a connection of its own, for its rows are read while another query runs
source = duckdb.connect(config={"threads": threads})
reader = source.sql(f"from '{sys.argv[1]}/*.parquet'").to_arrow_reader(500_000)
batches = (plan.evaluate(batch) for batch in reader)
judged = pyarrow.RecordBatchReader.from_batches(plan.schema(reader.schema), batches)
counts = dict(duckdb.sql("select verdict, count(*) from judged group by verdict").fetchall())
print(", ".join(f"{verdict}: {counts.get(verdict, 0)}" for verdict in ("pass", "fail", None)))
