"""The exported robot replays held-out recordings in MuJoCo as the program's own simulation does."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import polars as pl
import pytest

mujoco = pytest.importorskip("mujoco", reason="skipped: mujoco is not installed")

SYNTHETIC = """
[simulation]
train = 2
validation = 1
duration_s = 20.0
noise = {{ dalpha = 0.02, alpha = 0.0005, M = 0.002 }}
seed = 4
hidden = {{ {hidden} }}

[model]
effects = [{effects}]

[[method]]
name = "prediction_error"
"""
RECORDED = """
[recordings]
train = ["{slope}/train_1.csv", "{slope}/train_2.csv"]
validation = ["{slope}/validation.csv"]

[model]
effects = ["slope"]

[[method]]
name = "prediction_error"
"""
HIDDEN = {
    "nothing": "",
    "viscous_friction": "viscous_friction = { b = 0.01 }",
    "turning_scrub": "turning_scrub = { f_t = 0.03 }",
    "caster_drag": "caster_drag = { }",
    "yaw_viscous": "yaw_viscous = { }",
    "actuator_lag": "actuator_lag = { tau = 0.04 }",
    "torque_offset": "torque_offset = { }",
    "torque_gain": "torque_gain = { }",
}


def windows(t: np.ndarray, length: float = 2.0) -> list[range]:
    """The windows of the program: a short rest joins the last one."""
    out, start = [], 0
    for k in range(len(t)):
        if t[k] - t[start] >= length:
            out.append(range(start, k))
            start = k
    if t[-1] - t[start] < 0.5 * length and out:
        out[-1] = range(out[-1].start, len(t))
    else:
        out.append(range(start, len(t)))
    return out


def lagged(t: np.ndarray, inputs: np.ndarray, tau: float) -> np.ndarray:
    """The first-order lag of inputs that run straight between rows."""
    out = inputs.copy()
    for k in range(1, len(t)):
        h = t[k] - t[k - 1]
        slope = (inputs[k] - inputs[k - 1]) / h
        decay = np.exp(-h / tau)
        out[k] = inputs[k] - slope * tau + (out[k - 1] - inputs[k - 1] + slope * tau) * decay
    return out


def replay(folder: Path, table: pl.DataFrame, gains: dict) -> np.ndarray:
    """Wheel speeds of MuJoCo over windows that start where those of the program start."""
    model = mujoco.MjModel.from_xml_path(str(folder / "robot.xml"))
    data = mujoco.MjData(model)
    r, l1 = gains["wheel_radius_m"]["value"], 0.5 * gains["track_width_m"]["value"]
    t = table["t_s"].to_numpy()
    pair = lambda name: table[name.format(1), name.format(2)].to_numpy()  # noqa: E731
    alpha, inputs = pair("alpha{}_rad"), pair("input{}_N_m")
    program = pair("dalpha{}_simulated_2s_rad_s")
    order = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in
             ("x", "y", "z", "yaw", "right", "left")]  # fmt: skip
    tau = ElementTree.parse(folder / "robot.xml").find("actuator/general").get("dynprm")
    acting = lagged(t, inputs, float(tau)) if tau else inputs
    for _ in range(500):  # the tyres settle under the weight
        mujoco.mj_step(model, data)
    height = data.qpos[order[2]]
    out = np.full_like(program, np.nan)
    for window in windows(t):
        first = window.start
        mujoco.mj_resetData(model, data)
        w, heading = program[first], r / (2 * l1) * (alpha[first, 0] - alpha[first, 1])
        v = r / 2 * w.sum()
        data.qpos[order] = [0, 0, height, heading, *alpha[first]]
        data.qvel[order] = [v * np.cos(heading), v * np.sin(heading), 0,
                            r / (2 * l1) * (w[0] - w[1]), *w]  # fmt: skip
        if model.na:
            data.act[:] = acting[first]
        out[first] = w
        for k in window[1:]:
            h = t[k] - t[k - 1]
            steps = max(1, int(np.ceil(h / 1e-3 - 1e-6)))
            model.opt.timestep = h / steps
            for s in range(steps):
                share = (s + 0.5) / steps
                data.ctrl[:] = inputs[k - 1] + share * (inputs[k] - inputs[k - 1])
                mujoco.mj_step(model, data)
            out[k] = data.qvel[order[4:]]
    return out


def errors(experiment, folder: Path, text: str) -> tuple[float, float]:
    """2 s simulation error [rad/s] of MuJoCo and of the program on the validation recording."""
    (folder / "robot.toml").write_text(text)
    ran = experiment("robot.toml", "--quiet", cwd=folder)
    assert ran.returncode == 0, ran.stderr
    done = experiment("export", "robot.toml", "--to", "csv,mjcf,gains", cwd=folder)
    assert done.returncode == 0 and "does not express" not in done.stdout, done.stdout + done.stderr
    exported = folder / "reports/robot/export"
    name = next(exported.glob("*validation*.csv"))
    table = pl.read_csv(name)
    gains = json.loads((exported / "gains.json").read_text())
    found = replay(exported, table, gains)
    pair = lambda name: table[name.format(1), name.format(2)].to_numpy()  # noqa: E731
    measured = pair("dalpha{}_rad_s")
    rms = lambda speeds: float(np.sqrt(np.mean((measured - speeds) ** 2)))  # noqa: E731
    return rms(found), rms(pair("dalpha{}_simulated_2s_rad_s"))


@pytest.mark.parametrize("hidden", HIDDEN)
def test_simulated_recordings_are_replayed(hidden, experiment, tmp_path):
    effects = "" if hidden == "nothing" else f'"{hidden}"'
    text = SYNTHETIC.format(hidden=HIDDEN[hidden], effects=effects)
    ours, own = errors(experiment, tmp_path, text)
    print(f"{hidden}: MuJoCo {ours:.5f}, program {own:.5f} rad/s")
    # the model is right, so that only noise is left: 0.02 rad/s on the speeds and what that of the torques makes in 2 s
    assert own < 0.04 and ours < 1.1 * own


def test_a_recording_of_another_robot_in_a_physics_engine_is_replayed(experiment, slope, tmp_path):
    ours, own = errors(experiment, tmp_path, RECORDED.format(slope=slope))
    print(f"slope: MuJoCo {ours:.5f}, program {own:.5f} rad/s")
    assert ours < 1.1 * own


def test_what_mujoco_lacks_is_said_on_the_command_line_and_in_the_file(experiment, tmp_path):
    text = SYNTHETIC.format(hidden="stribeck = { }", effects='"stribeck"')
    (tmp_path / "robot.toml").write_text(text)
    assert experiment("robot.toml", "--quiet", cwd=tmp_path).returncode == 0
    done = experiment("export", "robot.toml", "--to", "mjcf", cwd=tmp_path)
    assert "mjcf does not express stribeck" in done.stdout
    assert "Not expressed: stribeck" in (tmp_path / "reports/robot/export/robot.xml").read_text()


def test_mujoco_reads_the_urdf_with_the_same_numbers(experiment, tmp_path):
    text = SYNTHETIC.format(hidden="", effects="")
    (tmp_path / "robot.toml").write_text(text)
    assert experiment("robot.toml", "--quiet", cwd=tmp_path).returncode == 0
    assert experiment("export", "robot.toml", "--to", "mjcf,urdf", cwd=tmp_path).returncode == 0
    exported = tmp_path / "reports/robot/export"
    # of a URDF MuJoCo welds the first link to the world and drops its mass, unless told otherwise
    text = (exported / "robot.urdf").read_text()
    kept = '<mujoco><compiler fusestatic="false"/></mujoco></robot>'
    urdf = mujoco.MjModel.from_xml_string(text.replace("</robot>", kept))
    mjcf = mujoco.MjModel.from_xml_path(str(exported / "robot.xml"))
    assert urdf.body_mass.sum() == pytest.approx(mjcf.body_mass.sum(), rel=1e-9)
    for name in ("right", "left"):
        a, b = (m.dof_frictionloss[m.joint(name).dofadr[0]] for m in (urdf, mjcf))
        assert a == pytest.approx(b, rel=1e-9) and a > 0.1
