"""Gains of a real robot against those that its team published."""

from __future__ import annotations

import json

import numpy as np
import polars as pl
import pytest

from conftest import ROOT

FOLDER = ROOT.parent / "shared" / "recordings" / "frc7028_2022"
FILE = """
[robot]
preset = "frc_tank_drive"

[recordings]
train = [{train}]
drive_unit = "V"
hold = "constant"

[recordings.columns]
alpha1 = {{ name = "right_rev", unit = "rev" }}
alpha2 = {{ name = "left_rev", unit = "rev" }}
dalpha1 = {{ name = "right_rev_per_s", unit = "rev/s" }}
dalpha2 = {{ name = "left_rev_per_s", unit = "rev/s" }}
M1 = "right_volts"
M2 = "left_volts"

[model]
effects = ["back_emf"]

[[method]]
name = "{method}"
"""


PUBLISHED = {"kS": 0.709, "kV": 2.483, "kA": 0.297}
STEPS = 20


@pytest.fixture(scope="module")
def runs():
    if not FOLDER.is_dir():
        pytest.skip("the recordings of FRC 7028 are not beside the checkout")
    found = sorted(FOLDER.glob("0317_straight_*_*.csv"))
    assert len(found) == 4
    return found


def gains_of(experiment, folder, runs, method):
    """Gains by a method, the folder that holds them, and what was printed."""
    text = FILE.format(train=", ".join(json.dumps(str(run)) for run in runs), method=method)
    (folder / "frc.toml").write_text(text)
    ran = experiment("frc.toml", "--quiet", cwd=folder)
    assert ran.returncode == 0, ran.stderr
    done = experiment("export", "frc.toml", "--to", "gains,mjcf", cwd=folder)
    assert done.returncode == 0, done.stderr
    written = folder / "reports/frc/export"
    return json.loads((written / "gains.json").read_text()), written, done.stdout


def test_straights_of_frc_7028_give_the_published_gains(experiment, runs, tmp_path):
    gains, written, printed = gains_of(experiment, tmp_path, runs, "torque_regression")
    linear = gains["linear"]
    # published by the team, by WPILib's SysId on straights: another regression of the same samples
    for key, within in (("kS", 0.1), ("kV", 0.05), ("kA", 0.1)):
        print(f"{key}: {linear[key]:.4f} ± {gains['std_error']['linear'][key]:.4f}, published {PUBLISHED[key]}")
        assert linear[key] == pytest.approx(PUBLISHED[key], rel=within), key
    # straights alone do not show how hard it is to turn
    assert gains["moment_of_inertia_kg_m2"]["value"] is None
    assert len(gains["not_identified"]) == 1 and gains["not_identified"][0].startswith("angular kA")
    assert gains["not_identified"][0] in printed
    assert gains["not_identified"][0] in (written / "feedforward.py").read_text()
    assert gains["units"]["linear"] == "V, V s/m, V s^2/m"
    assert gains["track_width_m"]["value"] == pytest.approx(0.6608, rel=0.02)
    assert "the input is in V" in printed


def error(gains: dict, radius: float, runs: list) -> float:
    """RMSE of the mean wheel speed over simulations of 2 s of kA dv/dt = u - kS sgn v - kV v [rad/s]."""
    errors = []
    for run in runs:
        table = pl.read_csv(run, infer_schema_length=None)
        mean = lambda name: 0.5 * sum(table[f"{side}_{name}"] for side in ("right", "left")).to_numpy()  # noqa: E731
        t, u, w = table["t"].to_numpy(), mean("volts"), 2 * np.pi * mean("rev_per_s")
        start, x = 0, w[0]
        for k in range(1, len(t)):
            if t[k] - t[start] >= 2:
                start, x = k, w[k]
            else:
                h = (t[k] - t[k - 1]) / STEPS
                for _ in range(STEPS):
                    towards = np.sign(x) if x != 0 else np.sign(u[k - 1]) * (abs(u[k - 1]) > gains["kS"])
                    drive = u[k - 1] * (x != 0 or towards != 0)
                    moved = x + h * (drive - gains["kS"] * towards - gains["kV"] * radius * x) / (gains["kA"] * radius)
                    x = 0.0 if moved * x < 0 else moved
            errors.append(x - w[k])
    return float(np.sqrt(np.mean(np.square(errors))))


def test_gains_of_the_default_method_simulate_better_than_the_published(experiment, runs, tmp_path):
    gains, _, _ = gains_of(experiment, tmp_path, runs, "prediction_error")
    radius = gains["wheel_radius_m"]["value"]
    own, published = error(gains["linear"], radius, runs), error(PUBLISHED, radius, runs)
    print(f"{gains['linear']} {gains['std_error']['linear']}: {own:.2f}, published {published:.2f} rad/s")
    assert own < 0.7 * published
