"""Experiment files."""

from __future__ import annotations

import os
from collections.abc import Iterable

from . import _native
from ._study import Comparison, Diagnosis, Study


class Experiment:
    """An experiment file with its recordings, loaded and checked."""

    def __init__(self, plan: _native.Plan) -> None:
        self._plan = plan

    @classmethod
    def from_toml(cls, path: str | os.PathLike[str], set: Iterable[str] = ()) -> Experiment:
        """Loads a file.

        :param set: overrides ``"KEY=VALUE"`` in TOML syntax, as ``--set`` of the command line.
        :raises InputError: with file, line and, where close, the key that was meant.
        """
        return cls(_native.Plan.load(os.fspath(path), list(set)))

    @classmethod
    def from_recordings(
        cls, paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]], set: Iterable[str] = ()
    ) -> Experiment:
        """Recordings with columns of any names, as the command ``experiment run_1.csv run_2.csv`` takes them: columns and
        units are found out by names and values, some recordings are kept for validation, a diagnosis is asked for.
        :attr:`warnings` begins with what was taken for what.

        :param set: overrides ``"KEY=VALUE"``, as in :meth:`from_toml`; also answers to what the columns do not say.
        :raises InputError: with what the columns do not say.
        """
        one = isinstance(paths, (str, os.PathLike))
        listed: list[str | os.PathLike[str]] = [paths] if one else list(paths)  # type: ignore[list-item, arg-type]
        return cls(_native.Plan.of_recordings([os.fspath(p) for p in listed], list(set)))

    @property
    def name(self) -> str:
        """Name of its folder of results."""
        return self._plan.name

    @property
    def warnings(self) -> list[str]:
        """Warnings on the file and its recordings, in sentences."""
        return self._plan.warnings

    def run(self, out: str | os.PathLike[str] | None = None) -> Study:
        """Runs it: a :class:`Diagnosis` where the file has ``[diagnosis]``, else a :class:`Comparison`.

        :param out: folder that receives the result folder; nothing is written unless given.
        """
        kind = Diagnosis if self._plan.has_diagnosis else Comparison
        study = kind(self._plan.run(), self._plan)
        if out is not None:
            study.write(out)
        return study

    def __repr__(self) -> str:
        return f"Experiment({self.name!r})"
