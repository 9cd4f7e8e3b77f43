"""Numbers are those of results.json, whatever the data come from."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import polars as pl
import pytest

import amigo_ident as ai

FILE = """
[recordings]
train = ["{slope}/train_1.csv", "{slope}/train_2.csv"]
validation = ["{slope}/validation.csv"]

[[method]]
name = "prediction_error"

[diagnosis]
candidates = ["slope", "viscous_friction", "turning_scrub"]
max_effects = 2
"""
CANDIDATES = ["slope", "viscous_friction", "turning_scrub"]


def results_of(experiment, folder, text):
    (folder / "slope.toml").write_text(text)
    ran = experiment("slope.toml", "--quiet", cwd=folder)
    assert ran.returncode == 0, ran.stderr
    return json.loads((folder / "reports/slope/results.json").read_text())


@pytest.fixture(scope="module")
def expected(experiment, slope, tmp_path_factory):
    folder = tmp_path_factory.mktemp("diagnosed")
    return results_of(experiment, folder, FILE.format(slope=slope))


@pytest.fixture(scope="module")
def compared(experiment, slope, tmp_path_factory):
    """The same without a diagnosis, whose noise floor is that of the model with what was found."""
    folder = tmp_path_factory.mktemp("compared")
    return results_of(experiment, folder, FILE.format(slope=slope).split("[diagnosis]")[0])


def as_path(path):
    return ai.Recording.read(path, robot="amigobot")


def as_polars(path):
    return ai.Recording.from_frame(pl.read_csv(path), name=path.name, robot="amigobot")


def as_pandas(path):
    return ai.Recording.from_frame(pd.read_csv(path), name=path.name, robot="amigobot")


def as_arrays(path):
    table = np.genfromtxt(path, delimiter=",", names=True)
    pair = lambda key: np.stack([table[f"{key}1"], table[f"{key}2"]], axis=1)  # noqa: E731
    return ai.Recording.from_arrays(
        table["t"],
        pair("M"),
        dalpha=pair("dalpha"),
        alpha=pair("alpha"),
        name=path.name,
        robot="amigobot",
    )


def without_times(results):
    """Numbers alone: wall times and the place of the file differ from run to run."""
    methods = [{k: v for k, v in m.items() if k != "seconds"} for m in results["methods"]]
    return {"methods": methods, **{k: results[k] for k in ("noise_floor", "failures", "diagnosis")}}


@pytest.mark.parametrize("source", [as_path, as_polars])
def test_a_diagnosis_has_the_numbers_of_the_command_line(source, slope, expected):
    train = [source(slope / f"train_{k}.csv") for k in (1, 2)]
    found = ai.diagnose(
        train, source(slope / "validation.csv"), candidates=CANDIDATES, max_effects=2
    )
    assert without_times(found.results) == without_times(expected)
    assert found.found == expected["diagnosis"]["found"] == ["slope"]
    assert found.verdict == "effects_missing"
    assert found.ranking["effect"].to_list() == [c["effect"] for c in expected["diagnosis"]["ranking"]]
    steps = [s["window_rms_validation"] for s in expected["diagnosis"]["staircase"]]
    assert found.staircase["window_rms_validation"].to_list() == steps


@pytest.mark.parametrize("source", [as_path, as_polars, as_pandas, as_arrays])
def test_a_fit_and_its_comparison_have_the_numbers_of_the_command_line(source, slope, compared):
    method = compared["methods"][0]
    fit = ai.identify([source(slope / f"train_{k}.csv") for k in (1, 2)])
    values = {p["symbol"]: p["value"] for p in method["parameters"]}
    assert dict(zip(fit.parameters["symbol"], fit.parameters["value"])) == values
    comparison = ai.compare(fit, source(slope / "validation.csv"))
    assert comparison.results["methods"][0]["window_rms"] == method["window_rms"]
    assert comparison.results["noise_floor"] == compared["noise_floor"]
    assert comparison.error == method["window_rms"]["validation"][0]
    assert comparison.failures.height == len(compared["failures"])


def fitted(experiment, folder, files):
    """The first method of the command line on files of a folder."""
    listed = ", ".join(f'"{folder}/{name}"' for name in files)
    text = f'[recordings]\ntrain = [{listed}]\n[[method]]\nname = "prediction_error"\n'
    return results_of(experiment, folder, text)["methods"][0]


def same_numbers(fit, method):
    values = {p["symbol"]: (p["value"], p["std_error"]) for p in method["parameters"]}
    own = zip(fit.parameters["symbol"], zip(fit.parameters["value"], fit.parameters["std_error"]))
    assert dict(own) == values


@pytest.mark.parametrize("source", [as_path, as_polars])
def test_recordings_of_one_logger_are_read_together(source, experiment, slope, tmp_path):
    """A recording too short to show the noise of its sensors has that of the long one."""
    table = pl.read_csv(slope / "train_1.csv")
    table.write_csv(tmp_path / "long.csv")
    rough = np.random.default_rng(1).normal(0, 0.05, table.height)
    table.with_columns(dalpha1=table["dalpha1"] + rough)[2000:2600].write_csv(tmp_path / "short.csv")
    files = ["long.csv", "short.csv"]
    taken = [source(tmp_path / name) for name in files]
    same_numbers(ai.identify(taken), fitted(experiment, tmp_path, files))


def test_a_held_input_is_recognised_as_by_the_command_line(experiment, slope, tmp_path):
    """50 Hz, and the input jumps at every row."""
    table = pl.read_csv(slope / "train_1.csv")[::4]
    held = ai.identify(slope / "train_1.csv", hold="constant", method="weak_form")
    t, inputs = table["t"].to_numpy(), table["M1", "M2"].to_numpy()
    inputs = inputs + np.random.default_rng(2).normal(0, 0.1, inputs.shape)
    alpha, dalpha = held.simulate(t, inputs)
    noise = np.random.default_rng(3)
    alpha, dalpha = alpha + noise.normal(0, 5e-4, alpha.shape), dalpha + noise.normal(0, 5e-3, alpha.shape)
    columns = {"t": t, "M1": inputs[:, 0], "M2": inputs[:, 1]}
    for i in (0, 1):
        columns |= {f"alpha{i + 1}": alpha[:, i], f"dalpha{i + 1}": dalpha[:, i]}
    pl.DataFrame(columns).write_csv(tmp_path / "held.csv")
    fit = ai.identify(tmp_path / "held.csv")
    assert fit.hold == "constant" and ai.identify(tmp_path / "held.csv", hold="linear").hold == "linear"
    same_numbers(fit, fitted(experiment, tmp_path, ["held.csv"]))


def test_columns_of_any_names_are_found_out_as_by_the_command_line(experiment, slope, tmp_path):
    rpm = 60 / (2 * np.pi)
    for k in (1, 2):
        table = pl.read_csv(slope / f"train_{k}.csv")
        other = {"time_ms": 1000 * table["t"]}
        for side, i in (("right", 1), ("left", 2)):
            other |= {f"{side}_rpm": rpm * table[f"dalpha{i}"], f"{side}_torque_Nm": table[f"M{i}"]}
        pl.DataFrame(other).write_csv(tmp_path / f"run_{k}.csv")
    asked = ["robot.preset='amigobot'", "diagnosis.candidates=['slope']", "diagnosis.max_effects=1"]
    paths = [tmp_path / f"run_{k}.csv" for k in (1, 2)]
    loaded = ai.Experiment.from_recordings(paths, set=asked)
    assert "right_rpm" in loaded.warnings[0]
    study = loaded.run()
    options = [word for key in asked for word in ("--set", key)]
    ran = experiment("run_1.csv", "run_2.csv", "--quiet", *options, cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    expected = json.loads((tmp_path / "reports/run_1/results.json").read_text())
    assert without_times(study.results) == without_times(expected)
    with pytest.raises(ai.InputError, match="none is given"):
        ai.Experiment.from_recordings([])


def test_an_experiment_file_gives_what_the_command_line_gives(experiment, slope, expected, tmp_path):
    file = tmp_path / "slope.toml"
    file.write_text(FILE.format(slope=slope))
    study = ai.Experiment.from_toml(file).run(out=tmp_path / "reports")
    assert isinstance(study, ai.Diagnosis)
    assert without_times(study.results) == without_times(expected)
    written = json.loads((tmp_path / "reports/slope/results.json").read_text())
    assert without_times(written) == without_times(expected)
    assert (tmp_path / "reports/slope/report.html").is_file()


def test_errors_have_the_words_of_the_command_line(experiment, tmp_path):
    (tmp_path / "bad.toml").write_text("[simulation]\nsede = 1\n")
    said = experiment("bad.toml", cwd=tmp_path).stderr
    with pytest.raises(ai.InputError) as raised:
        ai.Experiment.from_toml(tmp_path / "bad.toml")
    words = str(raised.value).split(": ", 1)[1]
    assert "did you mean `seed`?" in words
    assert words in said
