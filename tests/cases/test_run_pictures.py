"""Pictures and film of a run show what they should."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_run import made_case, made_grid, made_outputs, write

from houle.output import (
    OutputError,
    read_fields,
    read_series,
    read_surface,
)


def has_colour(path, colour):
    """Number of pixels of exactly this colour."""
    from matplotlib.colors import to_rgb
    from matplotlib.image import imread

    return int((np.abs(imread(path)[..., :3] - np.array(to_rgb(colour))).max(axis=-1) < 0.004).sum())


@pytest.mark.parametrize("dimension", [2, 3])
def test_pictures_of_a_run(tmp_path, dimension):
    from houle.output import drawing, pictures

    grid, case = made_grid(dimension), made_case(dimension)
    outputs = made_outputs(tmp_path, case, grid)
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
    outputs = made_outputs(tmp_path, case, grid)
    write(outputs, grid, range(6), range(21))
    outputs.close()
    wave = {"kind": "regular", "height": 0.01, "period": 0.6, "depth": 0.15}
    made = {"waves": wave | {maker: {"x": [0.0, 0.3] if maker == "zone" else 0.3}}}
    damped = {"sponge": [{"box": [[0.7, 0.0], [0.9, 0.3]]}]}
    sides = {"open": [{"side": "right", "level": 0.15}]}
    pages = []
    for tables in ({}, damped, made, made | sides):
        case = made_case(**tables)
        page = pictures.surface_picture(tmp_path / "surface.png", case, grid, read_surface(tmp_path))
        pages.append(imread(page)[..., :3].mean(axis=-1))
    calm, sponge, made, opened = [(page < 0.75).sum() for page in pages]  # dark pixels: lines and words
    assert sponge > calm + 300 and made > calm + 300 and opened > made + 100


@pytest.mark.parametrize("limits", [(0.0, 1.0), (0.0, 0.02), (-0.02, 0.02), (0.24, 0.26), (0.0, 2500.0)])
def test_the_name_of_an_axis_stands_clear_of_its_numbers_and_in_the_picture(limits):
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    from houle.output import drawing

    with drawing.style():
        page = drawing.sheet(1, 1, (7.5, 1.4), r"$\undefined and 50 % of $", "words")
        page.panels[0].set(xlim=(0, 1), ylim=limits)
        page.label_outside("x [m]", "z [m]")
        drawn = FigureCanvasAgg(page.figure).get_renderer()
        (name,) = [t for t in page.panels[0].texts if t.get_text() == "z [m]"]
        numbers = [t for t in page.panels[0].texts if t.get_ha() == "right"]
        assert len(numbers) > 2
        name = name.get_window_extent(drawn)
        assert name.x1 < min(t.get_window_extent(drawn).x0 for t in numbers)
        assert name.x0 > 0


def test_suction_is_seen_and_round_off_is_not():
    from houle.output.pressure import pressure_scale

    def frame(low):
        return SimpleNamespace(pressure=np.linspace(low, 1000.0, 200))

    assert pressure_scale([frame(-1e-3), frame(-20.0)]).vmin == 0.0
    scale = pressure_scale([frame(0.0), frame(-800.0)])
    assert -0.8 < scale.vmin < -0.75 and 0.99 < scale.vmax < 1.0


def test_laboratory_points_are_drawn_and_scored(tmp_path):
    from houle.data import laboratory
    from houle.output import drawing, pictures

    reference = {"surface": "lab.csv", "error": 0.004, "label": "someone (1999)"}
    grid, case = made_grid(), made_case(reference=reference)
    outputs = made_outputs(tmp_path, case, grid)
    write(outputs, grid, range(3), range(3))
    outputs.close()
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
    from houle.output.labels import apart

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
        movie.write_movie(tmp_path / "movie.mp4", made_case(), None)


def test_a_film_has_a_picture_for_every_frame(tmp_path):
    imageio = pytest.importorskip("imageio.v2")
    pytest.importorskip("imageio_ffmpeg")
    from houle.output import movie

    grid, case = made_grid(), made_case()
    outputs = made_outputs(tmp_path, case, grid)
    write(outputs, grid, range(3), [])
    outputs.close()
    path = movie.write_movie(tmp_path / "movie.mp4", case, read_fields(tmp_path), rate=5)
    with imageio.get_reader(path) as film:
        assert film.count_frames() == 3
