"""Faces that two media share side by side: which they are, what share each medium has, which face stands beside."""

import numpy as np
import pytest

from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.sections import PorousBody
from houle.medium.shapes import Box

PLANE = Grid((12, 9), (0.1, 0.1), (False, False))
ROUND = Grid((12, 9), (0.1, 0.1), (True, False))
SPACE = Grid((9, 6, 8), (0.1, 0.1, 0.1), (False, True, False))
ROCK = {"porosity": 0.45, "a": 300.0, "b": 20.0, "inertia": 1.4}


def shared(grid, *boxes):
    bodies = [PorousBody(str(k), Box(*box), **{**ROCK, "a": 300.0 + k}) for k, box in enumerate(boxes)]
    found = []
    for axis, faces in enumerate(Medium.build(grid, bodies).shared):
        where = np.stack(np.unravel_index(faces.face, grid.face_shape(axis)), axis=1)
        beside = np.stack(np.unravel_index(faces.beside, grid.face_shape(axis)), axis=1)
        found.append((where, beside, faces.share))
    return found


@pytest.mark.parametrize(("place", "beside", "share"), [(0.43, 3, 0.3), (0.45, 5, 0.5), (0.48, 5, 0.2)])
def test_an_upright_front_off_the_lines(place, beside, share):
    """Only faces along it are shared, in the column that it cuts; beside each is the medium its centre is not in."""
    across, along = shared(PLANE, ((place, -1.0), (2.0, 2.0)))
    assert len(across[0]) == 0
    assert along[0].tolist() == [[4, k] for k in range(1, 9)]
    assert along[1].tolist() == [[beside, k] for k in range(1, 9)]
    assert along[2] == pytest.approx(share, rel=1e-5)


def test_a_front_on_the_lines_shares_no_face():
    assert all(len(faces[0]) == 0 for faces in shared(PLANE, ((0.4, -1.0), (2.0, 2.0))))


def test_ends_corners_and_thin_bodies():
    """Top and end of a bed off the lines share faces, its corner none; nor does a body that lies within one cell."""
    along, across = shared(PLANE, ((0.0, 0.0), (0.57, 0.33)))
    assert along[0].tolist() == [[i, 3] for i in range(1, 6)]
    assert along[2] == pytest.approx(0.3, rel=1e-5)
    assert across[0].tolist() == [[5, k] for k in range(1, 3)]
    assert across[2] == pytest.approx(0.3, rel=1e-5)
    assert all(len(faces[0]) == 0 for faces in shared(PLANE, ((0.42, -1.0), (0.47, 2.0))))


def test_around_a_periodic_axis_and_between_two_bodies():
    """Two bodies that meet at 0.57, and clear water from 1.15 to the end, 1.2, where the first begins again."""
    _, along = shared(ROUND, ((0.0, -1.0), (0.57, 2.0)), ((0.57, -1.0), (1.13, 2.0)))
    column = along[0][:, 0]
    assert np.unique(column).tolist() == [5, 11]
    assert np.unique(along[1][column == 5, 0]).tolist() == [6]
    assert along[2][column == 5] == pytest.approx(0.3, rel=1e-5)
    assert np.unique(along[1][column == 11, 0]).tolist() == [10]
    assert along[2][column == 11] == pytest.approx(0.3, rel=1e-5)


def test_in_space_both_components_along_are_shared():
    x, y, z = shared(SPACE, ((0.44, -1.0, -1.0), (2.0, 2.0, 2.0)))
    assert len(x[0]) == 0
    for where, _, share in (y, z):
        assert np.unique(where[:, 0]).tolist() == [4]
        assert share == pytest.approx(0.4, rel=1e-5)


@pytest.mark.parametrize(
    ("grid", "box"),
    [
        (ROUND, ((0.0, -1.0), (0.57, 0.43))),
        (ROUND, ((0.33, 0.0), (1.04, 0.43))),
        (SPACE, ((0.44, -1.0, -1.0), (0.71, 2.0, 2.0))),
        (SPACE, ((0.2, 0.0, 0.0), (0.71, 0.37, 0.43))),
        (SPACE, ((0.2, 0.13, 0.0), (0.71, 0.41, 0.43))),
    ],
)
def test_the_last_face_around_a_periodic_axis_is_the_first(grid, box):
    """In medium and share: else what flows out at one end is not what flows in at the other, and nothing converges."""
    medium = Medium.build(grid, [PorousBody("body", Box(*box), **ROCK)])
    for axis, (number, faces) in enumerate(zip(medium.material, medium.shared, strict=True)):
        if not grid.periodic[axis]:
            continue
        ends = np.moveaxis(medium.materials[number], axis, 0)
        assert np.array_equal(ends[0], ends[-1])
        joint = np.zeros(grid.face_shape(axis))
        joint.ravel()[faces.face] = faces.share
        joint = np.moveaxis(joint, axis, 0)
        assert np.array_equal(joint[0], joint[-1])
