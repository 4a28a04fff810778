"""MuJoCo's Euler integrator at 1 ms, beside `cargo bench --bench simulation`: how fast it is, and how far off a free swing.

Run by hand, not by the tests (needs mujoco and numpy):

    python3 tests/oracle/mujoco_euler.py ROBOT.urdf... [--swing UR5.urdf REFERENCE.csv]

For each URDF one line: the real-time factor of a second of tracking, and of falling, the best of REPEATS. What is tracked is the wave
of `benches/simulation.rs`: 25 harmonics at a period of 2 s about the middle of the joints' ranges, most of it in the third. The controller
is of the same kind as ours: inverse dynamics of the wanted motion (mj_inverse) fed forward at every step, and a spring and damper a joint,
critically damped at 12 Hz about the inertia of the mean posture. The spring is an actuator, the damper is the joint's, so that it is implicit
in the step, which `wave_arm` needs. Positions and torques are worked out before the clock starts, and the steps are MuJoCo's own loop over
them: no Python is timed, nor what the controller costs, which it does in ours. One inverse dynamics more is told apart, Python's call in it.

With --swing, the largest error of a joint after a second of a fall from the first row of the reference, which says time, six positions and
six velocities a row; joints without limits, damping or friction.

Meshes and contacts are left out, as in our plants.
"""

import argparse
import csv
import re
import time

import mujoco
import numpy as np
from mujoco import rollout

STEP = 1e-3
STEPS = 1000
REPEATS = 15
BANDWIDTH = 12.0
HARMONICS = 25
PERIOD = 2.0


def load(path, gains=None, free=False):
    """The model of a URDF: bodies and joints alone, each inertia as it is. Without visuals MuJoCo looks for no mesh."""
    text = open(path).read()
    text = re.sub(r"<(visual|collision)\b.*?</\1>", "", text, flags=re.S)
    options = '<mujoco><compiler balanceinertia="false" discardvisual="true" fusestatic="true" strippath="true"/></mujoco>'
    text = re.sub(r"(<robot\b[^>]*>)", lambda m: m.group(1) + options, text, count=1)
    spec = mujoco.MjSpec.from_string(text)
    spec.option.timestep = STEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    for j, joint in enumerate(spec.joints):
        joint.armature = 0.0
        # The spring alone is more than a motor gives: the damper takes most of it off.
        joint.actfrclimited = mujoco.mjtLimited.mjLIMITED_FALSE
        if free:
            joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
            joint.damping = np.zeros(3)
            joint.frictionloss = 0.0
        elif gains is not None:
            stiffness, damping = gains[0][j], gains[1][j]
            joint.damping = joint.damping + np.array([damping, 0.0, 0.0])
            actuator = spec.add_actuator(name=f"servo_{j}", target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            actuator.gainprm[0] = stiffness
            actuator.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            actuator.biasprm[1] = -stiffness
    return spec.compile()


def wave(model):
    """Position, velocity and acceleration at every step, a row each."""
    joints = model.nq
    limited = model.jnt_limited.astype(bool)
    offsets = np.where(limited, model.jnt_range.mean(axis=1), 0.0)
    times = np.arange(STEPS + 1) * STEP
    w = 2 * np.pi / PERIOD
    series = np.zeros((3, len(times), joints))
    series[0] += offsets
    for k in range(HARMONICS):
        modulus = 0.04 if k == 2 else 1e-3 / (k + 1)
        turn = np.exp(1j * (k + 1) * w * times)[:, None]
        z = 2 * modulus * np.exp(1j * (np.arange(joints) + k)) * turn
        rate = 1j * (k + 1) * w
        for n in range(3):
            series[n] += (z * rate**n).real
    return series


def mass_diagonal(model, q):
    data = mujoco.MjData(model)
    data.qpos[:] = q
    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full.diagonal().copy()


def tracking(path):
    plain = load(path)
    position, velocity, acceleration = wave(plain)
    inertia = mass_diagonal(plain, position.mean(axis=0))
    w = 2 * np.pi * BANDWIDTH
    stiffness, damping = inertia * w * w, 2 * inertia * w
    model = load(path, (stiffness, damping))
    data, other = mujoco.MjData(model), mujoco.MjData(plain)
    efforts = np.zeros((STEPS, model.nv))
    calls = []
    for n in range(STEPS):
        other.qpos, other.qvel, other.qacc = position[n], velocity[n], acceleration[n]
        start = time.perf_counter()
        mujoco.mj_inverse(plain, other)
        calls.append(time.perf_counter() - start)
        efforts[n] = other.qfrc_inverse
    # The rate is in the target: kp (r + kd / kp s - q) - kd v. Both are of the end of the step.
    targets = (position + damping / stiffness * velocity)[1:]
    controls = np.hstack([targets, efforts])[None]
    spec = mujoco.mjtState.mjSTATE_CTRL.value | mujoco.mjtState.mjSTATE_QFRC_APPLIED.value
    start_state = np.hstack([[0.0], position[0], velocity[0]])[None]
    best = np.inf
    for _ in range(REPEATS):
        start = time.perf_counter()
        states, _ = rollout.rollout(model, data, start_state, controls, control_spec=spec)
        best = min(best, time.perf_counter() - start)
    errors = states[0][:, 1 : 1 + model.nq] - position[1:]
    return best, STEPS * np.median(calls), np.sqrt((errors**2).mean(axis=0)).max()


def falling(path):
    model = load(path, free=True)
    data = mujoco.MjData(model)
    best = np.inf
    for _ in range(REPEATS):
        mujoco.mj_resetData(model, data)
        data.qpos[:] = 0.1
        start = time.perf_counter()
        mujoco.mj_step(model, data, nstep=STEPS)
        best = min(best, time.perf_counter() - start)
    return best


def swing(path, reference):
    rows = [[float(x) for x in row] for row in csv.reader(open(reference)) if not row[0].startswith("#")]
    model = load(path, free=True)
    data = mujoco.MjData(model)
    data.qpos[:] = rows[0][1 : 1 + model.nq]
    mujoco.mj_step(model, data, nstep=STEPS)
    last = next(row for row in rows if abs(row[0] - STEPS * STEP) < 1e-9)
    return np.abs(data.qpos - last[1 : 1 + model.nq]).max()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("robots", nargs="*")
    parser.add_argument("--swing", nargs=2)
    arguments = parser.parse_args()
    print(f"MuJoCo {mujoco.__version__}, Euler, {STEP} s")
    for path in arguments.robots:
        (track, inverse, error), fall = tracking(path), falling(path)
        length = STEP * STEPS
        print(
            f"{path}: tracking {length / track:.0f} times real time, with inverse dynamics "
            f"{length / (track + inverse):.0f} ({error:.1e} rad RMS), falling {length / fall:.0f}"
        )
    if arguments.swing:
        print(f"free swing: {swing(*arguments.swing):.2e} rad off after {STEP * STEPS} s")


if __name__ == "__main__":
    main()
