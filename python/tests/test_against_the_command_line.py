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
    return ai.Recording.read(path)


def as_polars(path):
    return ai.Recording.from_frame(pl.read_csv(path), name=path.name)


def as_pandas(path):
    return ai.Recording.from_frame(pd.read_csv(path), name=path.name)


def as_arrays(path):
    table = np.genfromtxt(path, delimiter=",", names=True)
    pair = lambda key: np.stack([table[f"{key}1"], table[f"{key}2"]], axis=1)  # noqa: E731
    return ai.Recording.from_arrays(
        table["t"], pair("M"), dalpha=pair("dalpha"), alpha=pair("alpha"), name=path.name
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
