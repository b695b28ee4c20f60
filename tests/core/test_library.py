"""The core as a C++ library: built without Python, its own test, installed, and used by a project elsewhere."""

from __future__ import annotations

import shutil
import subprocess
from importlib import metadata
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOREIGN = Path(__file__).parent / "foreign"
EVERY = "// every header of houle_core, by tests/core/test_library.py"

pytestmark = pytest.mark.skipif(shutil.which("cmake") is None, reason="there is no cmake")


def cmake(*arguments: object) -> str:
    """The output of a command of CMake, which must succeed."""
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True)
    assert done.returncode == 0, f"{arguments}:\n{done.stdout}\n{done.stderr}"
    return done.stdout


def threads() -> list[str]:
    """Where oneTBB is: that of the package tbb-devel; else what CMake finds by itself."""
    try:
        config = next(f for f in metadata.files("tbb-devel") or [] if f.name == "TBBConfig.cmake")
    except (metadata.PackageNotFoundError, StopIteration):
        return []
    return [f"-DTBB_DIR={Path(config.locate()).resolve().parent}"]


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    folder = tmp_path_factory.mktemp("library") / "build"
    cmake("cmake", "-S", ROOT / "core", "-B", folder, "-DHOULE_CORE_TESTS=ON", *threads())
    cmake("cmake", "--build", folder, "--config", "Release", "--parallel", 2)
    return folder


def test_water_stays_at_rest_in_cpp_alone(build):
    cmake("ctest", "--test-dir", build, "-C", "Release", "--output-on-failure", "--no-tests=error")


def test_a_foreign_project_finds_the_installed_library(build, tmp_path):
    """Every header can be included by a project that knows nothing but where the library was installed."""
    prefix, project = tmp_path / "prefix", tmp_path / "project"
    cmake("cmake", "--install", build, "--config", "Release", "--prefix", prefix)
    shutil.copytree(FOREIGN, project)
    headers = sorted(p.relative_to(ROOT / "core").as_posix() for p in (ROOT / "core" / "houle").rglob("*.hpp"))
    installed = sorted(p.relative_to(prefix / "include").as_posix() for p in (prefix / "include").rglob("*.hpp"))
    assert installed == headers
    main = project / "main.cpp"
    includes = "\n".join(f"#include <{header}>" for header in headers)
    main.write_text(main.read_text(encoding="utf-8").replace(EVERY, includes), encoding="utf-8")
    where = [f"-DCMAKE_PREFIX_PATH={prefix.as_posix()}", "-DCMAKE_BUILD_TYPE=Release"]
    cmake("cmake", "-S", project, "-B", project / "build", *where, *threads())
    cmake("cmake", "--build", project / "build", "--config", "Release")
    cmake("ctest", "--test-dir", project / "build", "-C", "Release", "--output-on-failure", "--no-tests=error")
