"""Every engine that is installed counts the same verdicts as one process."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"
CLUSTER = {"SAIL_MODE": "local-cluster", "SAIL_CLUSTER__WORKER_INITIAL_COUNT": "2"}
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
        ("one_process.py", "pyarrow", ["2"]),
        ("polars_lazy.py", "polars", ["2"]),
        ("duckdb_arrow.py", "duckdb", ["2"]),
        ("datafusion_batches.py", "datafusion", ["2"]),
        # the stand-in for Spark, on two workers
        ("spark_map_in_arrow.py", "pysail", ["sail"]),
    ],
)
def test_the_counts_are_those_of_one_process(script: str, needs: str, arguments: list[str], lots: Path) -> None:
    if importlib.util.find_spec(needs) is None:
        pytest.skip(f"{needs} is not installed")
    said = subprocess.run(
        [sys.executable, EXAMPLES / script, lots, *arguments],
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        env={**os.environ, **CLUSTER},
    )
    assert said.stdout.strip() == EXPECTED, said.stderr


def test_racks_in_ranges_on_two_workers_are_one_run() -> None:
    if importlib.util.find_spec("pysail") is None:
        pytest.skip("pysail is not installed")
    spec = EXAMPLES.parents[1] / "examples" / "scatter.toml"
    said = subprocess.run(
        [sys.executable, EXAMPLES / "spark_study.py", spec, "2000", "sail"],
        capture_output=True, text=True, check=False, timeout=120, env={**os.environ, **CLUSTER},
    )
    assert said.returncode == 0 and "the same bits as one process" in said.stdout, said.stderr
