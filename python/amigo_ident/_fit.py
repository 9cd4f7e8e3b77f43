"""Identification."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import polars as pl

from . import _native
from ._recording import Recording, RecordingLike, common, recording_list
from ._settings import EffectLike, Settings, effect_list


class Fit:
    """An identified model.

    Parameters are per unit of the input: inertias in kg m² for torques, in V s²/rad for voltages.
    """

    def __init__(
        self, native: _native.Fit, settings: Settings, train: list[Recording], warnings: list[str]
    ) -> None:
        self._native = native
        self._settings = settings
        self._train = train
        #: Warnings on recordings and settings, in sentences.
        self.warnings = warnings

    @property
    def method(self) -> str:
        """The identification method."""
        return self._native.method

    @property
    def status(self) -> str:
        """``converged``, ``iteration_limit`` or ``stalled``."""
        return self._native.status

    @property
    def notes(self) -> list[str]:
        """Parameters that are not identifiable and bounds that are active, in sentences."""
        return self._native.notes

    @property
    def seconds(self) -> float:
        """Wall time [s]."""
        return self._native.seconds

    @property
    def hold(self) -> str:
        """The input between two samples as it was fitted: ``"linear"`` or ``"constant"``."""
        return self._native.hold

    @property
    def parameters(self) -> pl.DataFrame:
        """One row per parameter: ``symbol``, ``value``, ``std_error``, ``low``, ``high`` (95 % interval),
        ``unit``, ``identifiable``, ``fixed``. Empty for methods without physical parameters."""
        rows = [
            {
                "symbol": e["symbol"],
                "value": e["value"],
                "std_error": e["std_error"],
                "low": e["interval"][0],
                "high": e["interval"][1],
                "unit": e["unit"],
                "identifiable": e["identifiable"],
                "fixed": e["fixed"],
            }
            for e in json.loads(self._native.estimates())
        ]
        return pl.DataFrame(rows, schema=PARAMETERS)

    @property
    def covariance(self) -> npt.NDArray[np.float64] | None:
        """Covariance of all parameters, in the order of :attr:`parameters`."""
        rows = self._native.covariance()
        return None if rows is None else np.array(rows)

    def __getitem__(self, symbol: str) -> float:
        """The value of a parameter."""
        row = self.parameters.filter(pl.col("symbol") == symbol)
        if row.is_empty():
            raise KeyError(f"{symbol}; parameters are {', '.join(self.parameters['symbol'])}")
        return float(row["value"][0])

    def simulate(
        self,
        t: npt.ArrayLike,
        inputs: npt.ArrayLike,
        alpha0: tuple[float, float] = (0.0, 0.0),
        dalpha0: tuple[float, float] = (0.0, 0.0),
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """The motion that the model predicts from the input alone.

        :param t: time [s], shape (n,), strictly increasing.
        :param inputs: input of both wheels [N m, V or A as recorded], shape (n, 2), right wheel first.
        :param alpha0: first wheel angles [rad].
        :param dalpha0: first wheel speeds [rad/s].
        :returns: wheel angles [rad] and wheel speeds [rad/s], each of shape (n, 2).
        """
        alpha, dalpha = self._native.simulate(
            np.ascontiguousarray(t, dtype=np.float64).tobytes(),
            np.ascontiguousarray(inputs, dtype=np.float64).tobytes(),
            list(alpha0),
            list(dalpha0),
        )
        return np.frombuffer(alpha).reshape(-1, 2), np.frombuffer(dalpha).reshape(-1, 2)

    def __repr__(self) -> str:
        lines = [f"Fit by {self.method} ({self.status})"]
        for row in self.parameters.iter_rows(named=True):
            error = "fixed" if row["fixed"] else f"± {row['std_error'] or float('inf'):.2g}"
            lines.append(f"  {row['symbol']:<8} {row['value']:12.6g} {error} {row['unit']}")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return f"<p>Fit by {self.method} ({self.status})</p>{self.parameters._repr_html_()}"


PARAMETERS = {
    "symbol": pl.String,
    "value": pl.Float64,
    "std_error": pl.Float64,
    "low": pl.Float64,
    "high": pl.Float64,
    "unit": pl.String,
    "identifiable": pl.Boolean,
    "fixed": pl.Boolean,
}


def plan(
    settings: Settings,
    train: list[Recording],
    validation: list[Recording],
    diagnosis: Mapping[str, Any] | None = None,
    name: str = "python",
) -> _native.Plan:
    """An experiment on recordings."""
    return _native.Plan(
        name,
        settings.keys(diagnosis),
        [r._native for r in train],
        [r._native for r in validation],
        settings.hold,
    )


def identify(
    recordings: RecordingLike | Iterable[RecordingLike],
    effects: EffectLike | Iterable[EffectLike] = (),
    method: str = "prediction_error",
    *,
    fixed: Mapping[str, float | str] | None = None,
    hold: str | None = None,
    **options: Any,
) -> Fit:
    """Identifies the parameters of a model.

    :param recordings: recordings to fit, paths, or frames.
    :param effects: effects added to the base model (inertia, centrifugal torque, Coulomb friction): ids of
        :func:`effects`, or :class:`Effect` for a formula of your own.
    :param method: a name of :func:`methods`; further keywords are its options.
    :param fixed: parameters held at a value, or at ``"construction"``.
    :param hold: the input between two samples: ``"linear"`` or ``"constant"``; unless given, linear where the motion does not
        show that it is held (:attr:`Fit.hold`).
    :raises InputError: unknown names, wrong values.
    :raises RunError: there is no fit; the message says which motion to record.
    """
    train = recording_list(recordings, "recordings")
    robot, conditioning = common(train)
    settings = Settings(
        robot=robot,
        conditioning=conditioning,
        effects=effect_list(effects),
        fixed=dict(fixed or {}),
        method=method,
        options=options,
        hold=hold,
    )
    made = plan(settings, train, [])
    return Fit(made.fit(), settings, train, made.warnings)


def simulate(
    fit: Fit,
    t: npt.ArrayLike,
    inputs: npt.ArrayLike,
    alpha0: tuple[float, float] = (0.0, 0.0),
    dalpha0: tuple[float, float] = (0.0, 0.0),
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Wheel angles [rad] and speeds [rad/s] that the model of a fit predicts from the input alone, each of shape (n, 2);
    parameters as in :meth:`Fit.simulate`."""
    return fit.simulate(t, inputs, alpha0, dalpha0)
