"""A table of parts, the same every time: the input of the other examples, written as Parquet files.

    python python/examples/parts.py FOLDER [ROWS [FILES]]
"""

import sys
from pathlib import Path

import numpy
import pyarrow
import pyarrow.parquet

SPEC = """
[pair]
normal_pressure_angle = 20
[errors]
rack_over_roller = { nominal = 25.0 }
pinion_radial = { nominal = 8.5 }
rack_pitch = "0 um"
[limits]
center_distance = "±0.05"
"""


def parts(rows: int, seed: int = 0) -> pyarrow.Table:
    """Parts whose errors are normal; every thousandth has no measure over the roller."""
    draw = numpy.random.default_rng(seed)
    size = numpy.round(25 + draw.normal(0, 0.012, rows), 4)
    return pyarrow.table(
        {
            "part_id": [f"P{seed}-{row}" for row in range(rows)],
            "rack_over_roller": pyarrow.array(size, mask=numpy.arange(rows) % 1000 == 999),
            "rack_pitch": numpy.round(draw.normal(0, 0.006, rows), 4),
            "pinion_radial": numpy.round(8.5 + draw.normal(0, 0.006, rows), 4),
        }
    )


def write(folder: Path, rows: int = 200_000, files: int = 4) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for number in range(files):
        pyarrow.parquet.write_table(parts(rows // files, seed=number), folder / f"lot-{number}.parquet")


if __name__ == "__main__":
    write(Path(sys.argv[1]), *map(int, sys.argv[2:4]))
