"""The multibody case in MuJoCo and in rackmesh, on the same work in the same run.

    pip install mujoco numpy
    cargo build --release && python3 benches/peers/multibody.py [--spheres 12x32] [--stroke 50] [--case over-roller]

MuJoCo: the pinion's flanks carry spheres whose envelope is the true involute helicoid, each rack flank is a thin box,
the same preload, speed and stroke. Both give the mean ΔCD of the deviating teeth less that of the nominal ones; the
script fails if they differ by more than 2 µm, and prints the ratio of the run times (one core each).
"""
import argparse
import json
import subprocess
import sys
import tempfile
import time

import numpy as np

SPEC = """
[pair]
normal_module = 2
normal_pressure_angle = 19.9
[rack]
face_width = 19.7
addendum = 1.7
[[rack.deviation]]
teeth = "4.."
{deviation}
[pinion]
teeth = 8
helix_angle = 21
profile_shift = 0.3
face_width = 23.5
tip_diameter = 19.738
[simulation]
stroke = {stroke}
"""
DEVIATIONS = {
    "over-roller": 'over_roller = "20 um"',
    "pitch": 'pitch = "20 um"',
    "lead": 'lead = "0.25 deg"',
}

# the same numbers, in mm and rad
M, ALPHA, Z, BETA, X = 2.0, np.radians(19.9), 8, np.radians(21), 0.3
K, B, HA, TIP = 19.7, 23.5, 1.7, 19.738 / 2
FIRST_ODD, SPEED, PRELOAD = 4, 20.0, 500.0
PITCH = np.pi * M
R = M * Z / (2 * np.cos(BETA))
ALPHA_T = np.arctan(np.tan(ALPHA) / np.cos(BETA))
R_B = R * np.cos(ALPHA_T)
A0 = R + X * M
TWIST = np.tan(BETA) / R


def involute(angle):
    return np.tan(angle) - angle


def spheres(profile, width, radius):
    """Centres in the pinion's frame (axis along z), by columns."""
    half = (np.pi / 2 + 2 * X * np.tan(ALPHA)) / Z + involute(ALPHA_T)
    roll = np.sqrt(np.linspace(0.05**2, (TIP / R_B) ** 2 - 1, profile))
    roll, along = np.meshgrid(roll, np.linspace(-B / 2, B / 2, width), indexing="ij")
    centres = []
    for tooth in range(Z):
        for side in (1, -1):
            # a point of the flank and the helicoid's normal there, out of the tooth
            angle = -np.pi / 2 + 2 * np.pi * (tooth + 0.5) / Z + TWIST * along + side * half
            phi = angle - side * roll
            point = np.stack(
                [
                    R_B * (np.cos(phi) - side * roll * np.sin(phi)),
                    R_B * (np.sin(phi) + side * roll * np.cos(phi)),
                    along,
                ],
                -1,
            )
            normal = np.stack([-side * np.sin(phi), side * np.cos(phi), -side * R_B * TWIST + 0 * phi], -1)
            normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
            centres.append((point - radius * normal).reshape(-1, 3))
    return np.vstack(centres)


def flank(tooth, side, case):
    """Four corners of a rack flank; world: x along the rack, y towards the pinion, z across."""
    x0, dy, turn = tooth * PITCH, 0.0, 0.0
    if tooth >= FIRST_ODD:
        if case == "pitch":
            x0 += 0.02 * (tooth - FIRST_ODD + 1)
        elif case == "over-roller":
            dy = 0.02
        else:
            turn = np.radians(0.25)
    corners = []
    for y, z in ((-1.25 * M, -K / 2), (-1.25 * M, K / 2), (HA, K / 2), (HA, -K / 2)):
        x = side * (PITCH / 4 - y * np.tan(ALPHA))
        # each flank turns about the vertical through its own mid-width point on the reference plane
        pivot = side * PITCH / 4
        dx = x - pivot
        corners.append([x0 + pivot + dx * np.cos(turn) - z * np.sin(turn), y + dy, dx * np.sin(turn) + z * np.cos(turn)])
    corners = np.array(corners)
    normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
    return corners if normal[0] * side > 0 else corners[::-1].copy()


def quaternion(matrix):
    import mujoco

    out = np.zeros(4)
    mujoco.mju_mat2Quat(out, matrix.flatten())
    return " ".join(f"{v:.15g}" for v in out)


def run_mujoco(case, profile, width, stroke, step=1e-4, radius=0.05, stiffness=4500.0):
    import mujoco

    tilt = np.array([[np.cos(BETA), 0, -np.sin(BETA)], [0, 1, 0], [np.sin(BETA), 0, np.cos(BETA)]])
    mass = 100.0
    xml = [
        f'<mujoco><option timestep="{step}" gravity="0 0 0" solver="Newton" iterations="100" tolerance="1e-14" '
        'integrator="implicitfast"/><size memory="512M"/>'
        f'<default><geom condim="1" solref="{-stiffness**2} {-2 * stiffness}" solimp="0.9999 0.9999 0.001" margin="0"/>'
        "</default><worldbody>"
        f'<body name="pinion" pos="0 {A0} 0" quat="{quaternion(tilt)}">'
        f'<inertial pos="0 0 0" mass="{mass}" diaginertia="{64 * mass} {64 * mass} {64 * mass}"/>'
        f'<joint name="up" type="slide" axis="0 1 0" damping="{300 * mass}"/><joint name="turn" type="hinge" axis="0 0 1"/>'
    ]
    centres = spheres(profile, width, radius)
    xml += [
        f'<geom type="sphere" size="{radius}" pos="{c[0]:.12g} {c[1]:.12g} {c[2]:.12g}" contype="1" conaffinity="2" mass="0"/>'
        for c in centres
    ]
    xml.append(
        '</body><body name="rack"><inertial pos="0 0 0" mass="1e7" diaginertia="1e4 1e4 1e4"/>'
        '<joint name="along" type="slide" axis="1 0 0"/>'
    )
    thick = 0.15
    for tooth in range(-4, 14):
        for side in (1, -1):
            corners = flank(tooth, side, case)
            e1, e2 = corners[1] - corners[0], corners[3] - corners[0]
            l1, l2 = np.linalg.norm(e1), np.linalg.norm(e2)
            normal = np.cross(e1 / l1, e2 / l2)
            at = corners.mean(0) - thick * normal
            frame = np.stack([e1 / l1, e2 / l2, normal], 1)
            xml.append(
                f'<geom type="box" size="{l1 / 2:.12g} {l2 / 2:.12g} {thick}" pos="{at[0]:.12g} {at[1]:.12g} {at[2]:.12g}" '
                f'quat="{quaternion(frame)}" contype="2" conaffinity="1" mass="0"/>'
            )
    xml.append("</body></worldbody></mujoco>")
    model = mujoco.MjModel.from_xml_string("\n".join(xml))
    data = mujoco.MjData(model)
    dof = {name: model.joint(name).dofadr[0] for name in ("up", "turn", "along")}
    data.qvel[dof["along"]] = -SPEED
    data.qvel[dof["turn"]] = -SPEED / (Z * M / 2)
    data.qfrc_applied[dof["up"]] = -1000 * PRELOAD  # mm, kg, s: force in mN
    steps = round(stroke / SPEED / step)
    every = max(1, steps // 1000)
    curve = []
    start = time.perf_counter()
    for index in range(steps):
        mujoco.mj_step(model, data)
        if index % every == 0:
            curve.append((-data.qpos[dof["along"]], data.qpos[dof["up"]]))
    return time.perf_counter() - start, np.array(curve), len(centres)


def run_rackmesh(program, case, stroke):
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as spec:
        spec.write(SPEC.format(deviation=DEVIATIONS[case], stroke=stroke))
        spec.flush()
        start = time.perf_counter()
        done = subprocess.run([program, "simulate", spec.name, "--format", "json"], capture_output=True, text=True)
        spent = time.perf_counter() - start
    if done.returncode != 0:
        sys.exit(done.stderr)
    points = json.loads(done.stdout)["points"]
    return spent, np.array([(point["stroke_mm"], point["delta_cd_mm"]) for point in points])


def difference(curve):
    """Mean over the second rack part less that over the first, and the rms of what is left in the second."""
    stroke, delta = curve.T
    first = delta[(stroke > 3) & (stroke < 15)]
    second = delta[(stroke > 36) & (stroke < 36 + 2 * PITCH)]
    if len(first) == 0 or len(second) == 0:
        sys.exit("the stroke must reach 49 mm for both rack parts to carry")
    return 1000 * (second.mean() - first.mean()), 1000 * second.std()


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--rackmesh", default="target/release/rackmesh")
    options.add_argument("--spheres", default="12x32", help="over the profile x over the width, of each flank")
    options.add_argument("--stroke", type=float, default=50.0)
    options.add_argument("--case", choices=DEVIATIONS, default="over-roller")
    options = options.parse_args()
    ours, curve = run_rackmesh(options.rackmesh, options.case, options.stroke)
    our_difference, our_ripple = difference(curve)
    print(f"rackmesh simulate: {ours:8.3f} s  {our_difference:8.3f} µm  spread {our_ripple:.3f} µm rms", flush=True)
    try:
        import mujoco
    except ImportError:
        sys.exit("mujoco is not installed: nothing to compare with")
    profile, width = map(int, options.spheres.split("x"))
    theirs, curve, count = run_mujoco(options.case, profile, width, options.stroke)
    their_difference, their_ripple = difference(curve)
    print(
        f"MuJoCo {mujoco.__version__}:     {theirs:8.3f} s  {their_difference:8.3f} µm  spread {their_ripple:.3f} µm rms"
        f"  ({count} spheres)"
    )
    print(f"ratio of run times {theirs / ours:.1f}")
    if abs(our_difference - their_difference) > 2.0:
        sys.exit(f"the answers differ by {our_difference - their_difference:.3f} µm")


if __name__ == "__main__":
    main()
