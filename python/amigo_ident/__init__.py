"""Identify the dynamics of a two-wheel robot from recordings and diagnose missing physical effects.

Quantities are in SI units (rad, rad/s, N m, s); wheel 1 is the right one.

>>> import amigo_ident as ai
>>> train = ai.Recording.read("train.csv")                       # doctest: +SKIP
>>> fit = ai.identify(train, effects=["viscous_friction"])       # doctest: +SKIP
>>> ai.compare(fit, ai.Recording.read("validation.csv")).error   # doctest: +SKIP
>>> ai.diagnose(train).verdict                                   # doctest: +SKIP
"""

from __future__ import annotations

from ._catalogue import effects, methods
from ._errors import AmigoError, ColumnError, InputError, RunError
from ._experiment import Experiment
from ._fit import Fit, identify, simulate
from ._native import __version__
from ._recording import Recording
from ._settings import Effect
from ._study import Comparison, Diagnosis, Study, compare, diagnose

__all__ = [
    "AmigoError",
    "ColumnError",
    "Comparison",
    "Diagnosis",
    "Effect",
    "Experiment",
    "Fit",
    "InputError",
    "Recording",
    "RunError",
    "Study",
    "__version__",
    "compare",
    "diagnose",
    "effects",
    "identify",
    "methods",
    "simulate",
]
