#!/usr/bin/env python3
"""How judging parts scales: rows per second through each engine that is installed, with one worker on one core and with two on
two.

    pip install ./python numpy pyarrow duckdb polars   # and those of python/README.md that are wanted
    python benches/scale.py [ROWS]

Each engine runs its script of python/examples on the same Parquet files; the answers must be the same. The time of a small
table, which is starting up, is taken off; of three runs the fastest counts.
"""
import importlib.metadata
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROWS = int(float(sys.argv[1])) if len(sys.argv) > 1 else 4_000_000
SMALL = 4_000
EXAMPLES = Path(__file__).parents[1] / "python" / "examples"
RUNS = 3

SAIL = {"SAIL_MODE": "local-cluster", "SAIL_CLUSTER__WORKER_INITIAL_COUNT": "2"}
CORES = sorted(os.sched_getaffinity(0))
# engine, package, script, arguments and environment for so many workers
ENGINES = [
    ("pyarrow, one process", "pyarrow", "one_process.py", lambda workers: ([str(workers)], {})),
    ("polars", "polars", "polars_lazy.py", lambda workers: ([str(workers)], {"POLARS_MAX_THREADS": str(workers)})),
    ("DuckDB", "duckdb", "duckdb_arrow.py", lambda workers: ([str(workers)], {})),
    ("DataFusion", "datafusion", "datafusion_batches.py", lambda workers: ([str(workers)], {})),
    # the least that Sail starts is two workers: on one core they take turns
    ("Sail, local cluster", "pysail", "spark_map_in_arrow.py", lambda workers: (["sail"], SAIL)),
]


def run(script: str, folder: Path, workers: int, arguments: list, environment: dict) -> tuple:
    """The fastest time in seconds on so many cores, and the answer."""
    times, answers = [], set()
    for _ in range(RUNS):
        start = time.perf_counter()
        said = subprocess.run(
            [sys.executable, EXAMPLES / script, folder, *arguments], capture_output=True, text=True, check=False,
            env={**os.environ, **environment}, preexec_fn=lambda: os.sched_setaffinity(0, CORES[:workers]),
        )
        times.append(time.perf_counter() - start)
        answers.add(said.stdout.strip() or said.stderr.strip().splitlines()[-1])
    return min(times), ", ".join(sorted(answers))


with tempfile.TemporaryDirectory() as folder:
    large, small = Path(folder) / "large", Path(folder) / "small"
    for where, rows in ((large, ROWS), (small, SMALL)):
        subprocess.run([sys.executable, EXAMPLES / "parts.py", where, str(rows), "8"], check=True)
    size = sum(file.stat().st_size for file in large.iterdir())
    print(f"{ROWS:,} rows, {size / ROWS:.1f} bytes a row as Parquet; rackmesh {importlib.metadata.version('rackmesh')}")
    expected = None
    for engine, package, script, workers_of in ENGINES:
        try:
            version = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            print(f"{engine}: not installed")
            continue
        rates = {}
        for workers in (1, 2):
            start, _ = run(script, small, workers, *workers_of(workers))
            seconds, answer = run(script, large, workers, *workers_of(workers))
            expected = expected or answer
            if answer != expected:
                sys.exit(f"{engine} says {answer}, and the first one {expected}")
            rates[workers] = ROWS / max(seconds - start, 1e-3)
        shown = ", ".join(f"{workers} worker{'s'[:workers - 1]} {rate / 1e6:.1f} M rows/s" for workers, rate in rates.items())
        efficiency = f", efficiency {rates[2] / rates[1] / 2:.2f}" if len(rates) == 2 else ""
        print(f"{engine} {version}: {shown}{efficiency}")
    print(expected)
