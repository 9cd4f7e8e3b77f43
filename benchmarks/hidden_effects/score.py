#!/usr/bin/env python3
"""Scores answers of any program on the hidden-effect benchmark. Needs Python alone.

usage: score.py CASES ANSWERS [ANSWERS...]

CASES    folder that `cargo bench --bench hidden_effects -- ... --write CASES` wrote (holds truth.json)
ANSWERS  JSON object {"folder of the case": {"found": [effect ids, first found first], "verdict": text or null}},
         or the outcomes that the benchmark itself writes with --json

named    the first effect found is hidden (or equal to one by the equations)
exact    that, and nothing else was found
"""
import json, math, sys
from pathlib import Path

TWINS = [{"viscous_friction", "back_emf"}, {"coulomb_asymmetry", "torque_offset"}]


def same(a, b):
    return a == b or any(a in twins and b in twins for twins in TWINS)


def answers_of(path):
    text = Path(path).read_text()
    try:
        return json.loads(text)
    except json.JSONDecodeError:  # one outcome a line
        out = {}
        for line in text.splitlines():
            outcome = json.loads(line)
            said = [s for s in outcome["said"] if s["false_alarm"] == 0.05]
            if said:
                out[outcome["case"].replace("/", "_")] = dict(found=said[0]["found"], verdict=said[0]["verdict"])
        return out


def share(count, of):
    """Share with Wilson's 95 % interval."""
    if not of:
        return "-"
    z2, p = 1.96**2, count / of
    middle, half = p + z2 / (2 * of), math.sqrt(z2 * (p * (1 - p) / of + z2 / (4 * of * of)))
    low, high = [(middle + s * half) / (1 + z2 / of) for s in (-1, 1)]
    return f"{count}/{of} ({100 * low:.0f}-{100 * high:.0f} %)"


def main():
    truth = json.loads((Path(sys.argv[1]) / "truth.json").read_text())
    print("| answers | cases | healthy: an effect named | named strong | moderate | weak | exact strong | moderate | weak | "
          "two: both, nothing else | outside: an effect named |")
    print("|---" * 11 + "|")
    for path in sys.argv[2:]:
        answers = answers_of(path)
        rows = [(t, answers[name]["found"]) for name, t in truth.items() if name in answers]
        of = lambda kind, size=None: [(t["hidden"], f) for t, f in rows if t["kind"] == kind and size in (None, t["size"])]
        alarms = lambda kind: share(sum(bool(f) for _, f in of(kind)), len(of(kind)))
        named = lambda h, f: bool(f) and any(same(f[0], x) for x in h)
        exact = lambda h, f: len(f) == len(h) and all(any(same(x, y) for y in f) for x in h)
        count = lambda good, size: share(sum(good(h, f) for h, f in of("single", size)), len(of("single", size)))
        sizes = ("strong", "moderate", "weak")
        cells = [Path(path).stem, len(rows), alarms("healthy")] + [count(g, s) for g in (named, exact) for s in sizes]
        cells += [share(sum(exact(h, f) for h, f in of("two")), len(of("two"))), alarms("outside")]
        print("| " + " | ".join(map(str, cells)) + " |")


main()
