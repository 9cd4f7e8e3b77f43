"""The catalogues of effects and methods as frames."""

from __future__ import annotations

import json

import polars as pl

from . import _native


def effects() -> pl.DataFrame:
    """The catalogue of physical effects, one row per effect.

    Columns: ``id`` (as in ``effects=[...]``), ``title``, ``equation``, ``cause``, ``signature`` (how it shows
    in data), ``excitation`` (which driving makes it visible), ``equivalent`` (effects that are the same in the
    equations), ``parameters`` (list of structs: ``symbol``, ``meaning``, ``unit``, ``low``, ``high``,
    ``typical``).
    """
    rows = json.loads(_native.effects())
    for row in rows:
        row["parameters"] = [
            {
                "symbol": p["symbol"],
                "meaning": p["meaning"],
                "unit": p["unit"],
                "low": float(p["range"][0]),
                "high": float(p["range"][1]),
                "typical": float(p["typical"]),
            }
            for p in row["parameters"]
        ]
    return pl.DataFrame(rows)


def methods() -> pl.DataFrame:
    """The identification methods, one row per method.

    Columns: ``name`` (as in ``method="..."``), ``title``, ``equation``, ``source``, ``use_when``,
    ``avoid_when``, ``options`` (list of structs: ``key``, ``default``, ``meaning``).
    """
    return pl.DataFrame(json.loads(_native.methods()))
