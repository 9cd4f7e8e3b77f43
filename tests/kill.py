#!/usr/bin/env python3
"""Kills the program with SIGKILL at random moments, most of them while it writes, and checks that
nothing it leaves is damaged.

    python3 tests/kill.py target/release/experiment [KILLS]

After every kill each file that bears its final name must be whole, and a folder with a results.json
must be complete and of one run: two experiments that differ in their title take turns, so a mixture
of both would show. At the end a grid is killed in the same way and resumed until it is done; its
summary must be that of an undisturbed run. Linux, Python 3 without packages.
"""

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

EXPERIMENT = """title = "TITLE"
[simulation]
noise      = { dalpha = 0.05, alpha = 0.001, M = 0.005 }
train      = 1
validation = 1
duration_s = 4.0
[[method]]
name = "prediction_error"
[[method]]
name = "torque_regression"
"""

GRID = """[simulation]
noise      = { dalpha = 0.05, alpha = 0.001, M = 0.005 }
train      = 1
validation = 0
duration_s = 4.0
[[method]]
name = "torque_regression"
[grid]
noise_scale = [0.5, 1.0]
seed        = { count = 200 }
"""

ENDS = {
    ".png": b"IEND\xaeB`\x82",
    ".svg": b"</svg>\n",
    ".html": b"</html>",
    ".parquet": b"PAR1",
    ".json": b"}",
    ".csv": b"\n",
}


def fail(message):
    sys.exit(f"DAMAGED: {message}")


def check(folder, expected):
    """Whole files; all of one run where there is a results.json. Says which of the two it saw."""
    names = sorted(p.name for p in folder.iterdir()) if folder.is_dir() else []
    for name in names:
        path = folder / name
        end = ENDS.get(path.suffix)
        if name.startswith(".unfinished-") or end is None:
            continue
        bytes_ = path.read_bytes()
        # versions.json is a list
        if not bytes_.rstrip(b"\n").endswith(end.rstrip(b"\n")) and bytes_[-1:] != b"]":
            fail(f"{path} ends with {bytes_[-20:]!r}")
        if path.suffix == ".json":
            json.loads(bytes_)
    if "results.json" not in names:
        return False
    missing = expected - set(names)
    if missing:
        fail(f"{folder} has a results.json but no {missing}")
    titles = [t for t in ("One", "Two") if f"<title>{t}</title>" in (folder / "report.html").read_text()]
    toml = (folder / "experiment.toml").read_text()
    if len(titles) != 1 or f'title = "{titles[0]}"' not in toml:
        fail(f"{folder} mixes two runs: {titles}")
    return True


def start(program, *arguments):
    return subprocess.Popen([program, "--quiet", *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)


def kill_while_writing(process, folder, seconds):
    """Kills a moment after the program began to write, or after so many seconds."""
    begun = time.monotonic()
    while process.poll() is None and time.monotonic() - begun < seconds:
        if folder.is_dir() and any(n.startswith(".unfinished-") for n in os.listdir(folder)):
            time.sleep(random.uniform(0, 0.03))
            break
    return kill(process)


def kill_after(process, seconds):
    time.sleep(random.uniform(0, seconds))
    return kill(process)


def kill(process):
    """Whether it was still running."""
    process.send_signal(signal.SIGKILL)
    process.wait()
    return process.returncode == -signal.SIGKILL


def main():
    program = str(Path(sys.argv[1]).resolve())
    kills = int(sys.argv[2]) if len(sys.argv) > 2 else 60
    random.seed(1)
    with tempfile.TemporaryDirectory() as name:
        os.chdir(name)
        for title in ("One", "Two"):
            Path(title).mkdir()
            Path(title, "e.toml").write_text(EXPERIMENT.replace("TITLE", title))
        begun = time.monotonic()
        subprocess.run([program, "--quiet", "One/e.toml"], check=True)
        whole = time.monotonic() - begun
        folder = Path("reports/e")
        expected = {p.name for p in folder.iterdir()}
        killed = complete = writing = 0
        for k in range(kills):
            if not (folder / "results.json").exists() and k % 4:
                # complete results, which the next run is to replace
                subprocess.run([program, "--quiet", f"{('One', 'Two')[(k + 1) % 2]}/e.toml"], check=True)
            process = start(program, f"{('One', 'Two')[k % 2]}/e.toml")
            if k % 3:
                hit = kill_while_writing(process, folder, 4 * whole)
            else:
                hit = kill_after(process, whole)
            killed += hit
            complete += check(folder, expected)
            for left in [p for p in folder.iterdir() if p.name.startswith(".unfinished-")]:
                writing += 1
                # as if an hour had gone by: the next run tidies up
                os.utime(left, (1, 1))
        print(f"{kills} runs of {whole:.2f} s, {killed} killed, {writing} of them while writing: "
              f"{complete} times the results were complete, {kills - complete} times without results.json, never damaged")
        subprocess.run([program, "--quiet", "Two/e.toml"], check=True)
        left = {p.name for p in folder.iterdir()}
        if left != expected or not check(folder, expected):
            fail(f"after a last run the folder has {left ^ expected}")
        print("a run that is left alone afterwards gives the same files as the first, and nothing else")

        Path("grid.toml").write_text(GRID)
        begun = time.monotonic()
        subprocess.run([program, "--quiet", "--out", "whole", "grid.toml"], check=True)
        whole = time.monotonic() - begun
        summary = Path("parts/grid/summary.csv")
        killed = 0
        for _ in range(1000):
            process = start(program, "--resume", "--out", "parts", "grid.toml")
            if not kill_after(process, 0.5 * whole):
                break
            killed += 1
        if summary.read_text() != Path("whole/grid/summary.csv").read_text():
            fail("the summary of the resumed grid differs")
        print(f"a grid of 400 cells, killed {killed} times and resumed: the same summary as of one run")


main()
