"""Gains of a real robot against those that its team published."""

from __future__ import annotations

import json

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
name = "torque_regression"
"""


def test_straights_of_frc_7028_give_the_published_gains(experiment, tmp_path):
    if not FOLDER.is_dir():
        pytest.skip("the recordings of FRC 7028 are not beside the checkout")
    runs = sorted(FOLDER.glob("0317_straight_*_*.csv"))
    assert len(runs) == 4
    train = ", ".join(json.dumps(str(run)) for run in runs)
    (tmp_path / "frc.toml").write_text(FILE.format(train=train))
    ran = experiment("frc.toml", "--quiet", cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    done = experiment("export", "frc.toml", "--to", "gains,mjcf", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    gains = json.loads((tmp_path / "reports/frc/export/gains.json").read_text())
    linear = gains["linear"]
    print(linear, gains["angular"], gains["moment_of_inertia_kg_m2"])
    # published by the team, by WPILib's SysId on straights: another regression of the same samples
    assert linear["kS"] == pytest.approx(0.709, rel=0.1)
    assert linear["kV"] == pytest.approx(2.483, rel=0.05)
    assert linear["kA"] == pytest.approx(0.297, rel=0.1)
    assert gains["units"]["linear"] == "V, V s/m, V s^2/m"
    assert gains["track_width_m"]["value"] == pytest.approx(0.6608, rel=0.02)
    assert "the input is in V" in done.stdout
