#!/usr/bin/env python3
"""A peer for the hidden-effect benchmark: torque balance over short windows, effects added by BIC. Needs numpy.

usage: regression_bic.py CASES > ANSWERS.json      (CASES as CSV: --write CASES --csv)

Both sides of the torque balance are multiplied by a smooth bump g over windows of 0.15 s and summed, so that accelerations
become -sum g' w. An effect is a set of columns, some with one shape on a grid. The one that lowers
    BIC = n ln(RSS/n) + k ln n
the most is added while it gains more than 10, three at most.
"""
import json, sys
from pathlib import Path
import numpy as np

WINDOW, GAIN, MOST = 0.15, 10.0, 3
HELD = 2  # windows overlap by half: two of them count as one


def read(path):
    d = np.genfromtxt(path, delimiter=",", names=True)
    pair = lambda name: np.c_[d[name + "1"], d[name + "2"]]
    return d["t"], pair("alpha"), pair("dalpha"), pair("M")


def constants(folder):
    lines = (folder / "experiment.toml").read_text().splitlines()
    return {k.strip(): float(v) for k, v in (l.split("=") for l in lines if l.count("=") == 1 and "[" not in l and '"' not in l)}


def columns(t, alpha, w, M, robot, top):
    """Signals (rows, 2) of every effect: name -> list of shapes, each a list of signals; 'd:' signals are differentiated."""
    r, l1 = robot["r_m"], robot["l1_m"]
    s = np.tanh(w / (0.01 * top))
    one, zero = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    both = lambda x: [x * one, x * zero]
    beta = r / (2 * l1) * (alpha[:, :1] - alpha[:, 1:])
    turn, ahead = w[:, 0] - w[:, 1], w[:, 0] + w[:, 1]
    across = lambda x: np.c_[x, -x]
    k = robot["l2_m"] / l1
    cos, sin = np.cos(beta), np.sin(beta)
    wave = lambda n: both(np.sin(n * alpha)) + both(np.cos(n * alpha))
    clip = lambda m: M - np.clip(M, -m, m)
    sizes = np.quantile(np.abs(M), [0.5, 0.7, 0.8, 0.9, 0.95, 0.98])
    base = [s * one, s * zero, np.c_[w[:, 1] * (w[:, 1] - w[:, 0]), w[:, 0] * (w[:, 0] - w[:, 1])]]
    h = t[1] - t[0]
    effects = {
        "viscous_friction": [[w]], "viscous_friction_1": [[w * one]], "viscous_friction_2": [[w * zero]],
        "viscous_asymmetry": [both(np.abs(w))], "torque_offset": [both(np.ones_like(w))], "quadratic_drag": [[w * np.abs(w)]],
        "stribeck": [[s * np.exp(-((w / (q * top)) ** 2))] for q in (0.05, 0.1, 0.2, 0.4)],
        "slope": [[np.c_[cos + k * sin, cos - k * sin], np.c_[sin - k * cos, sin + k * cos]]],
        "turning_scrub": [[across(np.tanh(turn / (0.01 * top)))]], "yaw_viscous": [[across(turn)]],
        "caster_drag": [[np.tanh(ahead / (0.01 * top))[:, None] * np.ones(2)]],
        "torque_gain": [[-M * one]], "torque_saturation": [[clip(m)] for m in sizes],
        "backlash_deadzone": [[np.clip(M, -m, m)] for m in 0.3 * sizes[:3]],
        "wheel_eccentricity": [wave(1)], "torque_ripple": [wave(n) for n in range(2, 25)],
        "friction_warmup": [[s * np.exp(-((t - t[0]) / T))[:, None]] for T in (3.0, 8.0, 20.0)],
        "load_transfer_friction": [[across(w[:, 0] ** 2 - w[:, 1] ** 2) * s]],
    }
    derived = {"lateral_com": [[across(w[:, 0]) * one + across(w[:, 1]) * zero]], "actuator_delay": [[M]]}
    return base, effects, derived


def windows(t, alpha, w, M, robot, top):
    """Rows of the regression: torque, base columns, and columns of every effect and shape."""
    h = np.median(np.diff(t))
    n = max(int(round(WINDOW / h)), 8)
    u = np.linspace(-1, 1, n)
    g, dg = (1 - u**2) ** 3, -6 * u * (1 - u**2) ** 2 * (2 / (n - 1) / h)
    starts = np.arange(0, len(t) - n, max(n // HELD, 1))
    rows = starts[:, None] + np.arange(n)
    # windows in which a wheel is near rest say little of friction
    moving = (np.abs(w[rows]) > 0.03 * top).mean(axis=1).min(axis=1) > 0.9
    rows = rows[moving]
    sums = lambda x: np.einsum("kni,n->ki", x[rows], g).T.ravel()
    slopes = lambda x: -np.einsum("kni,n->ki", x[rows], dg).T.ravel()
    base, effects, derived = columns(t, alpha, w, M, robot, top)
    X = np.c_[slopes(w), slopes(w[:, ::-1]), np.array([sums(b) for b in base]).T]
    found = {name: [np.array([sums(c) for c in shape]).T for shape in shapes] for name, shapes in effects.items()}
    found |= {name: [np.array([slopes(c) for c in shape]).T for shape in shapes] for name, shapes in derived.items()}
    return sums(M), X, found


def bic(y, X, n):
    b, *_ = np.linalg.lstsq(X / np.linalg.norm(X, axis=0), y, rcond=None)
    e = y - X / np.linalg.norm(X, axis=0) @ b
    return n * np.log(e @ e / len(y)) + X.shape[1] * np.log(n)


def diagnose(folder):
    robot = constants(folder)
    parts = [read(folder / f"train_{k}.csv") for k in (1, 2)]
    top = max(np.quantile(np.abs(w), 0.98) for _, _, w, _ in parts)
    made = [windows(*part, robot, top) for part in parts]
    y, X = np.concatenate([m[0] for m in made]), np.vstack([m[1] for m in made])
    effects = {name: [np.vstack([m[2][name][k] for m in made]) for k in range(len(shapes))] for name, shapes in made[0][2].items()}
    n, found = len(y) / HELD, []
    while len(found) < MOST:
        now, best = bic(y, X, n), (np.inf, None, None)
        for name, shapes in effects.items():
            if name in found:
                continue
            for C in shapes:
                cost = np.log(n) if len(shapes) > 1 else 0.0  # the shape is a parameter, too
                best = min(best, (bic(y, np.hstack([X, C]), n) + cost, name, C), key=lambda b: b[0])
        if not best[0] < now - GAIN:
            break
        found.append(best[1])
        X = np.hstack([X, best[2]])
    return dict(found=found, verdict=None)


def main():
    cases = Path(sys.argv[1])
    names = json.loads((cases / "truth.json").read_text())
    print(json.dumps({name: diagnose(cases / name) for name in names}, indent=0))


if __name__ == "__main__":
    main()
