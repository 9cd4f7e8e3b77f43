"""Comparisons and diagnoses."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from . import _native
from ._fit import PARAMETERS, Fit, plan
from ._recording import RecordingLike, common, recording_list
from ._settings import Effect, EffectLike, Settings, effect_list


class Study:
    """All results of an experiment."""

    def __init__(self, native: _native.Study, plan: _native.Plan) -> None:
        self._native = native
        self._plan = plan
        #: The content of ``results.json``; its layout is that of the command line.
        self.results: dict[str, Any] = json.loads(native.results())
        #: Warnings on recordings and settings, in sentences.
        self.warnings: list[str] = plan.warnings

    @property
    def error(self) -> float:
        """RMSE of the wheel speeds over 2 s simulations on the validation recordings (on the training
        recordings where there are none) [rad/s]."""
        error = self._native.error_and_floor[0]
        return float("nan") if error is None else error

    @property
    def floor(self) -> float:
        """The same error if noise alone were left [rad/s]."""
        return self._native.error_and_floor[1]

    @property
    def methods(self) -> pl.DataFrame:
        """One row per method: ``method``, ``status``, ``seconds`` [s], and 2 s simulation error
        [rad/s] and ISE [rad²/s] on training and validation recordings (lists, one entry per recording)."""
        rows = [
            {
                "method": m["method"],
                "status": m["status"],
                "seconds": m["seconds"],
                "window_rms_train": m["window_rms"]["train"],
                "window_rms_validation": m["window_rms"]["validation"],
                "ise_train": m["ise"]["train"],
                "ise_validation": m["ise"]["validation"],
            }
            for m in self.results["methods"]
        ]
        return pl.DataFrame(rows)

    @property
    def parameters(self) -> pl.DataFrame:
        """One row per method and parameter: ``method``, then as :attr:`Fit.parameters`."""
        rows = [
            {"method": m["method"], **_parameter(p)}
            for m in self.results["methods"]
            for p in m["parameters"]
        ]
        schema = {"method": pl.String, **{k: v for k, v in PARAMETERS.items() if k != "fixed"}}
        return pl.DataFrame(rows, schema=schema)

    @property
    def recordings(self) -> pl.DataFrame:
        """One row per recording: ``role``, ``file``, ``samples``, ``duration_s``."""
        keys = ("role", "file", "samples", "duration_s")
        return pl.DataFrame([{k: r[k] for k in keys} for r in self.results["recordings"]])

    @property
    def failures(self) -> pl.DataFrame:
        """Where the model fails: one row per driving regime and wheel, as in ``results.json``."""
        return pl.DataFrame(self.results["failures"])

    def overlay(self, recording: int | str | None = None) -> pl.DataFrame:
        """Measured and simulated motion of a recording, with the residual torque.

        :param recording: its name or number; the first judged one unless given.
        :returns: one row per sample; the unit stands in the name of each column.
        """
        columns = self._native.overlay(self._number(recording))
        return pl.DataFrame({name: np.frombuffer(values) for name, values in columns})

    def svg(self, recording: int | str | None = None) -> str:
        """Measured and simulated wheel speeds of a recording as an SVG picture."""
        return self._native.svg(self._number(recording))

    def report(self, path: str | os.PathLike[str]) -> Path:
        """Writes the full report, one self-contained HTML file; returns its path."""
        path = Path(path)
        path.write_text(self._native.report(), encoding="utf-8")
        return path

    def write(self, out: str | os.PathLike[str] = "reports") -> Path:
        """Writes the result folder of the command line under ``out``: report, figures, ``results.json``, the
        identified model as code. Returns the path of the report."""
        return Path(self._plan.write(self._native, os.fspath(out)))

    def _number(self, recording: int | str | None) -> int:
        if recording is None:
            return self._native.judged[0]
        if isinstance(recording, int):
            return recording
        names = [r["file"] for r in self.results["recordings"]]
        if recording not in names:
            raise KeyError(f"{recording}; recordings are {', '.join(names)}")
        return names.index(recording)

    def _words(self) -> str:
        return f"2 s simulation error {self.error:.4g} rad/s, noise floor {self.floor:.4g} rad/s"

    def __repr__(self) -> str:
        return f"{type(self).__name__}: {self._words()}"

    def _repr_html_(self) -> str:
        return f"<p><b>{html.escape(self._words())}</b></p>{self.svg()}"


class Comparison(Study):
    """A fit compared with recordings that it was not fitted to."""


class Diagnosis(Study):
    """Which physical effects are missing from a model."""

    @property
    def _found(self) -> dict[str, Any]:
        diagnosis: dict[str, Any] = self.results["diagnosis"]
        return diagnosis

    @property
    def verdict(self) -> str:
        """``model_sufficient``, ``effects_missing``, ``effect_likely`` or ``unknown_effect``."""
        return str(self._found["verdict"])

    @property
    def sentence(self) -> str:
        """The verdict in words, with the error that is left."""
        return str(self._found["sentence"])

    @property
    def found(self) -> list[str]:
        """Ids of the missing effects, in the order in which they were found."""
        return list(self._found["found"])

    @property
    def likely(self) -> list[str]:
        """Ids of effects that lower the held-out error without being significant."""
        return list(self._found["likely"])

    @property
    def next_run(self) -> str | None:
        """What to record next, in words."""
        return self._found["next_run"]  # type: ignore[no-any-return]

    @property
    def formula(self) -> Effect | None:
        """The dependence of the residual torque as an effect, where an effect outside the catalogue is missing and a
        formula explains most of it: ``diagnose(..., effects=[diagnosis.formula])`` adds it to the model."""
        keys = self._found["formula"]
        if keys is None:
            return None
        return Effect(
            id=keys["id"],
            torque1=keys["torque1"],
            torque2=keys["torque2"],
            parameters=keys["parameters"],
            description=keys["description"],
        )

    @property
    def ranking(self) -> pl.DataFrame:
        """The candidates, best first: ``effect``, ``probability``, ``delta_bic``, ``p_value``, 2 s simulation
        error [rad/s] before and after, ``indistinguishable`` effects, ``parameters``."""
        rows = [
            {
                "effect": c["effect"],
                "probability": c["probability"],
                "delta_bic": c["delta_bic"],
                "p_value": c["p_value"],
                "window_rms_before": c["window_rms_validation_before"],
                "window_rms_after": c["window_rms_validation_after"],
                "indistinguishable": c["indistinguishable"],
                "parameters": [
                    {k: p[k] for k in ("symbol", "value", "std_error", "unit")} for p in c["parameters"]
                ],
            }
            for c in self._found["ranking"]
        ]
        return pl.DataFrame(rows, infer_schema_length=None)

    @property
    def staircase(self) -> pl.DataFrame:
        """Error by model version: ``added`` (``None`` for the model as given), ``ise_validation`` [rad²/s],
        ``window_rms_validation`` [rad/s]."""
        return pl.DataFrame(self._found["staircase"], infer_schema_length=None)

    @property
    def model_parameters(self) -> pl.DataFrame:
        """Parameters of the model with all effects found, as :attr:`Fit.parameters`."""
        rows = [_parameter(p) for p in self._found["parameters"]]
        return pl.DataFrame(rows, schema={k: v for k, v in PARAMETERS.items() if k != "fixed"})

    def _words(self) -> str:
        return self.sentence


def _parameter(p: Mapping[str, Any]) -> dict[str, Any]:
    low, high = p["ci95"]
    keys = ("symbol", "value", "std_error", "unit", "identifiable")
    return {**{k: p[k] for k in keys}, "low": low, "high": high}


def compare(fit: Fit, validation: RecordingLike | Iterable[RecordingLike]) -> Comparison:
    """Simulates a fit on recordings that it was not fitted to and compares the error with their noise floor.

    :param validation: recordings, paths, or frames.
    """
    held = recording_list(validation, "validation")
    common(fit._train + held)
    made = plan(fit._settings, fit._train, held)
    return Comparison(made.compare(fit._native), made)


def diagnose(
    recordings: RecordingLike | Iterable[RecordingLike],
    validation: RecordingLike | Iterable[RecordingLike] | None = None,
    effects: EffectLike | Iterable[EffectLike] = (),
    *,
    candidates: EffectLike | Iterable[EffectLike] = "all",
    false_alarm: float = 0.05,
    max_effects: int = 3,
    fixed: Mapping[str, float | str] | None = None,
    hold: str | None = None,
    method: str = "prediction_error",
    **options: Any,
) -> Diagnosis:
    """Finds out which physical effects are missing from a model.

    :param recordings: recordings to fit, paths, or frames.
    :param validation: held-out recordings; without any, the training recordings are cross-validated.
    :param effects: effects that the model has already.
    :param candidates: effects to try: ``"all"``, or ids and formulas of one or several.
    :param false_alarm: largest probability that an effect is named where none is missing.
    :param max_effects: most effects that are added.
    """
    train = recording_list(recordings, "recordings")
    held = recording_list(validation, "validation")
    asked = () if candidates == "all" else effect_list(candidates)
    ids = "all" if candidates == "all" else [e.id if isinstance(e, Effect) else e for e in asked]
    robot, conditioning = common(train + held)
    settings = Settings(
        robot=robot,
        conditioning=conditioning,
        effects=effect_list(effects),
        custom=[e for e in asked if isinstance(e, Effect)],
        fixed=dict(fixed or {}),
        method=method,
        options=options,
        hold=hold,
    )
    keys = {"candidates": ids, "false_alarm": false_alarm, "max_effects": max_effects}
    made = plan(settings, train, held, keys)
    return Diagnosis(made.run(), made)
