"""What `experiment export` writes, read back by other software."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import polars as pl
import pytest

FILE = """
[recordings]
train = ["{slope}/train_1.csv", "{slope}/train_2.csv"]
validation = ["{slope}/validation.csv"]

[[method]]
name = "prediction_error"

[diagnosis]
candidates = ["slope", "viscous_friction"]
max_effects = 1
"""


@pytest.fixture(scope="module")
def exported(experiment, slope, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("export")
    (folder / "slope.toml").write_text(FILE.format(slope=slope))
    before = experiment("export", "slope.toml", cwd=folder)
    assert before.returncode == 2 and "run it first" in before.stderr
    assert experiment("slope.toml", "--quiet", cwd=folder).returncode == 0
    done = experiment("export", "slope.toml", "--to", "csv,parquet,mcap,mjcf,urdf,gains", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "the model with the effects found (slope)" in done.stdout
    return folder


def results(folder: Path) -> dict:
    return json.loads((folder / "reports/slope/results.json").read_text())


def test_polars_reads_the_motion_that_results_json_judges(exported):
    table = pl.read_csv(exported / "reports/slope/export/validation.csv")
    measured = table["dalpha1_rad_s", "dalpha2_rad_s"].to_numpy()
    rms = lambda mark: np.sqrt(  # noqa: E731
        np.mean((measured - table[f"dalpha1_{mark}_rad_s", f"dalpha2_{mark}_rad_s"].to_numpy()) ** 2)
    )
    found = results(exported)
    assert rms("simulated_2s") == pytest.approx(found["methods"][0]["window_rms"]["validation"][0], rel=1e-9)
    last = found["diagnosis"]["staircase"][-1]
    assert rms("simulated_2s_with_effects") == pytest.approx(last["window_rms_validation"], rel=1e-6)
    assert table.columns[:7] == [
        "t_s", "alpha1_rad", "alpha2_rad", "dalpha1_rad_s", "dalpha2_rad_s", "input1_N_m", "input2_N_m",
    ]  # fmt: skip
    assert {"slope_torque1_N_m", "slope_torque2_N_m"} <= set(table.columns)


def test_pyarrow_finds_the_same_numbers(exported):
    parquet = pytest.importorskip("pyarrow.parquet")
    folder = exported / "reports/slope/export"
    table = pl.read_csv(folder / "validation.csv")
    arrow = parquet.read_table(folder / "validation.parquet")
    assert arrow.column_names == table.columns
    for name in table.columns:
        assert np.array_equal(arrow[name].to_numpy(), table[name].to_numpy(), equal_nan=True), name


def test_the_protobuf_reader_of_mcap_finds_the_same_numbers(exported):
    """The reference implementation of Protocol Buffers."""
    pytest.importorskip("mcap_protobuf")
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory

    folder = exported / "reports/slope/export"
    table = pl.read_csv(folder / "validation.csv")
    with open(folder / "validation.mcap", "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        decoded = list(reader.iter_decoded_messages())
    assert len(decoded) == table.height
    assert {(schema.name, channel.topic) for schema, channel, *_ in decoded} == {("amigo_ident.Motion", "/validation")}
    t = table["t_s"].to_numpy()
    assert np.allclose([message.log_time * 1e-9 for _, _, message, _ in decoded], t - t[0], atol=1e-9)
    fields = [field.name for field in decoded[0][3].DESCRIPTOR.fields]
    assert fields == table.columns[1:]
    for name in fields:
        values = np.array([getattr(row, name) for *_, row in decoded])
        assert np.array_equal(values, table[name].to_numpy(), equal_nan=True), name


def test_rerun_decodes_the_columns_of_the_mcap_file(exported):
    chunk = pytest.importorskip("rerun.chunk")
    folder = exported / "reports/slope/export"
    table = pl.read_csv(folder / "validation.csv")
    rows = []
    for piece in chunk.McapReader(folder / "validation.mcap").stream():
        batch = piece.to_record_batch()
        for name in batch.schema.names:
            if name.endswith("amigo_ident.Motion:message"):
                rows += [row[0] for row in batch[name].to_pylist()]
    assert len(rows) == table.height
    for name in table.columns[1:]:
        values = np.array([row[name] for row in rows])
        assert np.array_equal(values, table[name].to_numpy(), equal_nan=True), name


def test_a_run_of_another_file_is_not_exported(experiment, exported):
    file = exported / "slope.toml"
    text = file.read_text()
    file.write_text(text.replace("max_effects = 1", "max_effects = 2"))
    try:
        refused = experiment("export", "slope.toml", cwd=exported)
    finally:
        file.write_text(text)
    assert refused.returncode == 2 and "was changed since its last run" in refused.stderr
    unknown = experiment("export", "slope.toml", "--to", "cvs", cwd=exported)
    assert unknown.returncode == 2 and "csv, parquet, mcap" in unknown.stderr


def test_urdf_and_sdf_hold_the_identified_numbers(exported):
    folder = exported / "reports/slope/export"
    values = {p["symbol"]: p["value"] for p in results(exported)["diagnosis"]["parameters"]}
    urdf = ElementTree.parse(folder / "robot.urdf").getroot()
    r = float(urdf.find("link[@name='right_wheel']/collision/geometry/sphere").get("radius"))
    mass = sum(float(link.find("inertial/mass").get("value")) for link in urdf.findall("link"))
    spin = float(urdf.find("link[@name='right_wheel']/inertial/inertia").get("iyy"))
    # eq. (15): a1 + a2 = r² M/2 + inertia of a wheel about its axle
    assert r * r * mass / 2 + spin == pytest.approx(values["a1"] + values["a2"], rel=1e-9)
    friction = float(urdf.find("joint[@name='left']/dynamics").get("friction"))
    assert friction == pytest.approx(values["a5"], rel=1e-12)
    sdf = ElementTree.parse(folder / "robot.sdf").getroot()
    assert float(sdf.find(".//joint[@name='left']/axis/dynamics/friction").text) == friction
    assert "Not expressed: inclined floor" in (folder / "robot.urdf").read_text()


def test_gains_are_those_of_the_equations_and_the_code_gives_the_torque_of_the_model(exported):
    folder = exported / "reports/slope/export"
    gains = json.loads((folder / "gains.json").read_text())
    values = {p["symbol"]: p["value"] for p in results(exported)["diagnosis"]["parameters"]}
    r, track = gains["wheel_radius_m"]["value"], gains["track_width_m"]["value"]
    assert (r, track) == (0.05, 0.24)
    # the weight of the slope has no part in it: its mean over all headings is zero
    assert gains["linear"]["kS"] == pytest.approx(0.5 * (values["a4"] + values["a5"]), rel=1e-6)
    assert gains["linear"]["kA"] == pytest.approx((values["a1"] + values["a2"]) / r, rel=1e-9)
    assert gains["angular"]["kA"] == pytest.approx((values["a1"] - values["a2"]) * track / 2 / r, rel=1e-9)
    assert gains["not_identified"] == [] and gains["moment_of_inertia_kg_m2"]["value"] > 0
    for mode in ("linear", "angular"):
        assert 0 < gains["std_error"][mode]["kA"] < 0.1 * gains[mode]["kA"]
    code: dict = {}
    exec((folder / "feedforward.py").read_text(), code)
    right, left = code["feedforward"](0.5, 1.0, 0.0, 0.0)
    expected = gains["linear"]["kS"] + 0.5 * gains["linear"]["kV"] + gains["linear"]["kA"]
    assert right == left == pytest.approx(expected, rel=1e-12)
    for mode in gains["control"].values():
        assert mode["pi_margins"]["phase_deg"] > 45 and mode["pi_margins"]["gain"] > 2
        assert mode["lqr_margins"]["phase_deg"] is None or mode["lqr_margins"]["phase_deg"] > 45
