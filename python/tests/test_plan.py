"""A table is judged as ``rackmesh batch`` judges it, whatever library holds it."""

import csv
import pickle
import random
import subprocess
import sys
from decimal import Decimal
from pathlib import Path

import polars
import pyarrow
import pytest
import rackmesh

SPEC = """
[pair]
normal_pressure_angle = 20
[errors]
rack_over_roller = { nominal = 25.0 }
rack_pitch = "0 um"
[limits]
center_distance = "±0.05"
"""


def parts(rows: int) -> pyarrow.Table:
    draw = random.Random(7)
    sizes = [round(25 + draw.uniform(-0.06, 0.06), 4) for _ in range(rows)]
    pitches = [round(draw.uniform(-0.02, 0.02), 4) for _ in range(rows)]
    names = [f"P{row}" for row in range(rows)]
    return pyarrow.table({"part_id": names, "rack_over_roller": sizes, "rack_pitch": pitches})


def plan(**options: object) -> rackmesh.Plan:
    return rackmesh.Plan(rackmesh.Spec.from_toml(SPEC), **options)


def test_it_is_the_batch(tmp_path: Path) -> None:
    table = parts(5000)
    (tmp_path / "spec.toml").write_text(SPEC)
    with (tmp_path / "parts.csv").open("w", newline="") as file:
        csv.writer(file).writerows([table.column_names, *zip(*table.to_pydict().values())])
    program = "from rackmesh._command import main; main()"
    arguments = ["batch", str(tmp_path / "spec.toml"), str(tmp_path / "parts.csv"), "--decimals", "full", "-q"]
    said = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=False)
    expected = list(csv.DictReader(said.stdout.splitlines()))
    results = plan().evaluate(table).to_pylist()
    assert len(results) == len(expected) == 5000
    assert {row["verdict"] for row in results} == {"pass", "fail"}
    for row, line in zip(results, expected):
        assert (row.pop("reason") or "") == line.pop("reason")
        assert {key: value if isinstance(value, str) else repr(value) for key, value in row.items()} == {
            # a statistical sum is empty where nothing scatters
            key: value if key in ("part_id", "verdict") else repr(float(value) if value else None)
            for key, value in line.items()
        }


def test_results_come_as_the_data_did() -> None:
    table = parts(300)
    evaluated = plan().evaluate(table)
    assert isinstance(evaluated, pyarrow.Table)
    batch = table.to_batches()[0]
    assert isinstance(plan().evaluate(batch), pyarrow.RecordBatch)
    assert plan().evaluate(batch).to_pydict() == evaluated.to_pydict()
    frame = polars.from_arrow(table)
    assert plan().evaluate(frame).to_dict(as_series=False) == evaluated.to_pydict()
    lazy = frame.lazy().map_batches(plan().evaluate, schema=None, validate_output_schema=False).collect()
    assert lazy.to_dict(as_series=False) == evaluated.to_pydict()
    assert plan().schema(table.schema) == evaluated.schema == plan().schema(table)


def test_threads_and_pieces_change_nothing() -> None:
    table = parts(150_000)
    one = plan().evaluate(table)
    assert plan(threads=2).evaluate(table).equals(one)
    pieces = pyarrow.Table.from_batches(table.to_batches(max_chunksize=4096))
    assert plan(threads=3).evaluate(pieces).combine_chunks().equals(one.combine_chunks())


def test_results_stay_as_long_as_they_are_held() -> None:
    table, of_lot = parts(5000).combine_chunks(), plan()
    [batch] = table.to_batches()
    first = of_lot.evaluate(batch)
    expected = first.to_pylist()
    of_lot.evaluate(batch.slice(2500))
    column = first["verdict"].slice(10)
    verdicts = column.to_pylist()
    assert first.to_pylist() == expected
    del first
    # the memory of the others is used again
    of_lot.evaluate(batch.slice(1000))
    assert column.to_pylist() == verdicts


def test_types_of_numbers() -> None:
    doubles = plan().evaluate(parts(100)).to_pydict()
    for convert in (
        lambda value: Decimal(str(value)),
        str,
    ):
        table = parts(100)
        columns = {
            name: [convert(value) for value in table[name].to_pylist()] for name in ("rack_over_roller", "rack_pitch")
        }
        assert plan().evaluate(pyarrow.table({"part_id": table["part_id"], **columns})).to_pydict() == doubles
    names = table["part_id"].combine_chunks().dictionary_encode()
    encoded = table.set_column(0, "part_id", names)
    assert plan().evaluate(encoded).to_pydict() == doubles


def test_a_row_without_an_answer_says_why() -> None:
    table = pyarrow.table(
        {
            "part_id": ["P1", "P2", "P3", "mean"],
            "rack_over_roller": [25.01, None, 25.0, 25.0],
            "rack_pitch": [0.001, 0.001, float("nan"), 0.0],
        }
    )
    results = plan().evaluate(table).to_pydict()
    assert results["verdict"] == ["pass", None, None, None]
    assert results["reason"][0] is None
    assert "there is no value" in results["reason"][1]
    assert "is not a number" in results["reason"][2]
    assert "is no part's name" in results["reason"][3]
    empty = plan().evaluate(table.slice(0, 0))
    assert empty.num_rows == 0 and empty.schema == plan().schema(table)
    nothing = plan().evaluate(table.set_column(1, "rack_over_roller", pyarrow.nulls(4, pyarrow.float64())))
    assert nothing["verdict"].to_pylist() == [None] * 4


def test_what_may_be_a_measurement_is_refused_with_the_same_words() -> None:
    table = parts(10).append_column("rack_pich [um]", pyarrow.array([200.0] * 10))
    with pytest.raises(rackmesh.RackmeshError, match="rack_pich"):
        plan().evaluate(table)
    ignored = plan(ignore=["rack_pich*"]).evaluate(table)
    assert ignored.num_rows == 10
    without = parts(10).drop(["rack_pitch"])
    assert set(plan().evaluate(without)["verdict"].to_pylist()) == {None}
    partial = plan(partial=True).evaluate(without)
    assert set(partial["judged_without"].to_pylist()) == {"rack_pitch"}
    assert None not in partial["verdict"].to_pylist()


def test_a_plan_pickles() -> None:
    again = pickle.loads(pickle.dumps(plan(columns=["part_id", "verdict"], threads=2)))
    assert again.evaluate(parts(50)).column_names == ["part_id", "verdict", "reason"]
