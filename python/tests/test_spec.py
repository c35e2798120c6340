"""Specs say what the commands say."""

import json
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy
import polars
import pyarrow
import pytest
import rackmesh

EXAMPLES = Path(__file__).parents[2] / "examples"


def command(*arguments: str) -> subprocess.CompletedProcess:
    program = "from rackmesh._command import main; main()"
    return subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("name", "method", "arguments"),
    [
        ("steering.toml", "evaluate", ["eval"]),
        ("uncertain.toml", "evaluate", ["eval"]),
        ("mesh-errors.toml", "mesh", ["mesh"]),
        ("scatter.toml", "monte_carlo", ["monte-carlo"]),
        ("paper.toml", "simulate", ["simulate"]),
        ("budget.toml", "budget", ["budget"]),
    ],
)
def test_an_answer_is_the_command_s(name: str, method: str, arguments: list[str]) -> None:
    path = EXAMPLES / name
    said = command(*arguments, str(path), "--format", "json")
    answer = getattr(rackmesh.Spec.from_file(path), method)()
    expected = json.loads(said.stdout)
    assert answer.to_dict() == expected
    assert answer.status == said.returncode
    assert answer._repr_markdown_().strip()


def test_options_and_settings_are_the_command_s() -> None:
    path = EXAMPLES / "steering.toml"
    spec = rackmesh.Spec.from_file(path).set("errors.rack_pitch", "30 um").set("errors.rack_pitch", "12um")
    said = command("eval", str(path), "--set", "errors.rack_pitch=12um", "--stack", "rss", "--format", "json")
    assert spec.evaluate(stack="rss").to_dict() == json.loads(said.stdout)
    again = pickle.loads(pickle.dumps(spec))
    assert again.evaluate(stack="rss") == spec.evaluate(stack="rss")


def test_ranges_of_racks_merge_to_one_run(tmp_path: Path) -> None:
    spec = rackmesh.Spec.from_file(EXAMPLES / "scatter.toml")
    files = [str(tmp_path / name) for name in ("a.json", "b.json")]
    spec.monte_carlo(racks=30, study=files[0])
    spec.monte_carlo(racks=20, first_rack=30, study=files[1])
    assert spec.monte_carlo(merge=files) == spec.monte_carlo(racks=50)


def test_numbers_come_as_arrays() -> None:
    answer = rackmesh.Spec.from_file(EXAMPLES / "mesh-errors.toml").mesh(0.0, 20.0)
    points = answer.array("points")
    assert all(isinstance(column, numpy.ndarray) for column in points.values())


def test_a_sweep_has_a_row_for_each_design() -> None:
    spec = rackmesh.Spec.from_file(EXAMPLES / "mesh-errors.toml").set("rack.face_width", 20)
    over = {"pinion.teeth": [7, 8], "errors.rack_pitch": "5..15:5um"}
    answer = spec.sweep(over, columns=["range_upper_mm", "verdict"])
    rows = pyarrow.record_batch(answer.table).to_pylist()
    assert (answer.status, len(rows), answer["designs"]) == (0, 6, 6)
    for row in rows:
        design = spec.set("pinion.teeth", int(row["pinion.teeth"])).set("errors.rack_pitch", f"{row['errors.rack_pitch_um']} um")
        said = design.evaluate()
        assert (row["range_upper_mm"], row["verdict"]) == (said["combined"]["range_mm"]["upper"], said["verdict"])
    upper = answer.array("table")["range_upper_mm"]
    assert isinstance(upper, numpy.ndarray) and upper.tolist() == [row["range_upper_mm"] for row in rows]
    assert polars.DataFrame(answer.table)["verdict"].to_list() == [row["verdict"] for row in rows]
    short = spec.sweep({"pinion.teeth": [8]}, of="mesh", columns=["max_mm"], arguments=["--from", "0", "--to", "5"])
    assert short.array("table")["max_mm"].tolist() == [spec.mesh(0, 5)["summary"]["max_mm"]]
    reached = spec.sweep({"errors.rack_pitch": "0..60um"}, until="range_upper_mm=0.08")
    assert abs(reached.array("table")["range_upper_mm"][0] - 0.08) < 1e-9


def test_specs_are_compared_with_what_is_set_in_each() -> None:
    spec = rackmesh.Spec.from_file(EXAMPLES / "mesh-errors.toml")
    wider = spec.set("errors.rack_pitch", "0.03 mm").set("rack.face_width", "19700 um")
    answer = rackmesh.compare(spec, wider)
    assert answer["differences"] == [{"key": "errors.rack_pitch", "values": ["0.02 mm", "0.03 mm"]}]
    upper = next(result for result in answer["results"] if result["name"] == "range_upper_mm")
    assert upper["values"] == [one.evaluate()["combined"]["range_mm"]["upper"] for one in (spec, wider)]
    assert answer.svg is not None and answer.status == wider.evaluate().status


def test_contributions_come_as_arrays() -> None:
    spec = rackmesh.Spec.from_file(EXAMPLES / "scatter.toml")
    answer = spec.monte_carlo(40, 0.0, 10.0, contributions=True)
    indices = answer.array("contributions", "indices")
    assert indices["total"].shape == (12,) and set(indices["delta_cd"]) == {"mean", "largest", "peak_to_peak"}
    assert (indices["total_lower"] <= indices["total_upper"]).all()


def test_what_is_wrong_has_code_place_and_remedy(capfd: pytest.CaptureFixture) -> None:
    with pytest.raises(rackmesh.RackmeshError) as raised:
        rackmesh.Spec.from_toml('[errors]\nrack_pich = "12 um"\n', name="rack.toml")
    error = raised.value
    assert error.code == "unknown-key"
    assert "rack_pich" in error.message
    assert error.place == ("rack.toml", 2, 1)
    assert error.remedy is not None and "rack_pitch" in error.remedy
    assert pickle.loads(pickle.dumps(error)).diagnostics == error.diagnostics
    spec = rackmesh.Spec.from_toml('[errors]\nrack_over_roller = "13 um"')
    with pytest.raises(rackmesh.RackmeshError, match="stack"):
        spec.evaluate(stack="none")
    with pytest.raises(OSError, match="nowhere"):
        rackmesh.Spec.from_file("nowhere.toml")
    assert capfd.readouterr() == ("", "")


def test_the_command_has_its_exit_status() -> None:
    assert command("--version").stdout.startswith("rackmesh ")
    assert command("eval", "nowhere.toml").returncode == 2
    spec = '[errors]\nrack_over_roller = "13 um"\n[limits]\ncenter_distance = "±0.01"'
    program = "from rackmesh._command import main; main()"
    failed = subprocess.run([sys.executable, "-c", program, "eval", "-"], input=spec, text=True, capture_output=True)
    assert (failed.returncode, "FAIL" in failed.stdout) == (1, True)


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of Unix")
@pytest.mark.parametrize(
    "long",
    [
        "spec.monte_carlo(racks=10**9)",
        "[plan.evaluate(lot) for _ in range(10**6)]",
    ],
)
def test_ctrl_c_ends_a_long_run_and_leaves_python_alone(long: str) -> None:
    program = f"""
import signal, time
import pyarrow, rackmesh
signal.signal(signal.SIGINT, signal.default_int_handler)
spec = rackmesh.Spec.from_file({str(EXAMPLES / "scatter.toml")!r})
judged = '[errors]\\nrack_over_roller = "0 um"\\n[limits]\\ncenter_distance = "±0.02"'
plan = rackmesh.Plan(rackmesh.Spec.from_toml(judged))
lot = pyarrow.table({{"rack_over_roller": [0.01] * 10**6}})
for _ in range(2):
    print("begun", flush=True)
    try:
        {long}
    except KeyboardInterrupt:
        print("ended", flush=True)
"""
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None
        for _ in range(2):
            assert running.stdout.readline() == "begun\n"
            time.sleep(0.3)
            running.send_signal(signal.SIGINT)
            assert running.stdout.readline() == "ended\n"
        assert running.wait(10) == 0


def test_a_notebook_shows_the_curve() -> None:
    spec = rackmesh.Spec.from_file(EXAMPLES / "mesh-errors.toml")
    svg = spec.mesh(0.0, 20.0).svg
    assert svg is not None
    assert svg.startswith("<svg")
    assert "<path" in svg or "<polyline" in svg
    assert "worst case" in (spec.evaluate().svg or "")


def test_a_measured_curve_is_a_table_or_arrays() -> None:
    spec = rackmesh.Spec.from_file(EXAMPLES / "master.toml")
    strokes, measured = numpy.loadtxt(EXAMPLES / "trace.csv", delimiter=";", skiprows=1, unpack=True)
    of_table = spec.mesh(measured=EXAMPLES / "trace.csv")
    of_arrays = spec.mesh(measured=(strokes, measured / 1000))
    points = [answer.array("measured", "points")["difference_mm"] for answer in (of_table, of_arrays)]
    assert numpy.allclose(points[0], points[1], atol=1e-9) and len(points[0]) == len(strokes)
    with pytest.raises(ValueError, match="same length"):
        spec.mesh(measured=(strokes, measured[1:]))
