"""Importing the analysis costs nothing until it is used."""

import subprocess
import sys

from houle import analysis

HEAVY = "numpy scipy xarray matplotlib"


def test_the_import_is_cheap():
    code = f"import sys, houle; houle.analysis.__all__; print(sorted(set('{HEAVY}'.split()) & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_name_is_there():
    for name in analysis.__all__:
        assert getattr(analysis, name) is not None
    assert callable(analysis.reflection)
