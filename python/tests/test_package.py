"""Recordings, fits, simulation, pictures, errors."""

from __future__ import annotations

import ast
import threading
import time
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import polars as pl
import pytest

import amigo_ident as ai
from amigo_ident import _native


@pytest.fixture(scope="module")
def train(slope):
    return ai.Recording.read(slope / "train_1.csv", robot="amigobot")


@pytest.fixture(scope="module")
def fit(train):
    return ai.identify(train, effects=["slope"], method="weak_form")


def test_a_recording_has_the_values_of_its_file(slope, train):
    table = pl.read_csv(slope / "train_1.csv")
    assert train.samples == table.height and train.sha256 is not None
    for key, values in (("alpha", train.alpha), ("dalpha", train.dalpha), ("M", train.inputs)):
        assert np.array_equal(values, table[f"{key}1", f"{key}2"].to_numpy())
    assert np.array_equal(train.t, table["t"].to_numpy())
    assert train.frame().columns == ["t", "alpha1", "alpha2", "dalpha1", "dalpha2", "M1", "M2"]
    assert abs(train.noise["omega"][0] - 0.005) < 0.001  # recordings/README.md


def test_columns_of_other_names_and_units_are_converted(slope, train):
    table = pl.read_csv(slope / "train_1.csv")
    rpm = 60 / (2 * np.pi)
    other = table.select(
        pl.col("t").alias("time"),
        (pl.col("dalpha1") * rpm).alias("right"),
        (-pl.col("dalpha2") * rpm).alias("left"),
        "M1",
        "M2",
        pl.lit("text").alias("remark"),
    )
    columns = {
        "t": "time",
        "dalpha1": {"name": "right", "unit": "rpm"},
        "dalpha2": {"name": "left", "unit": "rpm", "scale": -1},
    }
    recording = ai.Recording.from_frame(other, columns)
    assert np.allclose(recording.dalpha, train.dalpha, rtol=1e-14, atol=0)


def test_a_constant_torque_accelerates_as_the_equations_say(fit):
    base = ai.identify(fit._train, method="weak_form")
    t = np.linspace(0, 1, 101)
    torque = 0.3
    _, dalpha = base.simulate(t, np.full((101, 2), torque))
    # a3 vanishes on a straight; both wheels have the same torque, so (a1 + a2) dw = M - a4 if a4 = a5
    a1, a2, a4, a5 = (base[s] for s in ("a1", "a2", "a4", "a5"))
    mean = (torque - 0.5 * (a4 + a5)) / (a1 + a2)
    # the wheels differ by a4 - a5 only, of which the mean is free to first order
    assert abs(dalpha[-1].mean() - mean) < 1e-3 * mean


def test_the_fit_simulates_the_recording_it_was_fitted_to(train, fit):
    first = slice(0, 400)  # 2 s
    _, dalpha = fit.simulate(
        train.t[first], train.inputs[first], tuple(train.alpha[0]), tuple(train.dalpha[0])
    )
    error = np.sqrt(np.mean((dalpha - train.dalpha[first]) ** 2))
    top = np.abs(train.dalpha[first]).max()
    assert top > 1 and error < 0.05 * top


def test_a_formula_gives_the_estimate_of_the_same_effect_in_the_catalogue(train):
    own = ai.Effect("my_drag", "k_d * w", {"k_d": "N m s/rad"})
    by_formula = ai.identify(train, effects=[own], method="weak_form")
    by_name = ai.identify(train, effects="viscous_friction", method="weak_form")
    # the same columns in the same order: rounding only
    assert by_formula["k_d"] == pytest.approx(by_name["b"], rel=1e-9)
    assert by_formula["a1"] == pytest.approx(by_name["a1"], rel=1e-9)


def test_what_the_catalogue_does_not_have_is_an_effect_to_add(train):
    study = ai.Experiment.from_toml(
        Path(__file__).resolve().parents[2] / "experiments" / "outside_catalogue.toml"
    ).run()
    assert study.verdict == "unknown_effect" and study.found == []
    assert study.formula.id == "heading_resistance"
    fit = ai.identify(train, effects=[study.formula], method="weak_form")
    assert all(np.isfinite(fit[symbol]) for symbol in study.formula.parameters)


def test_corrections_can_be_left_out(slope):
    table = pl.read_csv(slope / "train_1.csv")
    wrong = table.with_columns(dalpha1=pl.when(pl.int_range(pl.len()) == 900).then(400.0).otherwise("dalpha1"))
    corrected = ai.Recording.from_frame(wrong)
    assert abs(corrected.dalpha[900, 0]) < 50 and any("spike" in found for found in corrected.findings)
    assert ai.Recording.from_frame(wrong, conditioning={"spikes": False}).dalpha[900, 0] == 400
    with pytest.raises(ai.InputError, match="spike"):
        ai.Recording.from_frame(wrong, conditioning={"spike": False})
    with pytest.raises(ai.InputError, match="different conditioning"):
        ai.identify([wrong, ai.Recording.from_frame(wrong, conditioning={"spikes": False})])


def test_errors_name_what_was_found_and_what_is_expected(slope, train, fit, tmp_path):
    with pytest.raises(ai.InputError, match="no effect is called|unknown effect|did you mean `slope`"):
        ai.identify(train, effects=["slop"])
    with pytest.raises(ai.InputError, match="no method is called `weak`"):
        ai.identify(train, method="weak")
    with pytest.raises(ai.InputError, match="horizon"):
        ai.identify(train, method="prediction_error", horizon=1.0)
    with pytest.raises(ai.InputError, match=r"drive_unit = \"Nm\""):
        ai.Recording.read(slope / "train_1.csv", drive_unit="Nm")
    with pytest.raises(ai.InputError, match="missing.csv"):
        ai.Recording.read(tmp_path / "missing.csv")
    with pytest.raises(ai.InputError, match="M2"):
        ai.Recording.from_frame(pl.DataFrame({"t": [0.0], "dalpha1": [0.0], "dalpha2": [0.0], "M1": [0.0]}))
    with pytest.raises(ai.InputError, match=r"t\[1\] = 0 s does not exceed 0 s"):
        fit.simulate([0.0, 0.0], np.zeros((2, 2)))
    with pytest.raises(ai.InputError, match=r"shape \(2, 2\)"):
        fit.simulate([0.0, 1.0], np.zeros((3, 2)))
    with pytest.raises(ai.ColumnError, match=r"columns=.*from_recordings"):
        ai.Recording.from_frame(pl.DataFrame({"time": [0.0], "dalpha1": [0.0], "dalpha2": [0.0], "M1": [0.0]}))
    with pytest.raises(ValueError):  # an InputError is one
        ai.identify([])
    still = np.zeros((200, 2))
    with pytest.raises(ai.AmigoError):
        ai.identify(ai.Recording.from_arrays(np.arange(200) * 0.01, still, dalpha=still))


def test_other_threads_run_during_a_computation(train):
    ticks = 0
    done = threading.Event()

    def compute():
        ai.identify(train)
        done.set()

    worker = threading.Thread(target=compute)
    start = time.perf_counter()
    worker.start()
    while not done.is_set():
        time.sleep(0.001)
        ticks += 1
    worker.join()
    # with the lock held, this loop would turn once or twice
    assert time.perf_counter() - start > 0.05 and ticks > 10


def test_the_overlay_is_that_of_the_comparison_and_its_residual_shows_the_slope(slope, train):
    fit = ai.identify(train, method="weak_form")
    validation = ai.Recording.read(slope / "validation.csv", robot="amigobot")
    comparison = ai.compare(fit, validation)
    table = comparison.overlay("validation.csv")
    error = table["dalpha1_rad_s", "dalpha2_rad_s"].to_numpy() - table[
        "dalpha1_simulated_2s_rad_s", "dalpha2_simulated_2s_rad_s"
    ].to_numpy()
    assert np.sqrt(np.mean(error**2)) == pytest.approx(comparison.error, rel=1e-12)
    # the slope's torque, m g r sin(0.015 rad)/2 = 0.013 N m, varies sinusoidally with heading
    heading = 0.05 / 0.24 * (table["alpha1_rad"] - table["alpha2_rad"]).to_numpy()
    mean = 0.5 * (table["residual_torque1_N_m"] + table["residual_torque2_N_m"]).to_numpy()
    kept = np.isfinite(mean)
    columns = np.stack([np.cos(heading), np.sin(heading), np.ones_like(heading)], axis=1)[kept]
    size = np.hypot(*np.linalg.lstsq(columns, mean[kept], rcond=None)[0][:2])
    assert kept.mean() > 0.5 and 0.009 < size < 0.017


def test_a_notebook_shows_the_verdict_and_a_picture(slope, train, tmp_path):
    validation = ai.Recording.read(slope / "validation.csv", robot="amigobot")
    diagnosis = ai.diagnose(train, validation, candidates=["slope"], max_effects=1)
    shown = diagnosis._repr_html_()
    assert "slope" in shown.split("<svg")[0]
    picture = ElementTree.fromstring(diagnosis.svg())
    assert picture.tag.endswith("svg")
    # text is drawn as outlines; the model with the effect is one more curve a panel, of dashes
    plain = ai.compare(ai.identify(train, method="weak_form"), validation).svg()
    assert diagnosis.svg().count("<path") > 2 * plain.count("<path")
    assert diagnosis.sentence in repr(diagnosis)
    table = diagnosis.overlay()
    assert {"slope_torque1_N_m", "residual_torque1_with_effects_N_m"} <= set(table.columns)
    before, after = (
        np.nanstd(table[f"residual_torque1{mark}_N_m"].to_numpy()) for mark in ("", "_with_effects")
    )
    assert after < before
    report = diagnosis.report(tmp_path / "report.html").read_text()
    assert report.startswith("<!DOCTYPE html>") and "slope" in report
    symbols = diagnosis.model_parameters["symbol"].to_list()
    assert symbols[:5] == ["a1", "a2", "a3", "a4", "a5"]


def test_the_catalogues_are_frames():
    effects, methods = ai.effects(), ai.methods()
    assert {"inertia", "slope", "turning_scrub"} <= set(effects["id"])
    b = effects.filter(pl.col("id") == "viscous_friction")["parameters"][0][0]
    assert (b["symbol"], b["unit"]) == ("b", "N m s/rad")
    assert "prediction_error" in methods["name"]


def test_every_public_name_has_a_docstring_and_the_stub_is_that_of_the_module():
    for name in ai.__all__:
        thing = getattr(ai, name)
        if callable(thing):
            assert thing.__doc__, name
            members = vars(thing).items() if isinstance(thing, type) else []
            for member, value in members:
                if not member.startswith("_") and (callable(value) or isinstance(value, (property, classmethod))):
                    assert value.__doc__, f"{name}.{member}"
    folder = Path(ai.__file__).parent
    assert (folder / "py.typed").is_file()
    stub = ast.parse((folder / "_native.pyi").read_text())
    functions = {n.name for n in stub.body if isinstance(n, ast.FunctionDef)}
    assert functions == {n for n in dir(_native) if callable(getattr(_native, n)) and n.islower()}
    for node in (n for n in stub.body if isinstance(n, ast.ClassDef)):
        stubbed = {m.name for m in node.body if isinstance(m, ast.FunctionDef)} - {"__init__"}
        assert stubbed == {m for m in vars(getattr(_native, node.name)) if not m.startswith("_")}


@pytest.mark.parametrize("unit", ["ms", "us", "ns"])
def test_dates_and_durations_are_seconds(slope, train, unit):
    table = pl.read_csv(slope / "train_1.csv")
    # 5 ms a row is a whole number in each unit
    of_day = pl.datetime(2026, 3, 1, time_unit="us") + pl.duration(microseconds=(pl.col("t") * 1e6).round().cast(pl.Int64))
    dated = table.with_columns(t=of_day.dt.cast_time_unit(unit))
    lasting = table.with_columns(t=(of_day - pl.datetime(2026, 3, 1)).dt.cast_time_unit(unit))
    for frame in (dated, lasting, dated.lazy(), dated.to_pandas(), dated.to_pandas().set_index("t")):
        taken = ai.Recording.from_frame(frame)
        assert taken.samples == train.samples
        assert np.allclose(taken.t - taken.t[0], train.t - train.t[0], atol=1e-9)


def test_an_index_of_dates_with_a_zone_is_the_time(slope, train):
    frame = pl.read_csv(slope / "train_1.csv").to_pandas()
    frame.index = pd.Timestamp("2026-03-01", tz="Europe/Warsaw") + pd.to_timedelta(frame.pop("t"), unit="s")
    frame.index.name = None
    assert np.allclose(ai.Recording.from_frame(frame).t, train.t - train.t[0], atol=1e-8)


def test_no_robot_is_assumed(slope):
    study = ai.diagnose(ai.Recording.read(slope / "train_1.csv"), candidates=["turning_scrub"])
    assert study.results["robot"] == "unknown"
    with pytest.raises(ai.InputError, match="`slope` depends on the distance between the wheels"):
        ai.identify(slope / "train_1.csv", effects=["slope"])


def test_simulate_is_that_of_the_fit(fit, train):
    alpha, dalpha = ai.simulate(fit, train.t, train.inputs)
    assert np.array_equal(dalpha, fit.simulate(train.t, train.inputs)[1]) and alpha.shape == dalpha.shape
