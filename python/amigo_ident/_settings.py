"""Settings of an experiment, as the keys of an experiment file."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Union


@dataclass(frozen=True)
class Effect:
    """An effect of your own, written as a formula of the resisting torque on a wheel [N m].

    ``torque1`` is the resisting torque on wheel 1 (right); wheel 2 has the same formula with the wheels
    exchanged unless ``torque2`` is given. Quantities: ``w`` (speed of the wheel [rad/s]), ``w1``, ``w2``,
    ``alpha1``, ``alpha2`` [rad], ``v`` [m/s], ``beta`` [rad], ``beta_dot`` [rad/s], ``t`` [s], as
    `docs/files.md` lists them. ``parameters`` maps a symbol to its unit, or to the keys ``unit``, ``range``,
    ``typical`` and ``shape`` of ``[[model.custom]]``.

    >>> Effect("cubic", "k3 * w^3", {"k3": "N m s^3/rad^3"}).id
    'cubic'
    """

    id: str
    torque1: str
    parameters: Mapping[str, Union[str, Mapping[str, Any]]]
    torque2: str | None = None
    description: str = ""

    def _keys(self) -> dict[str, Any]:
        def entry(value: str | Mapping[str, Any]) -> dict[str, Any]:
            return {"unit": value} if isinstance(value, str) else dict(value)

        keys: dict[str, Any] = {
            "id": self.id,
            "torque1": self.torque1,
            "description": self.description,
            "parameters": {symbol: entry(value) for symbol, value in self.parameters.items()},
        }
        if self.torque2 is not None:
            keys["torque2"] = self.torque2
        return keys


EffectLike = Union[str, Effect]
RobotLike = Union[str, Mapping[str, Any], None]


def robot_keys(robot: RobotLike) -> dict[str, Any]:
    """The table ``[robot]``; without a robot nothing of its geometry is assumed."""
    if robot is None:
        return {"preset": "unknown"}
    return {"preset": robot} if isinstance(robot, str) else dict(robot)


@dataclass(frozen=True)
class Settings:
    """What is identified, and how."""

    robot: RobotLike = None
    effects: Sequence[EffectLike] = ()
    custom: Sequence[Effect] = ()
    fixed: Mapping[str, Any] = field(default_factory=dict)
    method: str = "prediction_error"
    options: Mapping[str, Any] = field(default_factory=dict)
    conditioning: Mapping[str, bool] = field(default_factory=dict)
    hold: str | None = None

    def keys(self, diagnosis: Mapping[str, Any] | None = None) -> str:
        """The keys of an experiment file as JSON."""
        own = [e for e in self.effects if isinstance(e, Effect)]
        own += [e for e in self.custom if e not in own]
        keys: dict[str, Any] = {
            "model": {
                "effects": [e.id if isinstance(e, Effect) else e for e in self.effects],
                "fixed": dict(self.fixed),
                "custom": [e._keys() for e in own],
            },
            "robot": robot_keys(self.robot),
            "conditioning": dict(self.conditioning),
            "method": [{"name": self.method, **self.options}],
        }
        if diagnosis is not None:
            keys["diagnosis"] = dict(diagnosis)
        return json.dumps(keys, allow_nan=False)


def effect_list(effects: EffectLike | Iterable[EffectLike]) -> tuple[EffectLike, ...]:
    """One effect or several."""
    return (effects,) if isinstance(effects, (str, Effect)) else tuple(effects)
