"""A run whose words nobody reads: it goes on to its end, and its results are what they are otherwise."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

import houle

CASE = """
case = {name = "quay"}
domain = {size = [0.4, 0.2], spacing = 0.04}
water = [{box = [[0.0, 0.0], [0.2, 0.12]]}]
gauge = [{x = 0.1}]
time = {end = 0.1}
output = {every = 0.05}
"""
SCRIPT = """
import sys
import houle.running.runner, houle.running.progress
from houle.cli import main
houle.running.runner.draw = lambda run, session: None
houle.running.progress.LINE_EVERY = 0.0
main()
"""
pytestmark = pytest.mark.skipif(os.name == "nt", reason="pipes and descriptors of POSIX")


@pytest.fixture
def command(tmp_path):
    """The beginning of a command line, in a folder with a case."""
    (tmp_path / "quay.toml").write_text(CASE)
    return [sys.executable, "-c", SCRIPT]


def start(command, folder, **streams):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.Popen(command, cwd=folder, env=environment, **streams)


def test_a_dead_reader_of_the_log_does_not_end_the_run(command, tmp_path):
    pipe = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with start([*command, "run", "quay.toml", "--out", "run"], tmp_path, **pipe) as process:
        process.stderr.readline()
        process.stderr.close()
        process.stdout.close()
        assert process.wait() == 0
    assert houle.open_run(tmp_path / "run").summary["finished"]


@pytest.mark.parametrize("closed", [">&- 2>&-", "<&- >&-", "2>&-"])
def test_closed_streams_do_not_end_the_run_nor_get_into_its_files(command, tmp_path, closed):
    line = ["sh", "-c", f'exec "$@" {closed}', "sh", *command, "run", "quay.toml", "--out", "run"]
    with start(line, tmp_path, stderr=subprocess.PIPE) as process:
        words = process.communicate()[1].decode()
    assert process.returncode == 0 and "Traceback" not in words
    run = houle.open_run(tmp_path / "run")
    assert run.summary["finished"] and run.series.time.size == 21 and len(run.fields.frame(-1).volume) > 0


def test_a_list_that_is_not_read_to_its_end_is_no_failure(command, tmp_path):
    reader, writer = os.pipe()
    os.close(reader)
    with start([*command, "describe", "numerics"], tmp_path, stdout=writer, stderr=subprocess.PIPE) as process:
        os.close(writer)
        words = process.communicate()[1]
    assert process.returncode == 0 and words == b""


def test_a_name_that_is_no_text_in_the_terminals_letters(command, tmp_path):
    folder = os.fsdecode(b"r\xe9sultats")
    try:
        (tmp_path / folder).mkdir()
    except OSError:
        pytest.skip("this file system takes no such names")
    with start([*command, "run", "quay.toml", "--out", folder], tmp_path, stderr=subprocess.PIPE) as process:
        words = process.communicate()[1]
    assert process.returncode == 0 and b"Traceback" not in words
    assert houle.open_run(tmp_path / folder).summary["finished"]
