"""The command line: exit statuses, one message for bad input, nothing written then."""

import errno
import json
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import jsonschema
import pytest
from typer.testing import CliRunner

import houle
from houle.case.describe import TOPICS
from houle.case.model import load
from houle.case.reading import shipped
from houle.check.rules import require
from houle.cli import app
from houle.errors import CaseError, SimulationError
from houle.medium.resistance import LAWS
from houle.registry import TABLES, choices


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder, the working directory of the test."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    return tmp_path


def houle_says(*arguments):
    """Exit status and everything printed."""
    result = CliRunner().invoke(app, [str(a) for a in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.output


def start(here):
    """A case file to spoil; the folder holds nothing else."""
    assert houle_says("new", "demo")[0] == 0
    return here / "demo.toml"


def told(case):
    """What check says of a case but for the advice on walls along which water slips, which every new tank gets."""
    return [finding for finding in require(case) if not finding.text.startswith("lets the water slip")]


def test_new_writes_a_case_that_checks_without_a_finding(here):
    file = start(here)
    case = load(file)
    assert case.case.name == "demo" and told(case) == []
    assert "#" in file.read_text(encoding="utf-8")


def test_new_writes_a_flume_with_waves_that_checks_without_a_finding(here):
    assert houle_says("new", "sea", "--waves")[0] == 0
    case = load(here / "sea.toml")
    assert case.case.name == "sea" and case.waves is not None and told(case) == []
    status, words = houle_says("check", "sea.toml")
    assert status == 0 and "warning" not in words
    for said in ("reflection is measured from", "fenton", "kh = 0.942", "0.3 % of the waves come back"):
        assert said in " ".join(words.split()), said


def test_new_does_not_overwrite(here):
    file = start(here)
    file.write_text("mine")
    status, words = houle_says("new", "demo.toml")
    assert status == 2 and "is there already" in words and file.read_text() == "mine"
    assert houle_says("new", "my demo")[0] == 2
    assert houle_says("new", "nowhere/demo")[0] == 2


def test_check_prints_the_passport_the_price_and_draws_the_section(here):
    file = start(here)
    status, words = houle_says("check", file)
    assert status == 0
    for expected in (
        "100 x 50 cells",
        "porous body dam",
        "a = ",
        "K_p",
        "C_f",
        "linear share",
        "particles",
        "section.png",
    ):
        assert expected in words
    assert (here / "section.png").read_bytes().startswith(b"\x89PNG")


def test_check_takes_overrides(here):
    status, words = houle_says("check", start(here), "--set", "domain.spacing=0.02", "--set", "porous.dam.porosity=0.4")
    assert status == 0 and "50 x 25 cells" in words and "n = 0.4," in words


@pytest.mark.parametrize("name", shipped())
def test_check_accepts_every_shipped_case(here, name):
    assert houle_says("check", name)[0] == 0


BAD = {
    "unknown key": ("porous.dam.porosty=0.4", ["porous.dam.porosty", "porosity"]),
    "porosity": ("porous.dam.porosity=39", ["porous.dam.porosity = 39", "0 < porosity <= 1", "0.39"]),
    "grain in mm": ("porous.dam.grain_diameter=15.9", ["grain_diameter = 15.9", "0.0159"]),
    "not finite": ("domain.spacing=nan", ["domain.spacing = nan", "finite"]),
    "infinite": ("time.end=inf", ["time.end = inf", "finite"]),
    "spacing": ("domain.spacing=10", ["domain.spacing = 10", "0.01 (10 mm)"]),
    "unresolved layer": ("domain.spacing=0.2", ["porous.dam", "spacings of 0.2", "domain.spacing ="]),
    "shape outside": ("porous.dam.box=[[0.4, 0.0], [1.65, 0.35]]", ["porous.dam.box", "1.65", "0 <= x <= 1 m"]),
    "gauge outside": ("gauge.front.x=3.5", ["gauge.front.x = 3.5", "0 <= x <= 1 m"]),
    "water in a solid": ("solid=[{box = [[0.1, 0.0], [0.2, 0.1]]}]", ["water[0]", "solid", "below = level"]),
    "overlap": (
        "porous=[{box=[[0.4,0.0],[0.6,0.3]],porosity=0.4,resistance={a=1.0,b=2.0}},"
        "{box=[[0.5,0.0],[0.7,0.3]],porosity=0.5,resistance={a=1.0,b=2.0}}]",
        ["porous.porous-2", "overlaps", "0.4 against 0.5"],
    ),
    "wrong type": ('domain.spacing="5 mm"', ["domain.spacing", "a number is needed", "[m]"]),
    "not a value": ("domain.spacing=5 mm", ["--set", "5 mm"]),
    "no such body": ("porous.core.porosity=0.4", ["core", "dam"]),
}


@pytest.mark.parametrize("command", ["run", "check"])
@pytest.mark.parametrize("wrong", BAD)
def test_bad_input_gets_one_message_status_2_and_writes_nothing(here, command, wrong):
    file = start(here)
    override, words = BAD[wrong]
    status, said = houle_says(command, file, "--set", override)
    assert status == 2
    message = [line for line in said.splitlines() if "reading" not in line]  # run says first which file it reads
    assert len(message) == 1 and message[0].startswith("houle: ")
    assert all(word in said for word in words), said
    assert [p.name for p in here.iterdir()] == ["demo.toml"]


@pytest.mark.parametrize("command", ["run", "check"])
def test_files_that_are_not_cases(here, command):
    (here / "broken.toml").write_text('[case]\nname = "x\n')
    (here / "binary.toml").write_bytes(b"\xff\xfe\x00")
    for file, words in (
        ("broken.toml", "line 2"),
        ("binary.toml", "UTF-8"),
        ("missing.toml", "no such file"),
        ("dam-break-rok-35", 'Did you mean "dam-break-rock-35"'),
    ):
        status, said = houle_says(command, file)
        assert status == 2 and words in said
    assert sorted(p.name for p in here.iterdir()) == ["binary.toml", "broken.toml"]


def test_a_result_folder_that_cannot_be_made_is_bad_input(here):
    file = start(here)
    status, said = houle_says("run", file, "--out", file / "results")
    assert status == 2 and "demo.toml" in said
    assert [p.name for p in here.iterdir()] == ["demo.toml"]


def test_a_picture_that_cannot_be_written_is_bad_input(here):
    status, said = houle_says("check", start(here), "--picture", here / "no" / "section.png")
    assert status == 2 and "section.png" in said


@pytest.mark.parametrize(
    ("end", "status", "words"),
    [
        (SimulationError("water lost at step 3", step=3), 3, "water lost at step 3"),
        (CaseError("time.end = 0 is outside 0 < end"), 2, "time.end = 0"),
        (OSError(errno.ENOSPC, "No space left on device", "runs/x/series.nc"), 2, "runs/x/series.nc: No space left"),
        (KeyboardInterrupt("checkpoint written, go on with: houle resume runs/x"), 130, "houle resume runs/x"),
    ],
)
def test_how_a_run_ends_is_the_exit_status(here, monkeypatch, end, status, words):
    def fails(*arguments, **options):
        raise end

    monkeypatch.setattr(houle, "run", fails, raising=False)
    monkeypatch.setattr(houle, "resume", fails, raising=False)
    for arguments in (("run", "dam-break-rock-35"), ("resume", "runs/x")):
        code, said = houle_says(*arguments)
        assert code == status and words in said


def test_run_passes_everything_on(here, monkeypatch):
    seen = {}
    monkeypatch.setattr(houle, "run", lambda case, **options: seen.update(options, case=case), raising=False)
    arguments = (
        "run",
        "standing-wave",
        "--out",
        "o",
        "--threads",
        2,
        "--until",
        0.5,
        "--set",
        "time.end=1",
        "--quiet",
        "--movie",
    )
    assert houle_says(*arguments)[0] == 0
    assert seen["case"] == "standing-wave" and str(seen["out"]) == "o" and seen["threads"] == 2
    assert (
        seen["until"] == 0.5
        and seen["overrides"] == {"time.end": 1, "output.movie": True}
        and seen["progress"] is False
    )


def test_resume_needs_a_run(here):
    status, said = houle_says("resume", here)
    assert status == 2 and "run.json" in said


def test_the_schema_on_the_output_is_json_alone(here):
    status, words = houle_says("describe", "schema")
    assert status == 0
    jsonschema.Draft202012Validator.check_schema(json.loads(words))


@pytest.mark.parametrize("topic", [t for t in TOPICS if t != "schema"])
def test_every_topic_is_described(here, topic):
    status, words = houle_says("describe", topic)
    assert status == 0 and len(words) > 400


def test_every_choice_of_the_case_file_is_described(here):
    """With what it is and where it comes from, under its topic, and as a value in the schema of the case file."""
    topics = {
        "law": "resistance", "theory": "theories", "waves": "theories", "scheme": "numerics", "transfer": "transfers",
        "kernel": "kernels", "remesh": "remeshing", "boundary": "makers", "formula": "formulas",
    }  # fmt: skip
    assert topics.keys() == TABLES.keys()
    schema = houle_says("describe", "schema")[1]
    for kind, topic in topics.items():
        words = houle_says("describe", topic)[1]
        for name, row in choices(kind).items():
            assert row.name == name and row.what and row.source
            assert name in words and (kind == "formula" or f'"{name}"' in schema), name
    words = houle_says("describe", "resistance")[1]
    assert all(law in words for law in LAWS) and "RECALLED" in words
    assert "key of [numerics]" in houle_says("describe", "numerics")[1]


def test_a_design_formula_is_described_with_its_inputs(here):
    status, words = houle_says("describe", "formulas", "overtopping-mound")
    assert status == 0 and "crest_width" in words and "m3/s/m" in words and "0.02099" in words
    status, words = houle_says("describe", "formulas", "overtoping-mound")
    assert status == 2 and 'Did you mean "overtopping-mound"' in words
    status, words = houle_says("describe", "kernels", "linear")
    assert status == 2 and "only formulas" in words


def test_an_unknown_topic_or_option_is_bad_input(here):
    status, words = houle_says("describe", "kernel")
    assert status == 2 and 'Did you mean "kernels"' in words
    assert houle_says("run", "standing-wave", "--thread", 1)[0] == 2
    assert houle_says("run", "standing-wave", "--threads", 0)[0] == 2
    assert list(here.iterdir()) == []


def test_validate_gives_its_status_on(here, monkeypatch):
    monkeypatch.setattr("houle.validation.engine.validate", lambda names, **options: len(names))
    assert houle_says("validate", "standing-wave")[0] == 1


def test_the_command_starts_without_the_numerical_packages():
    heavy = "import sys, houle.cli; print([m for m in ('numpy', 'pydantic', 'shapely') if m in sys.modules])"
    assert subprocess.check_output([sys.executable, "-c", heavy], text=True) == "[]\n"


def test_a_real_process_ends_with_the_status(here):
    command = [sys.executable, "-m", "houle", "check", "nothing.toml"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr.startswith("houle: nothing.toml: no such file") and "Traceback" not in done.stderr


ENDING = """
    import sys
    from houle.cli import main
    from houle.grid import Grid

    class Knot: ...

    knot = Knot()
    knot.itself, knot.core = knot, Grid.fit((1.0, 1.0), 0.1).core
    sys.argv = ["houle", "describe", "kernels"]
    main()
"""


def test_a_process_ends_without_a_word():
    """What is not given back at the end, to save time, is not reported as lost."""
    script = [sys.executable, "-c", textwrap.dedent(ENDING)]
    done = subprocess.run(script, capture_output=True, text=True, encoding="utf-8")
    assert done.returncode == 0 and done.stdout and done.stderr == ""


def test_a_title_that_the_terminal_cannot_write_is_no_failure(here):
    assert houle_says("new", "quay")[0] == 0
    text = Path("quay.toml").read_text(encoding="utf-8")
    title = next(line for line in text.splitlines() if line.startswith("title"))
    Path("quay.toml").write_text(text.replace(title, 'title = "jetée η"'), encoding="utf-8")
    ended = subprocess.run(
        [sys.executable, "-m", "houle", "check", "quay.toml"],
        env={**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ended.returncode == 0 and "jet?e ?" in ended.stdout, ended.stderr
