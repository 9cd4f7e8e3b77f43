"""Recordings from files, frames and arrays."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Union

import numpy as np
import numpy.typing as npt
import polars as pl

from . import _native
from ._errors import ColumnError, InputError
from ._settings import RobotLike, robot_keys

Columns = Mapping[str, Union[str, Mapping[str, Any]]]


def _numbers(values: Any) -> npt.NDArray[np.float64]:
    """The values as numbers: dates in seconds since the first one, durations in seconds."""
    if getattr(getattr(values, "dtype", None), "tz", None) is not None:  # dates of pandas with a time zone
        values = getattr(values, "dt", values).tz_convert(None)
    array = np.asarray(values)
    if array.dtype.kind == "M":
        known = array[~np.isnat(array)]
        array = array - known[0] if len(known) else array - array
    if array.dtype.kind == "m":
        return np.where(np.isnat(array), np.nan, array / np.timedelta64(1, "s"))
    return np.asarray(array, dtype=np.float64)


def _time_index(df: Any, names: list[Any]) -> str | None:
    """The name under which the index of a pandas frame is a column: its own, or `t` for dates and durations."""
    index: Any = getattr(df, "index", None)
    if getattr(getattr(index, "dtype", None), "kind", None) not in ("M", "m", "f"):
        return None
    name = str(index.name) if index.name is not None else "t"
    return None if name in names else name


@contextmanager
def _columns_named() -> Iterator[None]:
    """Adds to the words of the command line, which name the experiment file, where Python names columns."""
    try:
        yield
    except ColumnError as e:
        raise ColumnError(
            f"{e} (in Python: the argument columns={{\"t\": \"…\"}}, or Experiment.from_recordings(paths), which finds the "
            "columns out)"
        ) from None


class Recording:
    """A checked recording: wheel angles and speeds, and the input that drove the wheels.

    Sensor and logger faults are corrected as the command ``experiment`` corrects them; :attr:`findings` says
    what was found. A recording is never changed.
    """

    def __init__(
        self, native: _native.Recording, robot: RobotLike, conditioning: Mapping[str, bool]
    ) -> None:
        self._native = native
        self._robot = robot
        self._conditioning = conditioning

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str],
        columns: Columns | None = None,
        drive_unit: str = "N m",
        robot: RobotLike = None,
        conditioning: Mapping[str, bool] | None = None,
    ) -> Recording:
        """Reads CSV, Parquet, WPILOG, MCAP, MAT or SysId JSON.

        The columns must have these names, or be named. :meth:`Experiment.from_recordings` finds them out by itself.

        :param columns: where names or units differ from ``t`` [s], ``alpha1``, ``alpha2`` [rad], ``dalpha1``,
            ``dalpha2`` [rad/s], ``M1``, ``M2`` [``drive_unit``]: ``{"dalpha1": "right"}`` or
            ``{"dalpha1": {"name": "right", "unit": "rpm", "scale": -1}}``.
        :param drive_unit: unit of the input: ``"N m"``, ``"V"`` or ``"A"``; inertias and frictions come out per
            that unit.
        :param robot: name of a preset (``"amigobot"``, ``"unknown"``) or construction data (``l1_m``, ``r_m``, …).
        :param conditioning: what is not to be corrected, ``{"spikes": False}``; keys as in ``[conditioning]`` of an
            experiment file.
        :raises InputError: with file, row and column.
        """
        corrected = dict(conditioning or {})
        with _columns_named():
            native = _native.Recording.read(
                os.fspath(path),
                json.dumps(dict(columns or {})),
                drive_unit,
                json.dumps(robot_keys(robot)),
                json.dumps(corrected),
            )
        return cls(native, robot, corrected)

    @classmethod
    def from_frame(
        cls,
        df: Any,
        columns: Columns | None = None,
        drive_unit: str = "N m",
        robot: RobotLike = None,
        name: str = "frame",
        conditioning: Mapping[str, bool] | None = None,
    ) -> Recording:
        """Takes a polars or pandas frame, a pyarrow table, or a mapping of names to arrays.

        Only the columns that are needed are read; parameters as in :meth:`read`. Missing values count as
        samples that were not recorded. Dates and durations are taken as seconds, whatever they are counted in; dates
        begin at zero. Where pandas has the time as its index, the index is the column ``t``, or that of its name.
        """
        if isinstance(df, pl.LazyFrame):
            df = df.collect()
        # pyarrow; polars and pandas; mappings
        names = list(getattr(df, "column_names", getattr(df, "columns", df)))
        index = _time_index(df, names)
        if index is not None:
            names.append(index)

        def fetch(column: str) -> bytes:
            try:
                return _numbers(df.index if column == index else df[column]).tobytes()
            except (TypeError, ValueError) as e:
                raise InputError(f"{name}: column `{column}` has no numbers: {e}") from e

        corrected = dict(conditioning or {})
        with _columns_named():
            native = _native.Recording.of_table(
                name,
                [str(n) for n in names],
                fetch,
                json.dumps(dict(columns or {})),
                drive_unit,
                json.dumps(robot_keys(robot)),
                json.dumps(corrected),
            )
        return cls(native, robot, corrected)

    @classmethod
    def from_arrays(
        cls,
        t: npt.ArrayLike,
        inputs: npt.ArrayLike,
        dalpha: npt.ArrayLike | None = None,
        alpha: npt.ArrayLike | None = None,
        drive_unit: str = "N m",
        robot: RobotLike = None,
        name: str = "arrays",
        conditioning: Mapping[str, bool] | None = None,
    ) -> Recording:
        """Takes arrays: ``t`` [s] of n values; ``inputs`` [``drive_unit``], ``dalpha`` [rad/s] and ``alpha`` [rad]
        of shape (n, 2), right wheel first. Angles or speeds may be missing, not both."""
        table: dict[str, Any] = {"t": np.asarray(t, dtype=np.float64)}
        pairs = {"alpha": alpha, "dalpha": dalpha, "M": inputs}
        for key, values in pairs.items():
            if values is None:
                continue
            array = np.asarray(values, dtype=np.float64)
            if array.ndim != 2 or array.shape[1] != 2:
                raise InputError(f"{name}: {key} has the shape {array.shape}; expected (n, 2)")
            table[f"{key}1"], table[f"{key}2"] = array[:, 0], array[:, 1]
        return cls.from_frame(table, None, drive_unit, robot, name, conditioning)

    @property
    def name(self) -> str:
        """Name: that of the file."""
        return self._native.name

    @property
    def drive_unit(self) -> str:
        """Unit of the input."""
        return self._native.drive_unit

    @property
    def duration(self) -> float:
        """From the first to the last sample [s]."""
        return self._native.duration

    @property
    def samples(self) -> int:
        """Number of rows."""
        return self._native.samples

    @property
    def sha256(self) -> str | None:
        """SHA-256 of the file; ``None`` for frames and arrays."""
        return self._native.sha256

    @property
    def findings(self) -> list[str]:
        """Corrections and warnings, in sentences."""
        return self._native.findings

    @property
    def noise(self) -> dict[str, Any]:
        """Standard deviations of the measurement noise: ``alpha`` [rad], ``omega`` [rad/s], ``torque``
        [:attr:`drive_unit`], each for both wheels."""
        noise: dict[str, Any] = json.loads(self._native.noise())
        return noise

    @property
    def t(self) -> npt.NDArray[np.float64]:
        """Time [s], shape (n,)."""
        return np.frombuffer(self._native.t())

    @property
    def alpha(self) -> npt.NDArray[np.float64]:
        """Wheel angles [rad], shape (n, 2)."""
        return np.frombuffer(self._native.alpha()).reshape(-1, 2)

    @property
    def dalpha(self) -> npt.NDArray[np.float64]:
        """Wheel speeds [rad/s], shape (n, 2)."""
        return np.frombuffer(self._native.dalpha()).reshape(-1, 2)

    @property
    def inputs(self) -> npt.NDArray[np.float64]:
        """Recorded input [:attr:`drive_unit`], shape (n, 2)."""
        return np.frombuffer(self._native.input()).reshape(-1, 2)

    def frame(self) -> pl.DataFrame:
        """The recording with the columns of the contract."""
        columns: dict[str, Any] = {"t": self.t}
        for key, values in (("alpha", self.alpha), ("dalpha", self.dalpha), ("M", self.inputs)):
            columns[f"{key}1"], columns[f"{key}2"] = values[:, 0], values[:, 1]
        return pl.DataFrame(columns)

    def __repr__(self) -> str:
        return f"Recording({self.name!r}, {self.samples} samples, {self.duration:.1f} s, input in {self.drive_unit})"


RecordingLike = Union[Recording, str, "os.PathLike[str]"]


def _is_table(item: Any) -> bool:
    return hasattr(item, "columns") or isinstance(item, Mapping)


def recording_list(
    recordings: RecordingLike | Iterable[RecordingLike] | None, what: str
) -> list[Recording]:
    """One recording, path or frame, or several."""
    if recordings is None:
        return []
    if isinstance(recordings, (Recording, str, os.PathLike)) or _is_table(recordings):
        recordings = [recordings]  # type: ignore[list-item]

    def one(item: Any) -> Recording:
        if isinstance(item, Recording):
            return item
        if isinstance(item, (str, os.PathLike)):
            return Recording.read(item)
        if _is_table(item):
            return Recording.from_frame(item)
        raise InputError(f"{what}: {type(item).__name__}; expected a Recording, a path or a frame")

    return [one(item) for item in recordings]


def common(recordings: list[Recording]) -> tuple[RobotLike, Mapping[str, bool]]:
    """Robot and conditioning of all recordings."""
    if not recordings:
        raise InputError("recordings: none is given; at least one is needed to fit")
    first = recordings[0]
    for other in recordings[1:]:
        if other._robot != first._robot:
            raise InputError(
                f"{first.name} and {other.name} are of different robots ({first._robot!r}, {other._robot!r})"
            )
        if other._conditioning != first._conditioning:
            raise InputError(
                f"{first.name} and {other.name} have different conditioning ({first._conditioning!r}, "
                f"{other._conditioning!r})"
            )
    return first._robot, first._conditioning
