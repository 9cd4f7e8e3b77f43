#!/usr/bin/env python3
"""A peer for the hidden-effect benchmark: PySINDy on the residual acceleration. Needs `pip install pysindy`.

usage: pysindy_peer.py CASES [JOBS] > ANSWERS.json      (CASES as CSV: --write CASES --csv)

1. Acceleration: SmoothedFiniteDifference (Savitzky-Golay over 0.11 s). Rows with a wheel near rest are left out.
2. Coulomb model: accelerations by least squares on both torques and the terms of a3, a4, a5; its inputs' factors are the
   inverse G of the mass matrix. What it leaves is the residual acceleration.
3. SINDy: STLSQ on the residual acceleration of both wheels. The library are the terms of regression_bic.py, times G, less
   what the Coulomb model can express of them, each scaled to length one.
4. Threshold: of twelve, and none at all, the one with the fewest terms whose error on the held-out recording exceeds the
   lowest by no more than one standard error of the difference (blocks of 0.5 s).
The answer lists the effects of the terms that are left, the largest share first.
"""
import json, sys, warnings
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
import numpy as np
import pysindy as ps
from regression_bic import columns, constants, read

SMOOTHED, BLOCK = 0.11, 0.5  # [s]
THRESHOLDS = np.geomspace(0.01, 0.9, 12)  # shares of the residual acceleration
ALIKE = 2.0  # damping of the two wheels within this factor is that of both


def terms(t, alpha, w, M, robot, top):
    """Rows of both wheels below each other: acceleration, Coulomb terms, library, names of its effects, times."""
    rows = max(int(round(SMOOTHED / np.median(np.diff(t)))) // 2 * 2 + 1, 5)
    slope = ps.SmoothedFiniteDifference(smoother_kws={"window_length": rows})
    rate = lambda x: np.asarray(slope(x, t))
    base, effects, derived = columns(t, alpha, w, M, robot, top)
    # damping of one wheel is a term; that of both is the sum of the two
    library = [(name, x) for name, shapes in effects.items() if name != "viscous_friction" for shape in shapes for x in shape]
    library += [(name, rate(x)) for name, shapes in derived.items() for shape in shapes for x in shape]
    moving = (np.abs(w) > 0.03 * top).all(axis=1)
    moving[: rows // 2], moving[-rows // 2 :] = False, False
    stack = lambda x: x[moving].T.ravel()
    pairs = lambda signals: np.array([stack(y) for x in signals for y in (x, x[:, ::-1])]).T
    return stack(rate(w)), pairs([M] + base), pairs([x for _, x in library]), [name for name, _ in library], np.tile(t[moving], 2)


def through(G, library):
    """The accelerations that torques of the library cause: columns come in pairs, own wheel and other wheel."""
    return G[0] * library[:, ::2] + G[1] * library[:, 1::2]


def sindy(F, r, threshold):
    """Coefficients of STLSQ; no term is left where all lie below the threshold."""
    model = ps.SINDy(optimizer=ps.STLSQ(threshold=threshold), feature_library=ps.IdentityLibrary())
    # the state is one library term; the others come as inputs
    model.fit(F[:, :1], t=np.arange(len(F), dtype=float), x_dot=r[:, None], u=F[:, 1:])
    return model.coefficients()[0]


def blocks(e, t):
    """Mean square error in each block of time."""
    number = (t // BLOCK).astype(int)
    return np.bincount(number, e * e)[np.unique(number)] / np.bincount(number)[np.unique(number)]


def sparsest(F, r, held, r_held, t_held):
    """Coefficients of the fewest terms whose held-out error exceeds the lowest by one standard error at the most."""
    tried = [np.zeros(F.shape[1])] + [sindy(F, r, threshold) for threshold in THRESHOLDS]
    errors = [blocks(r_held - held @ c, t_held) for c in tried]
    best = min(errors, key=np.mean)
    near = lambda e: np.mean(e - best) <= np.std(e - best) / np.sqrt(len(best))
    return min((c for c, e in zip(tried, errors) if near(e)), key=np.count_nonzero)


def named(coefficients, sizes, names):
    """Effects of the terms that are left, the largest share first."""
    share, damping = {}, {}
    for c, size, name in zip(coefficients, sizes, names):
        if c:
            share[name] = share.get(name, 0.0) + c * c
            if name in ("viscous_friction_1", "viscous_friction_2"):
                damping[name] = c / size
    if len(damping) == 2 and 1 / ALIKE < damping["viscous_friction_1"] / damping["viscous_friction_2"] < ALIKE:
        share["viscous_friction"] = sum(share.pop(name) for name in damping)
    return sorted(share, key=share.get, reverse=True)


def diagnose(folder):
    warnings.simplefilter("ignore")
    robot = constants(folder)
    runs = [read(folder / f"{name}.csv") for name in ("train_1", "train_2", "validation")]
    top = max(np.quantile(np.abs(w), 0.98) for _, _, w, _ in runs[:2])
    made = [terms(*run, robot, top) for run in runs]
    (a, B, L), names = (np.concatenate([m[k] for m in made[:2]]) for k in range(3)), made[0][3]
    a_held, B_held, L_held, _, t_held = made[2]
    coulomb, *_ = np.linalg.lstsq(B, a, rcond=None)
    F = through(coulomb[:2], L)
    expressed, *_ = np.linalg.lstsq(B, F, rcond=None)
    F, held = F - B @ expressed, through(coulomb[:2], L_held) - B_held @ expressed
    r, r_held = a - B @ coulomb, a_held - B_held @ coulomb
    scale, sizes = np.linalg.norm(r), np.linalg.norm(F, axis=0)
    kept = sizes > 1e-9 * np.linalg.norm(a)  # terms that the Coulomb model has already
    F, held, sizes, names = F[:, kept] / sizes[kept], held[:, kept] / sizes[kept], sizes[kept], np.array(names)[kept]
    found = named(sparsest(F, r / scale, held, r_held / scale, t_held), sizes, names)
    return dict(found=found, verdict=None)


def main():
    cases = Path(sys.argv[1])
    names = list(json.loads((cases / "truth.json").read_text()))
    with ProcessPoolExecutor(int(sys.argv[2]) if len(sys.argv) > 2 else 1) as pool:
        answers = pool.map(diagnose, [cases / name for name in names])
        print(json.dumps(dict(zip(names, answers)), indent=0))


if __name__ == "__main__":
    main()
