"""Tables as laboratories write them: nothing is lost, nothing guessed twice, what is wrong is named by its line."""

import os
import sys
import time
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from houle import analysis
from houle.analysis.errors import AnalysisError
from houle.data.csv_table import missing_codes, read_columns
from houle.data.units import unit_of
from houle.errors import CaseError

sys.path.insert(0, str(Path(__file__).parent.parent / "campaigns"))
import tables

LVM = (
    "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\t{one}\n"
    "***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t3\t3\t\nDate\t2020/03/04\t2020/03/04\t\nX0\t0.0E+0\t0.0E+0\t\n"
    "Delta_X\t0.010000\t0.010000\t\n***End_of_Header***\t\t\t\nX_Value\tW1\tW2\tComment\n"
)
T3, LEVELS = [0.0, 0.01, 0.02], [[0.1, 0.3, 0.4], [0.2, 0.2, 0.5]]

READ = {  # text, its encoding if not UTF-8: all of them hold the times T3 and the LEVELS
    "plain": "t,W1,W2\n0,.1,.2\n0.01,.3,.2\n0.02,.4,.5\n",
    "headerless": "0,.1,.2\n0.01,.3,.2\n0.02,.4,.5\n",
    "headerless, blanks": " 0.00  0.1   0.2\n 0.01  0.3   0.2\n 0.02  0.4   0.5\n",
    "units below": "Time;W1;W2\ns;mm;cm\n0;100;20\n0,01;300;20\n0,02;400;50\n",
    "bracketed units below": "Time\tW1\tW2\n[ms]\t[m]\t[dm]\n0\t0.1\t2\n10\t0.3\t2\n20\t0.4\t5\n",
    "tab and decimal comma": "Zeit [s]\tPegel 1 [cm]\tPegel 2 [m]\n0,00\t10,0\t0,2\n0,01\t30,0\t0,2\n0,02\t40\t0,5\n",
    "Windows, umlauts": ("Zeit [s];Höhe 1 [mm];Höhe 2 [mm]\r\n0;100;200\r\n0,01;300;200\r\n0,02;400;500\r\n", "cp1252"),
    "UTF-16": ("t;a;b\n0;0,1;0,2\n0,01;0,3;0,2\n0,02;0,4;0,5\n", "utf-16"),
    "byte order mark": ("t,a,b\n0,.1,.2\n.01,.3,.2\n.02,.4,.5\n", "utf-8-sig"),
    "old Mac": "t,a,b\r0,.1,.2\r.01,.3,.2\r.02,.4,.5\r",
    "trailing separators": "t;a;b;;\n0;.1;.2;;\n.01;.3;.2;;\n.02;.4;.5;;\n",
    "trailing in the rows only": "t,a,b\n0,.1,.2,\n.01,.3,.2,\n.02,.4,.5,\n",
    "titles": (
        "Flume 3\nRun 12, regular waves\n\n# x: 1, 2\nt [s], a [mm], b [mm]\n0,100,200\n0.01,300,200\n0.02,400,500\n"
    ),
    "title above no header": "Flume 3 of the laboratory\n0;.1;.2\n.01;.3;.2\n.02;.4;.5\n",
    "a title of commas": "Flume, run 12\nt,a,b\n0,.1,.2\n.01,.3,.2\n.02,.4,.5\n",
    "names in a comment": "# t [s],a [mm],b [mm]\n0,100,200\n.01,300,200\n.02,400,500\n",
    "percent": "% t a b\n0 .1 .2\n.01 .3 .2\n.02 .4 .5\n",
    "quotes": '"t","a","b"\n"0,00","0,1","0,2"\n"0,01","0,3","0,2"\n"0,02","0,4","0,5"\n',
    "LabVIEW": LVM.format(one="One") + "0.000000\t0.1\t0.2\tstart\n0.010000\t0.3\t0.2\n0.020000\t0.4\t0.5\t\n",
    "LabVIEW without times": LVM.format(one="No") + "\t0.1\t0.2\n\t0.3\t0.2\n\t0.4\t0.5\n",
    "date and time": (
        "timestamp,a,b\n2024-02-29 23:59:59.99,.1,.2\n2024-03-01 00:00:00.00,.3,.2\n2024-03-01T00:00:00.01,.4,.5\n"
    ),
    "in two columns": (
        "Datum;Uhrzeit;a;b\n01.03.2024;12:00:00,00;,1;,2\n01.03.2024;12:00:00,01;,3;,2\n01.03.2024;12:00:00,02;,4;,5\n"
    ),
    "clock over midnight": "clock\ta\tb\n23:59:59.99\t.1\t.2\n00:00:00.00\t.3\t.2\n00:00:00.01\t.4\t.5\n",
    "pm": "time,a,b\n12:00:00.00 PM,.1,.2\n12:00:00.01 PM,.3,.2\n12:00:00.02 PM,.4,.5\n",
    "time of a zone": "time,a,b\n2024-03-01T12:00:00.00+01:00,.1,.2\n2024-03-01T12:00:00.01+01:00,.3,.2\n"
    "2024-03-01T12:00:00.02+01:00,.4,.5\n",
    "units of LabVIEW": "LabVIEW Measurement\t\nWriter_Version\t2\n***End_of_Header***\t\nChannels\t2\t\n"
    "Y_Unit_Label\tmm\tcm\t\n***End_of_Header***\t\t\t\nX_Value\tW1\tW2\tComment\n"
    "0\t100\t20\t\n0.01\t300\t20\t\n0.02\t400\t50\t\n",
    "times last": "a,b,t [ms]\n.1,.2,0\n.3,.2,10\n.4,.5,20\n",
    "a count": "No.;Time / s;a / mm;b / mm\n1;0;100;200\n2;0,01;300;200\n3;0,02;400;500\n",
    "units in names": "t(ms),a_cm,b (m)\n0,10,.2\n10,30,.2\n20,40,.5\n",
    "numbers for names": "t;1;2\n0;.1;.2\n.01;.3;.2\n.02;.4;.5\n",
    "exponents": "t a b\n0 1.0D-01 2E-1\n1d-2 3e-1 2e-1\n2.0E-02 .4 .5\n",
    "minus of typography": "t,a,b\n0,.1,.2\n.01,.3,.2\n.02,.4,.5\n",
}


@pytest.mark.parametrize("name", READ)
def test_tables_are_read_as_they_are_written(tmp_path, name):
    text, encoding = (READ[name], "utf-8") if isinstance(READ[name], str) else READ[name]
    file = tmp_path / "a.csv"
    file.write_bytes(text.encode(encoding))
    data = analysis.read_csv(file, [1.0, 2.0])
    np.testing.assert_allclose(data.time.values, T3, atol=2e-12 if "date" in name or "clock" in name else 1e-15)
    np.testing.assert_allclose(data.eta.values, LEVELS, rtol=1e-14)
    assert data.gauge_x.values.tolist() == [1.0, 2.0] and data.attrs["notes"] == ""


REFUSED = {  # text, what is said
    "no times": ("W1,W2\n.1,.2\n.3,.2\n.2,.5\n", r"no column of times: its first column, 'W1',.* interval="),
    "no times, rising": ("W1,W2\n.1,.2\n.3,.2\n.4,.5\n", "no column of times"),
    "no times, no names": (".1,.2\n.3,.2\n.2,.5\n", "no column of times"),
    "a word": ("t,a,b\n0,.1,.2\n1,.1,.2\n2,oops,.2\n", r"line 4: 'a' is 'oops', not a number"),
    "a word in the first row": ("t,a,b\n0,oops,.2\n1,.1,.2\n2,.1,.2\n", r"line 2: 'oops' is not a number"),
    "a short row": ("t,a,b\n0,.1,.2\n1,.1\n2,.1,.2\n", "line 3 has 2 cells, the lines above it 3"),
    "a long row": ("t,a,b\n0,.1,.2\n1,.1,.2,.3\n2,.1,.2\n", "line 3 has 4 cells"),
    "too few names": ("t,a\n0,.1,.2\n1,.1,.2\n2,.1,.2\n", "line 1 has 2 names, the rows below it 3"),
    "backwards": ("t,a,b\n0,.1,.2\n2,.1,.2\n1,.1,.2\n", "line 4: the time is 1 s after 2"),
    "a time that is none": ("t,a,b\n0,.1,.2\n,.1,.2\n1,.1,.2\n", "line 3: the time is nan"),
    "both decimal signs": ("t;a;b\n0;1.5;2\n1;1,5;2\n2;1;2\n", "line 3: '1,5' has a decimal ',', the numbers above"),
    "thousands": ("t;a;b\n0;1.234,5;2\n1;1;2\n2;1;2\n", "1.234,5"),
    "unit of time": ("t [mm],a,b\n0,1,2\n1,1,2\n2,1,2\n", "'mm' is not one of"),
    "volts": ("t [s],a [V],b [V]\n0,1,2\n1,1,2\n2,1,2\n", "'V' is not one of"),
    "two units": ("t [s],a [mm],b\ns,cm,m\n0,1,2\n1,1,2\n2,1,2\n", "which is right"),
    "day or month": ("date,a,b\n03/04/2024,1,2\n04/04/2024,1,2\n05/04/2024,1,2\n", "day and a month or the reverse"),
    "no gauge": ("t\n0\n1\n2\n", "no gauge"),
    "words": ("hello\nworld\n", "no rows of numbers"),
    "empty": ("", "is empty"),
    "binary": ("t,a,b\n0,1,2\n\0\0\0", "is not text"),
    "one line for ever": ("t,a,b\n0,1,2\n1," + "1" * 1_200_000, "more than 1048576 letters"),
    "a spreadsheet": ("PK\x03\x04" + "x" * 200, "spreadsheet"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_wrong_is_named_by_its_line(tmp_path, name):
    text, said = REFUSED[name]
    file = tmp_path / "a.csv"
    file.write_text(text)
    with pytest.raises(AnalysisError, match=said) as error:
        analysis.read_csv(file, [1.0, 2.0])
    assert str(file) in str(error.value)


def test_a_table_without_times_takes_the_interval(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("W1,W2\n.1,.2\n.3,.2\n.4,.5\n")
    data = analysis.read_csv(file, [1.0, 2.0], interval=0.01)
    assert data.time.values.tolist() == T3 and data.eta.values.tolist() == LEVELS


def test_places_have_units(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("# x [mm]: 1000, 2000\nt,a,b\n0,.1,.2\n1,.1,.2\n2,.1,.2\n")
    assert analysis.read_csv(file).gauge_x.values.tolist() == [1.0, 2.0]
    file.write_text("t,x=100cm [mm],x=2 m [mm]\n0,1,2\n1,1,2\n2,1,2\n")
    data = analysis.read_csv(file)
    assert data.gauge_x.values.tolist() == [1.0, 2.0] and data.eta.values[0, 0] == 1e-3
    file.write_text("t;x=1,5 [mm];x=2,25 [mm]\n0;1,5;2\n1;1;2\n2;1;2\n")
    data = analysis.read_csv(file)
    assert data.gauge_x.values.tolist() == [1.5, 2.25] and data.eta.values[0, 0] == 1.5e-3
    file.write_text("t,x=1000mm,x=2000mm\n0,1,2\n1,1,2\n2,1,2\n")
    with pytest.raises(AnalysisError, match="is mm the unit of the place or of the levels"):
        analysis.read_csv(file)


def test_units_in_names():
    for name, parts in {
        "W1 [mm]": ("W1", "mm"), "t(ms)": ("t", "ms"), "W1_cm": ("W1", "cm"), "eta / mm": ("eta", "mm"),
        "W1": ("W1", ""),
        "Time s": ("Time", "s"), "W1 (x=1.35)": ("W1 (x=1.35)", ""), "probe (1)": ("probe (1)", ""),
        "x=1.5 m": ("x=1.5 m", ""),
        "u [furlong]": ("u", "furlong"),
    }.items():  # fmt: skip
        assert unit_of(name) == parts


def test_codes_for_missing_values(tmp_path):
    """A code lies away from all levels; a level that happens to be written like one does not."""
    level = 0.25 + 0.02 * np.sin(np.arange(50.0))
    for code in (-9999.0, 9999.0, 99.99, -999.25, 999.9, 1e30, -32768.0, 65535.0, 9.96921e36):
        spoiled = level.copy()
        spoiled[[7, 8]] = code
        assert np.flatnonzero(missing_codes(spoiled)).tolist() == [7, 8]
        spoiled[[7, 8]] = np.float32(code)
        assert np.flatnonzero(missing_codes(spoiled)).tolist() == [7, 8]
    assert not missing_codes(level).any() and not missing_codes(np.array([99.5, 99.99, 100.4, 98.7])).any()
    assert not missing_codes(np.full(5, -9999.0)).any()
    file = tmp_path / "a.csv"
    file.write_text("t,a [mm]\n" + "".join(f"{i},{-9999 if i == 7 else 1e3 * z}\n" for i, z in enumerate(level)))
    data = analysis.read_csv(file, [1.0])
    assert np.isnan(data.eta.values[0, 7]) and np.isfinite(data.eta.values).sum() == 49
    assert data.attrs["notes"] == "a: -9999 is taken for a missing value, 1 times, first in line 9"
    with pytest.raises(AnalysisError, match=r"no level at t = 7 s.*-9999 is taken for a missing value"):
        analysis.as_gauges(data)
    file.write_text("t_s,eta_m\n" + "".join(f"{i},{-9999 if i == 7 else z}\n" for i, z in enumerate(level)))
    with pytest.raises(CaseError, match="line 9: eta_m = -9999 is a code for a missing value"):
        read_columns(file, ("t_s", "eta_m"), "waves.file")


def test_tables_of_case_files_take_the_same_forms(tmp_path):
    file = tmp_path / "a.csv"
    for text in ("t_s,eta_m\n0,.1\n.5,.2\n", "Time [ms];eta [cm]\n0;10\n500;20\n",
                 "# lab\nETA (mm)\tt [s]\n100\t0\n200\t0,5\n",
                 "date,eta_m\n2024-03-01 12:00:00,.1\n2024-03-01 12:00:00.5,.2\n"):  # fmt: skip
        file.write_text(text)
        (t, eta), _ = read_columns(file, ("t_s", "eta_m"), "waves.file")
        assert np.allclose(t, [0, 0.5]) and np.allclose(eta, [0.1, 0.2])
    for text in ("t,eta\n0,.1\n.5,.2\n", "0,.1\n.5,.2\n", "t_s,eta [V]\n0,1\n1,2\n", "t_s;eta_m\n0;x\n1;2\n"):
        file.write_text(text)
        with pytest.raises(CaseError, match=r"waves\.file = .*header t_s,eta_m"):
            read_columns(file, ("t_s", "eta_m"), "waves.file")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes of POSIX")
def test_devices_pipes_and_folders_are_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "latin").mkdir()
    for place, said in (("/dev/zero", "device"), (tmp_path / "pipe", "pipe"), (tmp_path / "latin", "folder"),
                        ("a\0b", "cannot be read"), ("x" * 5000, "cannot be read")):  # fmt: skip
        start = time.perf_counter()
        with pytest.raises(AnalysisError, match=said):
            analysis.read_csv(place)
        with pytest.raises(CaseError, match=said):
            read_columns(place, ("t_s",), "waves.file")
        assert time.perf_counter() - start < 2.0


def test_a_long_table_needs_little_more_than_its_numbers(tmp_path):
    """Python's own memory, with NumPy's arrays: at most three times the numbers (it was twenty times the file)."""
    rows, columns = 20_000, 8
    row = ",".join(["0.123456"] * (columns - 1))
    file = tmp_path / "long.csv"
    file.write_text(
        "t," + ",".join(f"W{i}" for i in range(1, columns)) + "\n" + "".join(f"{i},{row}\n" for i in range(rows))
    )
    analysis.read_csv(file, np.arange(columns - 1.0))  # what is imported stays
    tracemalloc.start()
    data = analysis.read_csv(file, np.arange(columns - 1.0))
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert data.eta.shape == (columns - 1, rows) and most < 3 * 8 * rows * columns


def test_spoiled_tables_and_records():
    """A slice of tests/campaigns/tables.py: errors of ours or an answer, within two seconds."""
    wrong = tables.campaign(100, seed=2)
    assert not [words for words in wrong if "Traceback" in words], "\n".join(wrong)
    assert len(wrong) <= 2, "\n".join(wrong)  # one may wait for a busy machine
