"""series.nc and surface.nc: every quantity with its unit, every row with the same names, readable by others."""

import subprocess
import sys

import h5netcdf
import h5py
import numpy as np
import pytest
import xarray as xr
from made_run import made_case, made_frame, made_grid, made_outputs, made_sample, write

from houle.case.build import asked_by_tables
from houle.case.describe import everything_written
from houle.observe.ledger import LedgerRow
from houle.observe.paddle import PaddlePositions
from houle.output import (
    OutputError,
    atomic,
    growing,
    read_series,
    read_surface,
    series_table,
    surface_table,
)


def test_every_name_has_a_unit_and_a_description():
    fields = list(everything_written())
    for field in fields:
        assert field.description and field.symbol and field.unit
    assert len({(f.place, f.name) for f in fields}) == len(fields)
    volume = next(f for f in LedgerRow.fields if f.name == "volume")
    assert volume.unit_in(2) == "m2" and volume.unit_in(3) == "m3"


def test_names_in_the_series_are_those_of_one_observer_each():
    names = [f.name for o in (*asked_by_tables().values(), PaddlePositions, LedgerRow) for f in o.fields]
    assert len(set(names)) == len(names)


def test_a_quantity_that_nobody_observes_is_refused_by_name(tmp_path):
    outputs = made_outputs(tmp_path, made_case(), made_grid())
    with pytest.raises(RuntimeError, match="'gremlins'"):
        outputs.append_series(0.0, made_sample(2, 0) | {"gremlins": 1.0})


def test_every_row_has_the_same_names(tmp_path):
    outputs = made_outputs(tmp_path, made_case(), made_grid())
    outputs.append_series(0.0, made_sample(2, 0))
    with pytest.raises(RuntimeError, match="'courant'"):
        outputs.append_series(0.1, made_sample(2, 1) | {"courant": 0.5})


@pytest.mark.parametrize("dimension", [2, 3])
def test_series_keep_values_units_and_dry_gauges(tmp_path, dimension):
    outputs = made_outputs(tmp_path, made_case(dimension), made_grid(dimension))
    write(outputs, made_grid(dimension), [], range(8))
    outputs.commit()
    series = read_series(tmp_path)
    assert series.eta.dims == ("gauge", "time") and series.pressure.dims == ("sensor", "time")
    assert series.velocity.dims == ("sensor", "time", "axis") and "".join(series.axis.values) == "xyz"[:: 4 - dimension]
    np.testing.assert_array_equal(series.eta.sel(gauge="G2")[:4], [np.nan, np.nan, np.nan, 0.2])
    np.testing.assert_array_equal(series.kinetic_energy, 5.0 * np.arange(8))
    assert series.kinetic_energy.attrs["units"] == ("J m-1" if dimension == 2 else "J")
    assert series.eta.attrs["standard_name"] == "water_surface_height_above_reference_datum"
    assert series.time.attrs == {"units": "s", "long_name": "simulated time since the start of the run", "symbol": "t"}
    assert series.attrs["Conventions"] == "CF-1.11" and series.attrs["case_hash"] == made_case(dimension).hash
    assert set(series.coords) >= {"gauge_x", "sensor_x", "sensor_z"} and ("gauge_y" in series.coords) == (
        dimension == 3
    )


def test_a_run_without_gauges_and_sensors_has_a_ledger_only(tmp_path):
    case = made_case(gauge=[], sensor=[])
    outputs = made_outputs(tmp_path, case, made_grid())
    none = ("eta", "pressure", "velocity")
    samples = [{k: v for k, v in made_sample(2, i).items() if k not in none} for i in range(3)]
    for index in range(3):
        outputs.append_series(0.1 * index, samples[index])
    outputs.commit()
    assert "eta" not in read_series(tmp_path) and read_series(tmp_path).sizes == {"time": 3}
    again = made_outputs(tmp_path, case, made_grid())
    again.series.truncate_after(0.1)
    again.append_series(0.2, samples[2])
    again.series.commit()
    assert read_series(tmp_path).sizes == {"time": 3}


@pytest.mark.parametrize("dimension", [2, 3])
def test_surface_lies_as_gridded_data_do(tmp_path, dimension):
    grid = made_grid(dimension)
    outputs = made_outputs(tmp_path, made_case(dimension), grid)
    write(outputs, grid, range(3), [])
    outputs.commit()
    surface = read_surface(tmp_path)
    assert surface.eta.dims == (("time", "x") if dimension == 2 else ("time", "y", "x"))
    np.testing.assert_array_equal(surface.eta.values[2], made_frame(grid, 2).eta.T)
    np.testing.assert_array_equal(surface.x, grid.axis_points(0))


def test_surface_and_series_are_netcdf_4_for_other_readers(tmp_path):
    outputs = made_outputs(tmp_path, made_case(), made_grid())
    write(outputs, made_grid(), range(3), range(9))
    outputs.commit()
    with h5netcdf.File(tmp_path / "series.nc") as file:
        sizes = {name: len(dimension) for name, dimension in file.dimensions.items()}
        assert sizes == {"time": 9, "gauge": 2, "sensor": 1, "axis": 2}
        assert file["velocity"].dimensions == ("sensor", "time", "axis")
        assert file["eta"].attrs["coordinates"] == "gauge_x" and "coordinates" not in file["volume"].attrs
        assert np.isnan(file["eta"].attrs["_FillValue"]).all()
    for name, read in (("series", series_table), ("surface", surface_table)):
        with xr.open_dataset(tmp_path / f"{name}.nc", engine="h5netcdf", decode_times=False) as there:
            table = read(tmp_path)
            assert set(table) == set(there.variables) and table.sizes == dict(there.sizes)
            for key in table:
                np.testing.assert_array_equal(table[key].values, there[key].values)
                assert table[key].dims == there[key].dims


# ---- appending


class Counted(atomic.Sink):
    """Counts what is written."""

    total = 0

    def write(self, data):
        Counted.total += memoryview(data).nbytes
        return super().write(data)


def test_a_commit_writes_its_own_rows_and_no_other_however_many_there_are(tmp_path, monkeypatch):
    """So do memory and time: 300 000 rows take what 3 000 take."""
    monkeypatch.setattr(growing, "Sink", Counted)
    outputs, sample = made_outputs(tmp_path, made_case(), made_grid()), made_sample(2, 5)
    written = []
    for row in range(20_000):
        outputs.append_series(0.025 * row, sample)
        if row % 1000 == 999:
            before = Counted.total
            outputs.commit()
            written.append(Counted.total - before)
    assert max(written[10:]) < 1.3 * max(written[3:8]) < 0.5 * (tmp_path / "series.nc").stat().st_size
    assert outputs.series._fresh.count == 0 and outputs.series._behind.count == 1000
    outputs.close()
    assert read_series(tmp_path).sizes["time"] == 20_000


def test_rows_go_to_the_file_before_they_fill_the_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(growing, "BUFFER", 10_000.0)
    outputs = made_outputs(tmp_path, made_case(), made_grid())
    for row in range(500):
        outputs.append_series(0.025 * row, made_sample(2, row))
    assert read_series(tmp_path).sizes["time"] > 400
    outputs.close()
    series = read_series(tmp_path)
    np.testing.assert_array_equal(series.kinetic_energy, 5.0 * np.arange(500))
    assert not list(tmp_path.glob(".*"))


def test_the_file_that_stays_is_that_of_one_commit(tmp_path):
    """Dimensions, filters and attributes, too."""
    for name, every in (("once", 2000), ("often", 37)):
        outputs = made_outputs(tmp_path / name, made_case(), made_grid())
        for row in range(1500):
            outputs.append_series(0.025 * row, made_sample(2, row))
            if row % every == every - 1:
                outputs.commit()
        outputs.close()
    xr.testing.assert_identical(read_series(tmp_path / "once"), read_series(tmp_path / "often"))
    with h5py.File(tmp_path / "once/series.nc") as one, h5py.File(tmp_path / "often/series.nc") as other:
        for name in one:
            a, b = one[name], other[name]
            assert (a.shape, a.chunks, a.compression, a.maxshape) == (b.shape, b.chunks, b.compression, b.maxshape)
            assert dict(a.attrs).keys() == dict(b.attrs).keys()


def test_who_reads_a_series_while_it_grows_keeps_what_he_opened(tmp_path):
    outputs = made_outputs(tmp_path, made_case(), made_grid())

    def go_on(rows):
        for row in rows:
            outputs.append_series(0.025 * row, made_sample(2, row))
        outputs.commit()

    go_on(range(10))
    with xr.open_dataset(tmp_path / "series.nc", engine="h5netcdf", decode_times=False) as seen:
        for begin in (10, 20, 30, 40):
            go_on(range(begin, begin + 10))
        np.testing.assert_array_equal(seen.kinetic_energy.values, 5.0 * np.arange(10))
    assert read_series(tmp_path).sizes["time"] == 50


def test_an_append_that_is_cut_short_leaves_the_file_of_the_commit_before(tmp_path, monkeypatch):
    outputs = made_outputs(tmp_path, made_case(), made_grid())
    write(outputs, made_grid(), range(2), range(10))
    outputs.commit()
    write(outputs, made_grid(), range(2, 4), range(10, 20))
    with monkeypatch.context() as patch:
        patch.setattr(growing, "append", lambda file, table: file["volume"].resize(7, 0) or 1 / 0)
        with pytest.raises(ZeroDivisionError):
            outputs.series.commit()
    assert read_series(tmp_path).sizes["time"] == 10
    outputs.commit()
    np.testing.assert_array_equal(read_series(tmp_path).kinetic_energy, 5.0 * np.arange(20))


def test_without_hard_links_it_is_the_same(tmp_path, monkeypatch):
    def none(*_):
        raise OSError(95, "not supported")

    monkeypatch.setattr(growing.os, "link", none)
    outputs = made_outputs(tmp_path, made_case(), made_grid())
    for row in range(50):
        outputs.append_series(0.025 * row, made_sample(2, row))
        outputs.commit()
    outputs.close()
    np.testing.assert_array_equal(read_series(tmp_path).kinetic_energy, 5.0 * np.arange(50))


def test_a_damaged_file_is_told_as_such(tmp_path):
    (tmp_path / "series.nc").write_bytes(b"nothing")
    with pytest.raises(OutputError, match=r"cannot read .*series\.nc"):
        read_series(tmp_path)


LONG_RUN = """
import resource
import sys
from pathlib import Path

import numpy as np

from houle.observe.ledger import LedgerRow
from houle.output.netcdf import Table, Variable, fill, times
from houle.output.series import SeriesWriter

rows, folder = 600_000, Path(sys.argv[1])
columns = {field.name: Variable(("time",), np.zeros(rows), {}) for field in LedgerRow.fields}
fill(folder / "series.nc", Table(columns, {"time": times(0.005 * np.arange(rows))}, {}), grows=True)
size = (folder / "series.nc").stat().st_size
del columns
writer = SeriesWriter(folder, 3, [LedgerRow.stations((), None)], {})
Path("/proc/self/clear_refs").write_text("5")  # the largest amount of memory is counted from here on
before = int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()
writer.truncate_after(1e9)
writer.close()
peak = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
print(size, 1024 * int(peak.split()[1]) - before)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="asks the kernel for the largest amount of memory")
def test_a_long_series_is_cut_back_and_packed_in_little_memory(tmp_path):
    """A file of 145 MB in less than half of that: a MB of chunks of each variable of two files, and a piece of one."""
    done = subprocess.run([sys.executable, "-c", LONG_RUN, str(tmp_path)], capture_output=True, text=True, check=True)
    size, more = map(int, done.stdout.split())
    assert size > 140e6
    assert more < size / 2
