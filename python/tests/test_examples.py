"""Every engine that is installed counts the same verdicts as one process."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"
# 200,000 parts of which every thousandth lacks a measure
EXPECTED = "pass: 199155, fail: 645, None: 200"


@pytest.fixture(scope="module")
def lots(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("lots")
    subprocess.run([sys.executable, EXAMPLES / "parts.py", folder], check=True)
    return folder


@pytest.mark.parametrize(
    ("script", "needs", "arguments"),
    [
        ("one_process.py", "pyarrow", []),
        ("polars_lazy.py", "polars", []),
        ("duckdb_arrow.py", "duckdb", []),
        # the stand-in for Spark, on two workers
        ("spark_map_in_arrow.py", "pysail", ["sail"]),
    ],
)
def test_the_counts_are_those_of_one_process(script: str, needs: str, arguments: list[str], lots: Path) -> None:
    if importlib.util.find_spec(needs) is None:
        pytest.skip(f"{needs} is not installed")
    cluster = {"SAIL_MODE": "local-cluster", "SAIL_CLUSTER__WORKER_INITIAL_COUNT": "2"}
    said = subprocess.run(
        [sys.executable, EXAMPLES / script, lots, *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        env={**os.environ, **cluster},
    )
    assert said.stdout.strip() == EXPECTED, said.stderr
