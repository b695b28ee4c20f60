"""fields.vtkhdf gives back the frames, and is what the VTKHDF specification asks for."""

import dataclasses
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from made_run import SINGLE, assert_same_frame, made_case, made_frame, made_grid, made_outputs, write

from houle.output import (
    read_fields,
    vtkhdf,
)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("frames", [1, 5])
@pytest.mark.parametrize("packed", [False, True])
def test_fields_give_back_the_frames(tmp_path, dimension, frames, packed):
    grid = made_grid(dimension)
    outputs = made_outputs(tmp_path, made_case(dimension), grid)
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
    outputs = made_outputs(tmp_path, made_case(dimension), grid)
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


def test_a_run_may_have_more_frames_than_an_attribute_holds_numbers(tmp_path):
    """8192 are the most of an attribute of HDF5."""
    grid = made_grid()
    frame = vtkhdf.compress(made_frame(grid, 0))
    frames = [dataclasses.replace(frame, time=0.1 * k, step=3 * k) for k in range(8200)]
    small = {name: [] for name in frame.chunks}  # no numbers: they are not looked at
    frames = [dataclasses.replace(frame, chunks=small, count=2, rows=2) for frame in frames]
    vtkhdf._copy, copy = lambda *_: None, vtkhdf._copy
    try:
        vtkhdf.assemble(tmp_path / "fields.vtkhdf", frames, grid, {}, packed=True)
    finally:
        vtkhdf._copy = copy
    found = vtkhdf.frames_in(tmp_path / "fields.vtkhdf")
    assert [f.step for f in found] == [3 * k for k in range(8200)] and found[-1].time == 0.1 * 8199


def test_every_array_carries_its_unit(tmp_path):
    outputs = made_outputs(tmp_path, made_case(), made_grid())
    write(outputs, made_grid(), range(2), [])
    outputs.close()
    with h5py.File(tmp_path / "fields.vtkhdf") as file:
        assert file["VTKHDF/particles/PointData/volume"].attrs["units"] == "m2"
        assert "pore velocity" in file["VTKHDF/particles/PointData/velocity"].attrs["long_name"]
        assert "Darcy velocity" in file["VTKHDF/grid/CellData/velocity"].attrs["long_name"]
