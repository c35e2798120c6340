"""Parts in Parquet files through Daft: a function on its batches.

    python python/examples/daft_batches.py FOLDER
"""

import sys

import daft
import pyarrow
import rackmesh
from parts import SPEC

plan = rackmesh.Plan(rackmesh.Spec.from_toml(SPEC), columns=["verdict"])


@daft.func.batch(return_dtype=daft.DataType.string())
def verdict(size: daft.Series, pitch: daft.Series, radial: daft.Series) -> pyarrow.Array:
    """The plan comes to each worker with this function."""
    columns = {"rack_over_roller": size, "rack_pitch": pitch, "pinion_radial": radial}
    batch = pyarrow.record_batch({name: column.to_arrow() for name, column in columns.items()})
    return plan.evaluate(batch)["verdict"]


parts = daft.read_parquet(f"{sys.argv[1]}/*.parquet")
judged = parts.select(verdict(parts["rack_over_roller"], parts["rack_pitch"], parts["pinion_radial"]).alias("verdict"))
counts = judged.groupby("verdict").agg(daft.col("verdict").count(mode="all").alias("count")).to_pydict()
counts = dict(zip(counts["verdict"], counts["count"]))
print(", ".join(f"{verdict}: {counts.get(verdict, 0)}" for verdict in ("pass", "fail", None)))
