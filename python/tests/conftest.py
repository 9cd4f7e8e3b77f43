"""Recordings of the project, and the command line where it is built."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SLOPE = ROOT / "recordings" / "simulated_3d" / "slope"


@pytest.fixture(scope="session")
def slope() -> Path:
    """Recordings of a robot on a floor inclined by 0.015 rad."""
    return SLOPE


@pytest.fixture(scope="session")
def experiment():
    """Runs the command line; its path stands in EXPERIMENT."""
    program = os.environ.get("EXPERIMENT")
    if not program:
        pytest.skip("EXPERIMENT does not name the command line")

    def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [program, *arguments], cwd=cwd, capture_output=True, text=True, check=False
        )

    return run
