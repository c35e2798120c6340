"""Spark with two executors, one of which is killed: where pyspark (not only its client) and Java are installed."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pyspark = pytest.importorskip("pyspark")
pytestmark = pytest.mark.skipif(
    shutil.which("java") is None or not (Path(pyspark.__file__).parent / "jars").exists() or sys.platform != "linux",
    reason="Spark itself is not here",
)

PROGRAM = """
import os, signal, sys, time
from collections.abc import Iterator
from pathlib import Path

import rackmesh
from pyspark.sql import SparkSession

sys.path.insert(0, sys.argv[1])
from parts import SPEC

parts, killed = sys.argv[2:4]
plan = rackmesh.Plan(rackmesh.Spec.from_toml(SPEC), columns=["verdict"])


def judge(batches: Iterator) -> Iterator:
    for number, batch in enumerate(batches):
        yield plan.evaluate(batch)
        if number == 1:
            try:
                Path(killed).touch(exist_ok=False)
            except FileExistsError:
                continue
            # the executor is the parent of the daemon that this process was forked from
            executor = int(Path(f"/proc/{os.getppid()}/stat").read_text().rpartition(")")[2].split()[1])
            os.kill(executor, signal.SIGKILL)
            time.sleep(60)


spark = SparkSession.builder.master("local-cluster[2,1,1024]").config("spark.ui.enabled", False).getOrCreate()
judged = spark.read.parquet(parts).mapInArrow(judge, "verdict string, reason string")
counts = {row["verdict"]: row["count"] for row in judged.groupBy("verdict").count().collect()}
print(", ".join(f"{verdict}: {counts.get(verdict, 0)}" for verdict in ("pass", "fail", None)))
"""


def test_an_executor_that_dies_costs_nothing_but_time(tmp_path: Path) -> None:
    examples = Path(__file__).parents[1] / "examples"
    subprocess.run([sys.executable, examples / "parts.py", tmp_path / "parts"], check=True)
    killed = tmp_path / "killed"
    said = subprocess.run(
        [sys.executable, "-c", PROGRAM, examples, tmp_path / "parts", killed],
        capture_output=True, text=True, check=False, timeout=300, env={**os.environ, "PYSPARK_PYTHON": sys.executable},
    )
    assert said.stdout.strip().endswith("pass: 199155, fail: 645, None: 200"), said.stderr
    assert killed.exists()
    assert "lost" in said.stderr.lower()
