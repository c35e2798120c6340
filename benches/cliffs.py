#!/usr/bin/env python3
"""Whether a spec is much slower than one like it: CPU time of 300 random valid specs, each against its plain twin.

The twin is the same pair without flank form and with a fixed rack. A spec is a cliff if it takes more than 2 s and
more than 20 times what its twin takes. Run from the repository:

    cargo build --release
    python3 benches/cliffs.py [--program target/release/rackmesh] [--count 300] [--seed 1] [--timeout 60]
"""

import argparse
import math
import os
import random
import signal
import subprocess
import sys
import tempfile

LEAST_S, MOST_TIMES = 2.0, 20.0
COMMANDS = ["mesh", "eval", "budget", "simulate", "batch", "monte-carlo"]


def spec(rng, command):
    """The sections of a random spec; those of form and support apart."""
    module = rng.choice([0.2, 0.5, 1, 2, 3, 10])
    teeth = rng.choice([5, 6, 8, 9, 12, 20, 40, 100, 300])
    helix = rng.choice([0, 0, 5, -10, 20, 35, -45])
    shift = rng.choice([0, 0.3, 0.5])
    addendum = rng.choice([0.6, 0.85, 1]) * module
    face = rng.choice([5, 20, 30, 60])
    tip = module * teeth / math.cos(math.radians(helix)) + 2 * (shift + 0.85) * module
    pair = f"[pair]\nnormal_module = {module}\nnormal_pressure_angle = {rng.choice([14.5, 15, 17.5, 20, 25, 30])}\n"
    rack = f"[rack]\nface_width = {face}\naddendum = {addendum:.4f}\nhelix_angle = {rng.choice([0, 0, 5, -10, 20])}\n"
    pinion = f"[pinion]\nteeth = {teeth}\nhelix_angle = {helix}\nprofile_shift = {shift}\nface_width = {1.3 * face:.3f}\ntip_diameter = {tip:.4f}\n"
    rack_form = rng.choice(["", 'crowning = "2 um"\n', 'crowning = "30 um"\n'])
    if rng.random() < 0.4:
        rack_form += f'tip_relief = {{ amount = "{rng.choice([10, 50])} um", start = {0.4 * addendum:.4f} }}\n'
    pinion_form = rng.choice(["", 'crowning = "2 um"\n', 'crowning = "10 um"\n'])
    pinion_form += rng.choice(["", 'profile_slope = "-10 um"\n', 'profile_slope = "5 um"\n'])
    support = f'[support]\nroll = "free"\nroll_axis_depth = {rng.choice([0, 3.4, 8, 14])}\n' if rng.random() < 0.5 else ""
    rest = ""
    if command == "mesh":
        for _ in range(rng.randrange(4)):
            teeth_on = rng.choice(['"2"', '"3.."', '"4"'])
            what = rng.choice(['lead = "0.13 deg"', 'lead = "-0.05 deg"', 'pitch = "-19 um"', 'thickness = "29 um"'])
            rest += f"[[rack.deviation]]\nteeth = {teeth_on}\n{what}\n"
    else:
        rest = f'[errors]\nrack_over_roller = "{rng.randint(-30, 30)} um"\nrack_pitch = "{rng.randint(1, 20)} um"\npinion_pitch = "8 um"\n'
    if rng.random() < 0.5 or command in ("budget", "eval", "batch"):
        rest += '[limits]\ncenter_distance = "±0.05"\n'
    if command == "budget":
        rest += '[budget]\nstack = "rss"\n'
    with_form = pair + rack + rack_form + pinion + pinion_form + support + rest
    return with_form, pair + rack + pinion + rest


def run(program, command, text, folder, timeout):
    """Exit code (None after the time allowed) and CPU seconds."""
    path = os.path.join(folder, "spec.toml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    parts = os.path.join(folder, "parts.csv")
    with open(parts, "w", encoding="utf-8") as file:
        file.write("part,rack_over_roller_um\nA,5\nB,-12\n")
    options = {"batch": [parts, "--worst-teeth"], "mesh": ["--to", "50"], "simulate": ["--to", "5"]}.get(command, [])
    before = os.times()
    process = subprocess.Popen([program, command, path, *options], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        code = process.wait(timeout)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGKILL)
        process.wait()
        code = None
    after = os.times()
    return code, after.children_user + after.children_system - before.children_user - before.children_system


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--program", default="target/release/rackmesh")
    arguments.add_argument("--count", type=int, default=300)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--timeout", type=float, default=60.0)
    arguments.add_argument("--keep", help="folder for the specs beyond the bound")
    given = arguments.parse_args()
    rng, timed, beyond, slowest = random.Random(given.seed), 0, 0, 0.0
    with tempfile.TemporaryDirectory() as folder:
        for number in range(20 * given.count):
            if timed == given.count:
                break
            command = COMMANDS[number % len(COMMANDS)]
            text, twin = spec(rng, command)
            code, plain_s = run(given.program, command, twin, folder, given.timeout)
            if code in (2, None):
                continue
            code, took_s = run(given.program, command, text, folder, given.timeout)
            if code == 2:
                continue
            timed += 1
            slowest = max(slowest, took_s)
            if code is None or took_s > max(LEAST_S, MOST_TIMES * plain_s):
                beyond += 1
                more = "more than " if code is None else ""
                print(f"{number} {command}: {more}{took_s:.2f} s, its twin {plain_s:.2f} s", flush=True)
                if given.keep:
                    os.makedirs(given.keep, exist_ok=True)
                    with open(os.path.join(given.keep, f"{number}_{command}.toml"), "w", encoding="utf-8") as file:
                        file.write(text)
    print(f"{beyond} of {timed} specs are beyond the bound; the slowest took {slowest:.2f} s")
    return 1 if beyond else 0


if __name__ == "__main__":
    sys.exit(main())
