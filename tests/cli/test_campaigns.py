"""A slice of the campaigns of tests/campaigns that kill runs and spoil their folders."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

CAMPAIGNS = Path(__file__).parents[1] / "campaigns"


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
@pytest.mark.parametrize(
    "arguments",
    [
        ["kills.py", "--kills", "4", "--seed", "3", "--case", "dam break", "--case", "open sides"],
        ["run_folders.py", "--inputs", "40", "--seed", "3"],
    ],
    ids=["kills", "run folders"],
)
def test_a_slice_finds_nothing(arguments):
    """In a process of its own, for it forks."""
    command = [sys.executable, str(CAMPAIGNS / arguments[0]), *arguments[1:]]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
