"""What a run writes can be read at any moment, holds what it was given, and goes on after a stop as if it had none."""

import dataclasses
import json
import subprocess
import sys
import textwrap
import time
from pathlib import Path
from types import SimpleNamespace

import h5netcdf
import h5py
import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from houle import fields, ledger
from houle.frame import Frame
from houle.grid import Grid
from houle.output import (
    OutputError,
    Outputs,
    checkpoints,
    collect,
    load_newest,
    read_fields,
    read_manifest,
    read_series,
    read_surface,
    save_checkpoint,
    series_table,
    summarise,
    surface_table,
    write_manifest,
)

SINGLE = 2e-7  # relative rounding of float32, in which fields are stored


def made_case(dimension=2):
    """As much of a case as the writers and pictures ask for: a tank with a porous block, gauges and a sensor."""
    at = (0.45, 0.05) if dimension == 2 else (0.45, 0.1, 0.05)
    box = [[0.3, 0.0], [0.6, 0.2]] if dimension == 2 else [[0.3, 0.0, 0.0], [0.6, 0.2, 0.2]]
    return SimpleNamespace(
        case=SimpleNamespace(name="slosh", title="Sloshing tank"),
        hash="0123",
        path=None,
        reference=None,
        gauge=[SimpleNamespace(name="G1", x=0.2, y=0.1), SimpleNamespace(name="G2", x=0.8, y=0.1)],
        sensor=[SimpleNamespace(name="P1", at=at)],
        porous=[SimpleNamespace(name="block", porosity=0.5, box=box, polygon=None, below=None)],
        solid=[],
        gate=[],
        water=[SimpleNamespace(box=None, polygon=None, below=0.15)],
        waves=None,
        sponge=[],
        absorber=[],
        open=[],
        **dict.fromkeys(("runup", "overtopping", "flux", "phreatic", "force"), ()),
        to_toml=lambda: "[case]",
    )


def made_grid(dimension=2):
    return Grid.fit((0.9, 0.3) if dimension == 2 else (0.9, 0.3, 0.3), 0.03)


def made_frame(grid, index):
    """Frame number `index`, 0.1 s apart, of a sloshing tank; the number of particles changes from frame to frame."""
    d, t = grid.dimension, 0.1 * index
    level = 0.15 + 0.05 * np.cos(np.pi * grid.points()[..., 0, 0] / 0.9) * np.cos(6 * t)
    rng = np.random.default_rng(index)
    position = rng.uniform(0, grid.size, (2000 + 150 * (index % 3) + 4 * index, d))
    position = position[position[:, -1] < 0.15 + 0.05 * np.cos(np.pi * position[:, 0] / 0.9) * np.cos(6 * t)]
    count = len(position)
    eta = np.where(np.arange(grid.shape[0]) == 2, np.nan, level.T).T
    return Frame(
        time=t,
        step=7 * index,
        position=position,
        velocity=rng.normal(size=(count, d)),
        volume=np.full(count, 1e-4),
        porosity=np.where(position[:, 0] > 0.5, 0.5, 1.0),
        pressure=9810 * position[:, -1],
        cell_pressure=rng.uniform(0, 1e3, grid.shape),
        cell_fill=rng.uniform(0, 1, grid.shape),
        cell_velocity=rng.normal(size=(*grid.shape, d)),
        cell_porosity=np.full(grid.shape, 0.7),
        eta=eta,
    )


def made_sample(dimension, index):
    """Row number `index`, 0.025 s apart; the second gauge is dry at first."""
    return {
        "eta": np.array([0.1 + 0.01 * index, np.nan if index < 3 else 0.2]),
        "pressure": np.array([100.0 * index]),
        "velocity": np.full((1, dimension), 0.1 * index),
        "volume": np.asarray(0.13),
        "volume_drift": np.asarray(1e-15 * index),
        "kinetic_energy": np.asarray(5.0 * index),
        "potential_energy": np.asarray(90.0 - index),
        "pressure_iterations": np.asarray(11.0),
    }


def write(outputs, grid, frames, rows):
    """Frames and rows by number, in the order of time as a run hands them over."""
    for index in frames:
        outputs.append_frame(made_frame(grid, index))
    for index in rows:
        outputs.append_series(0.025 * index, made_sample(grid.dimension, index))


def assert_same_frame(got, wanted):
    for field in dataclasses.fields(Frame):
        a, b = np.asarray(getattr(got, field.name)), np.asarray(getattr(wanted, field.name))
        assert a.shape == b.shape, field.name
        np.testing.assert_allclose(a, b, rtol=SINGLE, atol=0, err_msg=field.name)


# ---- the table


def test_every_name_has_a_unit_and_a_description():
    for field in fields.FIELDS:
        assert field.description and field.symbol and field.unit
    assert len({(f.place, f.name) for f in fields.FIELDS}) == len(fields.FIELDS)
    assert fields.find("volume").unit_in(2) == "m2" and fields.find("volume").unit_in(3) == "m3"


def test_the_table_and_the_ledger_know_the_same_operations():
    assert fields.OPERATIONS == ledger.OPERATIONS


def test_a_quantity_that_is_not_in_the_table_is_refused_by_name(tmp_path):
    outputs = Outputs(tmp_path, made_case(), made_grid())
    with pytest.raises(RuntimeError, match="'gremlins'"):
        outputs.append_series(0.0, made_sample(2, 0) | {"gremlins": 1.0})


def test_every_row_has_the_same_names(tmp_path):
    outputs = Outputs(tmp_path, made_case(), made_grid())
    outputs.append_series(0.0, made_sample(2, 0))
    with pytest.raises(RuntimeError, match="'courant'"):
        outputs.append_series(0.1, made_sample(2, 1) | {"courant": 0.5})


# ---- series and surface


@pytest.mark.parametrize("dimension", [2, 3])
def test_series_keep_values_units_and_dry_gauges(tmp_path, dimension):
    outputs = Outputs(tmp_path, made_case(dimension), made_grid(dimension))
    write(outputs, made_grid(dimension), [], range(8))
    outputs.commit()
    series = read_series(tmp_path)
    assert series.eta.dims == ("gauge", "time") and series.pressure.dims == ("sensor", "time")
    assert series.velocity.dims == ("sensor", "time", "axis") and "".join(series.axis.values) == "xyz"[:: 4 - dimension]
    np.testing.assert_array_equal(series.eta.sel(gauge="G2")[:4], [np.nan, np.nan, np.nan, 0.2])
    np.testing.assert_array_equal(series.kinetic_energy, 5.0 * np.arange(8))
    assert series.kinetic_energy.attrs["units"] == ("J m-1" if dimension == 2 else "J")
    assert series.eta.attrs["standard_name"] == "water_surface_height_above_reference_datum"
    assert series.time.attrs == {"units": "s", "long_name": "simulated time", "symbol": "t"}
    assert series.attrs["Conventions"] == "CF-1.11" and series.attrs["case_hash"] == "0123"
    assert set(series.coords) >= {"gauge_x", "sensor_x", "sensor_z"} and ("gauge_y" in series.coords) == (
        dimension == 3
    )


def test_a_run_without_gauges_and_sensors_has_a_ledger_only(tmp_path):
    case = made_case()
    case.gauge, case.sensor = [], []
    outputs = Outputs(tmp_path, case, made_grid())
    none = {"eta": np.zeros(0), "pressure": np.zeros(0), "velocity": np.zeros((0, 2))}
    for index in range(3):
        outputs.append_series(0.1 * index, made_sample(2, index) | none)
    outputs.commit()
    assert "eta" not in read_series(tmp_path) and read_series(tmp_path).sizes == {"time": 3}
    again = Outputs(tmp_path, case, made_grid())
    again.series.truncate_after(0.1)
    again.append_series(0.2, made_sample(2, 2) | none)
    again.series.commit()
    assert read_series(tmp_path).sizes == {"time": 3}


@pytest.mark.parametrize("dimension", [2, 3])
def test_surface_lies_as_gridded_data_do(tmp_path, dimension):
    grid = made_grid(dimension)
    outputs = Outputs(tmp_path, made_case(dimension), grid)
    write(outputs, grid, range(3), [])
    outputs.commit()
    surface = read_surface(tmp_path)
    assert surface.eta.dims == (("time", "x") if dimension == 2 else ("time", "y", "x"))
    np.testing.assert_array_equal(surface.eta.values[2], made_frame(grid, 2).eta.T)
    np.testing.assert_array_equal(surface.x, grid.axis_points(0))


def test_surface_and_series_are_netcdf_4_for_other_readers(tmp_path):
    outputs = Outputs(tmp_path, made_case(), made_grid())
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


# ---- fields


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("frames", [1, 5])
@pytest.mark.parametrize("packed", [False, True])
def test_fields_give_back_the_frames(tmp_path, dimension, frames, packed):
    grid = made_grid(dimension)
    outputs = Outputs(tmp_path, made_case(dimension), grid)
    write(outputs, grid, range(frames), [])
    outputs.close() if packed else outputs.commit()
    assert (tmp_path / ".fields").exists() != packed
    got = read_fields(tmp_path)
    assert len(got) == frames and got.grid == grid
    for index in range(frames):
        assert_same_frame(got.frame(index), made_frame(grid, index))


def vtk_step(file, step):
    """A step as the VTKHDF specification has a reader find it: particles, vertices, cells of the image."""
    points, image = file["VTKHDF/particles"], file["VTKHDF/grid"]
    steps, total = points["Steps"], points["Steps"].attrs["NSteps"]
    count = points["NumberOfPoints"][steps["PartOffsets"][step]]
    first = steps["PointOffsets"][step]
    earlier = step  # every part before has one entry more in Offsets than it has cells
    cells = points["Vertices/NumberOfCells"][step]
    begin = steps["CellOffsets"][step, 0] + earlier
    ids = points["Vertices/Connectivity"][steps["ConnectivityIdOffsets"][step, 0] :][:cells]
    return SimpleNamespace(
        points=points["Points"][first : first + count],
        offsets=points["Vertices/Offsets"][begin : begin + cells + 1],
        ids=ids,
        pressure=points["PointData/pressure"][first : first + count],
        empty=[points[f"{kind}/Offsets"][step] for kind in ("Lines", "Polygons", "Strips")],
        fill=image["CellData/fill"][step if total > 1 else ...],
        velocity=image["CellData/velocity"][step if total > 1 else ...],
    )


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("dimension", [2, 3])
def test_the_file_is_what_the_vtkhdf_specification_asks_for(tmp_path, dimension, packed):
    grid = made_grid(dimension)
    outputs = Outputs(tmp_path, made_case(dimension), grid)
    write(outputs, grid, range(4), [])
    outputs.close() if packed else outputs.commit()
    with h5py.File(tmp_path / "fields.vtkhdf") as file:
        root = file["VTKHDF"]
        assert root.attrs["Type"] == b"PartitionedDataSetCollection" and tuple(root.attrs["Version"]) == (2, 2)
        assert (
            root.id.get_create_plist().get_link_creation_order()
            == h5py.h5p.CRT_ORDER_TRACKED | h5py.h5p.CRT_ORDER_INDEXED
        )
        assert list(root["Assembly"]) == ["particles", "grid"]
        assert [root["Assembly"].get(name, getlink=True).path for name in root["Assembly"]] == [
            "/VTKHDF/particles",
            "/VTKHDF/grid",
        ]
        assert [root[name].attrs["Index"] for name in ("particles", "grid")] == [0, 1]
        extent = root["grid"].attrs["WholeExtent"]
        for index in range(4):
            step, wanted = vtk_step(file, index), made_frame(grid, index)
            keep = [0, 2] if dimension == 2 else [0, 1, 2]
            np.testing.assert_allclose(step.points[:, keep], wanted.position, rtol=SINGLE)
            np.testing.assert_array_equal(step.offsets, np.arange(len(wanted.volume) + 1))
            np.testing.assert_array_equal(step.ids, np.arange(len(wanted.volume)))
            np.testing.assert_allclose(step.pressure, wanted.pressure, rtol=SINGLE)
            assert step.empty == [0, 0, 0]
            assert step.fill.shape == tuple(extent[5:0:-2]) and step.velocity.shape == (*step.fill.shape, 3)
            fill = step.fill[:, 0].T if dimension == 2 else step.fill.T
            np.testing.assert_allclose(fill, wanted.cell_fill, rtol=SINGLE)


def test_every_array_carries_its_unit(tmp_path):
    outputs = Outputs(tmp_path, made_case(), made_grid())
    write(outputs, made_grid(), range(2), [])
    outputs.close()
    with h5py.File(tmp_path / "fields.vtkhdf") as file:
        assert file["VTKHDF/particles/PointData/volume"].attrs["units"] == "m2"
        assert "pore velocity" in file["VTKHDF/particles/PointData/velocity"].attrs["long_name"]
        assert "Darcy velocity" in file["VTKHDF/grid/CellData/velocity"].attrs["long_name"]


# ---- going on


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("stop", [0, 2, 5])
def test_a_resumed_run_leaves_the_files_of_an_uninterrupted_one(tmp_path, packed, stop):
    grid, case = made_grid(), made_case()
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    outputs = Outputs(whole, case, grid)
    write(outputs, grid, range(7), range(25))
    outputs.close()

    outputs = Outputs(parts, case, grid)
    write(outputs, grid, range(6), range(21))
    outputs.close() if packed else outputs.commit()
    outputs = Outputs(parts, case, grid)
    outputs.truncate_after(0.1 * stop, 0.1 * stop)
    assert len(read_fields(parts)) == stop + 1
    write(outputs, grid, range(stop + 1, 7), range(4 * stop + 1, 25))
    outputs.close()

    xr.testing.assert_identical(read_series(parts), read_series(whole))
    xr.testing.assert_identical(read_surface(parts), read_surface(whole))
    got, wanted = read_fields(parts), read_fields(whole)
    np.testing.assert_array_equal(got.times, wanted.times)
    for index in range(7):
        one, other = got.frame(index), wanted.frame(index)
        for field in dataclasses.fields(Frame):
            np.testing.assert_array_equal(getattr(one, field.name), getattr(other, field.name))


def test_a_run_cut_back_twice_forgets_its_future_twice(tmp_path):
    grid, case = made_grid(), made_case()
    outputs = Outputs(tmp_path, case, grid)
    write(outputs, grid, range(9), [0])
    outputs.close()
    for last, more in ((5, 7), (2, 4)):  # goes on by one frame or two, then is killed
        outputs = Outputs(tmp_path, case, grid)
        outputs.truncate_after(0.1 * last, 0.0)
        write(outputs, grid, range(last + 1, more), [])
        outputs.commit()
        assert len(read_fields(tmp_path)) == more
    for index in range(4):
        assert_same_frame(read_fields(tmp_path).frame(index), made_frame(grid, index))


WRITE_FOREVER = """
    import sys
    sys.path.insert(0, {here!r})
    from test_output import made_case, made_frame, made_grid, made_sample
    from houle.output import Outputs, save_checkpoint
    grid = made_grid()
    outputs = Outputs({folder!r}, made_case(), grid)
    for index in range(1000000):
        outputs.append_frame(made_frame(grid, index))
        outputs.append_series(0.025 * index, made_sample(2, index))
        outputs.commit()
        save_checkpoint({folder!r}, index, {{"index": index, "field": [float(index)] * 10000}}, {{"time": 0.1 * index}})
        print(index, flush=True)
"""


@pytest.mark.parametrize("wait", [0.0, 0.011, 0.023, 0.037])
def test_kill_9_at_any_moment_leaves_readable_files(tmp_path, wait):
    script = textwrap.dedent(WRITE_FOREVER).format(here=str(Path(__file__).parent), folder=str(tmp_path))
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            if int(line) == 3:
                break
        time.sleep(wait)
        process.kill()
    saved = load_newest(tmp_path)
    assert saved.step >= 3 and saved.meta["time"] == 0.1 * saved.step
    np.testing.assert_array_equal(saved.state["field"], np.full(10000, float(saved.step)))
    grid, got = made_grid(), read_fields(tmp_path)
    assert len(got) > saved.step and read_series(tmp_path).sizes["time"] > saved.step
    for index in range(len(got)):
        assert_same_frame(got.frame(index), made_frame(grid, index))
    outputs = Outputs(tmp_path, made_case(), grid)
    outputs.truncate_after(saved.meta["time"], saved.meta["time"])
    outputs.close()
    assert len(read_fields(tmp_path)) == saved.step + 1 == read_surface(tmp_path).sizes["time"]


FILL_THE_DISK = """
    import resource, sys
    sys.path.insert(0, {here!r})
    from test_output import made_case, made_frame, made_grid, made_sample
    from houle.output import OutputError, Outputs, save_checkpoint
    grid = made_grid()
    outputs = Outputs({folder!r}, made_case(), grid)
    outputs.append_frame(made_frame(grid, 0))
    outputs.append_series(0.0, made_sample(2, 0))
    outputs.commit()
    save_checkpoint({folder!r}, 1, {{"a": [1.0] * 100}}, {{}})
    outputs.append_frame(made_frame(grid, 1))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
    for action in (outputs.fields.commit, outputs.surface.commit, outputs.close, outputs.fields.commit,
                   lambda: save_checkpoint({folder!r}, 2, {{"a": [1.0] * 10000}}, {{}})):
        try:
            action()
        except OutputError as error:
            print(error)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no resource limits")
def test_a_full_disk_is_one_message_and_spoils_nothing(tmp_path):
    script = textwrap.dedent(FILL_THE_DISK).format(here=str(Path(__file__).parent), folder=str(tmp_path))
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == ""
    messages = done.stdout.splitlines()
    assert sum(line.startswith(f"cannot write {tmp_path}") for line in messages) == 5
    assert all("write elsewhere" in line for line in messages if not line.startswith("cannot write"))
    assert_same_frame(read_fields(tmp_path).frame(0), made_frame(made_grid(), 0))
    assert load_newest(tmp_path).step == 1 and read_surface(tmp_path).sizes["time"] == 1
    assert not list(tmp_path.rglob(".*tmp*"))


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="file/run") as raised:
        write_manifest(tmp_path / "file", {})
    assert "a file stands where a folder is needed" in str(raised.value)


def test_reading_a_folder_without_a_run_says_so(tmp_path):
    for read in (read_series, read_surface, read_fields, read_manifest):
        with pytest.raises(OutputError, match="is this the folder of a run"):
            read(tmp_path)


# ---- checkpoints


def test_a_checkpoint_gives_back_every_bit(tmp_path):
    strange = np.array([np.nan, -0.0, np.inf, 5e-324]).view(np.uint64) + np.array([7, 0, 0, 0], np.uint64)
    state = {
        "nan_with_a_message": strange.view(np.float64),
        "single": np.float32([1 / 3]),
        "number": np.int32(-5),
        "flag": True,
        "turned": np.arange(12.0).reshape(3, 4).T,
        "nothing": np.zeros((0, 2)),
    }
    save_checkpoint(tmp_path, 12, state, {"time": 0.1, "rng": 2**127 + 1})
    got = load_newest(tmp_path)
    assert (got.step, got.meta, set(got.state)) == (12, {"time": 0.1, "rng": 2**127 + 1}, set(state))
    for name, value in state.items():
        wanted = np.asarray(value)
        assert got.state[name].dtype == wanted.dtype and got.state[name].shape == wanted.shape
        assert got.state[name].tobytes() == wanted.tobytes()


@pytest.mark.parametrize("harm", ["one bit", "cut", "empty"])
def test_a_damaged_checkpoint_is_passed_over(tmp_path, harm):
    for step in (100, 200):
        path = save_checkpoint(tmp_path, step, {"a": np.full(5000, float(step))}, {})
    data = bytearray(path.read_bytes())
    data[data.index(np.float64(200).tobytes() * 3) + 8] ^= 1
    path.write_bytes({"one bit": data, "cut": data[: len(data) // 2], "empty": b""}[harm])
    assert load_newest(tmp_path).step == 100


def test_the_newest_two_are_kept_and_a_run_cut_back_forgets_its_future(tmp_path):
    for step in (1, 20, 3000):
        save_checkpoint(tmp_path, step, {}, {})
    assert [path.name for path in checkpoints(tmp_path)] == ["checkpoint-3000.h5", "checkpoint-20.h5"]
    save_checkpoint(tmp_path, 40, {}, {})
    assert [path.name for path in checkpoints(tmp_path)] == ["checkpoint-40.h5", "checkpoint-20.h5"]


# ---- manifest


def test_the_manifest_says_what_ran_where_and_how_it_went(tmp_path):
    start = collect(made_case(), threads=2)
    outcome = {"time": 2.0, "steps": np.int64(10), "particles": 5, "wall_seconds": 1.0, "cpu_seconds": 1.0}
    outcome["operations"] = {"transfer": 0.5}
    write_manifest(tmp_path, summarise(start, finished=True, volume_drift=np.nan, energy={"kinetic": 1.0}, **outcome))
    got = json.loads((tmp_path / "run.json").read_text(), parse_constant=pytest.fail)
    assert got["finished"] is True and got["case"]["hash"] == "0123" and got["case"]["text"] == "[case]"
    assert (
        got["machine"]["threads"] == 2
        and got["machine"]["cpu"]
        and got["python"]["packages"]["numpy"] == np.__version__
    )
    build = got["houle"]["build"]
    assert build["compiler"] and "O" in build["flags"] and build["threads"] >= 1
    assert got["summary"]["steps"] == 10 and got["summary"]["volume_drift"] is None
    assert got["ended"] >= got["started"] and read_manifest(tmp_path) == got


# ---- pictures


def has_colour(path, colour):
    """Number of pixels of exactly this colour."""
    from matplotlib.colors import to_rgb
    from matplotlib.image import imread

    return int((np.abs(imread(path)[..., :3] - np.array(to_rgb(colour))).max(axis=-1) < 0.004).sum())


@pytest.mark.parametrize("dimension", [2, 3])
def test_pictures_of_a_run(tmp_path, dimension):
    from houle.output import drawing, pictures

    grid, case = made_grid(dimension), made_case(dimension)
    outputs = Outputs(tmp_path, case, grid)
    write(outputs, grid, range(6), range(21))
    outputs.close()
    made = pictures.write_pictures(
        tmp_path, case, grid, read_series(tmp_path), read_surface(tmp_path), read_fields(tmp_path)
    )
    names = {"surface", "pressure", "ledger", "gauges"} | ({"plan"} if dimension == 3 else set())
    assert {path.stem for path in made} == names and not list(tmp_path.glob(".*"))
    assert has_colour(tmp_path / "surface.png", drawing.WATER) > 300
    assert has_colour(tmp_path / "surface.png", drawing.SHADE) > 3000
    assert has_colour(tmp_path / "surface.png", drawing.LABORATORY) == 0


@pytest.mark.parametrize("maker", ["zone", "source"])
def test_pictures_show_makers_sponges_and_still_water(tmp_path, maker):
    from matplotlib.image import imread

    from houle.output import pictures

    grid, case = made_grid(), made_case()
    outputs = Outputs(tmp_path, case, grid)
    write(outputs, grid, range(6), range(21))
    outputs.close()
    pages = []
    for makers, boxes in (
        ({"zone": None, "source": None, "piston": None}, []),
        ({"zone": None, "source": None, "piston": None}, [((0.7, 0.0), (0.9, 0.3))]),
        (
            {
                "zone": None,
                "source": None,
                "piston": None,
                maker: SimpleNamespace(x=(0.0, 0.3) if maker == "zone" else 0.3),
            },
            [],
        ),
    ):
        case.waves, case.sponge = SimpleNamespace(**makers), [SimpleNamespace(box=box) for box in boxes]
        page = pictures.surface_picture(tmp_path / "surface.png", case, grid, read_surface(tmp_path))
        pages.append(imread(page)[..., :3].mean(axis=-1))
    case.open = [SimpleNamespace(side="right")]
    page = pictures.surface_picture(tmp_path / "surface.png", case, grid, read_surface(tmp_path))
    calm, sponge, made, opened = [*pages, imread(page)[..., :3].mean(axis=-1)]
    assert (np.abs(sponge - calm) > 0.2).sum() > 300 and (np.abs(made - calm) > 0.2).sum() > 300
    assert (np.abs(opened - made) > 0.2).sum() > 100


def test_laboratory_points_are_drawn_and_scored(tmp_path):
    from houle import laboratory
    from houle.output import drawing, pictures

    grid, case = made_grid(), made_case()
    outputs = Outputs(tmp_path, case, grid)
    write(outputs, grid, range(3), range(3))
    outputs.close()
    case.reference = SimpleNamespace(error=0.004, label="someone (1999)")
    surface = read_surface(tmp_path)
    x = np.linspace(0.2, 0.8, 9)
    points = laboratory.Points(np.full(9, 0.15), x, laboratory.level(surface, 0.15, x))
    pictures.surface_picture(tmp_path / "surface.png", case, grid, surface, points)
    assert has_colour(tmp_path / "surface.png", drawing.LABORATORY) > 50
    assert laboratory.score(points, surface).overall < 1e-15


@given(
    st.lists(st.floats(-50, 150), min_size=1, max_size=9),
    st.floats(1, 12),
)
def test_labels_at_the_ends_of_lines_never_overlap(heights, gap):
    from houle.output.drawing import apart

    placed = np.array(heights) + apart(heights, gap, 0.0, 100.0)
    order = np.argsort(heights, kind="stable")
    assert (np.diff(placed[order]) >= gap - 1e-6).all()
    if gap * len(heights) < 100:
        assert placed.min() > -1e-6 and placed.max() < 100 + 1e-6


def test_a_film_without_its_encoder_says_what_to_install(tmp_path, monkeypatch):
    from houle.output import movie

    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    pytest.importorskip("imageio")
    with pytest.raises(OutputError, match=r'imageio_ffmpeg.*\n.*pip install "houle\[movie\]"'):
        movie.write_movie(tmp_path / "movie.mp4", made_case(), made_grid(), None)


def test_a_film_has_a_picture_for_every_frame(tmp_path):
    imageio = pytest.importorskip("imageio.v2")
    pytest.importorskip("imageio_ffmpeg")
    from houle.output import movie

    grid, case = made_grid(), made_case()
    outputs = Outputs(tmp_path, case, grid)
    write(outputs, grid, range(3), [])
    outputs.close()
    path = movie.write_movie(tmp_path / "movie.mp4", case, grid, read_fields(tmp_path), rate=5)
    with imageio.get_reader(path) as film:
        assert film.count_frames() == 3
