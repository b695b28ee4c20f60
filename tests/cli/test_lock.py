"""One process at a time writes a run folder, and a process that has ended holds none."""

import os
import subprocess
import sys
import textwrap

import pytest

from houle.errors import CaseError
from houle.output.lock import exclusive

DIES = """
    import os, sys, time
    from pathlib import Path
    from houle.output.lock import exclusive

    with exclusive(Path(sys.argv[1])):
        if os.fork() == 0:
            os.close(1)
            time.sleep(30)
            os._exit(0)
        print("held", flush=True)
        os._exit(0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_child_that_outlives_its_parent_holds_no_folder(tmp_path):
    """Such as reads a file that HDF5 may hang on, while its parent is killed."""
    script = [sys.executable, "-W", "ignore", "-c", textwrap.dedent(DIES), str(tmp_path)]
    assert subprocess.run(script, stdout=subprocess.PIPE, text=True, check=True).stdout == "held\n"
    with exclusive(tmp_path):
        pass


def test_a_folder_that_is_held_is_refused(tmp_path):
    with exclusive(tmp_path), pytest.raises(CaseError, match="is being written by another houle"), exclusive(tmp_path):
        pass
