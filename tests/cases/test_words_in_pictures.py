"""The words of every picture: those of users literally, our mathematics set, all of them inside the figure."""

import itertools

import numpy as np
import pytest
from made_run import made_case, made_grid, made_outputs, write
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from analysis import flumes
from houle import analysis, load
from houle.output import drawing, read_fields, read_series, read_surface

AWKWARD = r"$\undefined_{x}$ 50 % of $H_s$ & W_1^2"
LONG = "Überströmter Wellenbrecher MIT WAAGERECHTER KRONE UND WEITEM VORLAND, Versuchsreihe WM_$12$, " * 3
TITLES = ["a title", AWKWARD, LONG, "W" * 40, "two\nlines"]


@pytest.fixture
def figures(monkeypatch):
    """Every figure that is saved while a test runs."""
    saved, to_file = [], FigureCanvasAgg.print_figure

    def keep(self, *args, **options):
        saved.append(self.figure)
        return to_file(self, *args, **options)

    monkeypatch.setattr(FigureCanvasAgg, "print_figure", keep)
    return saved


def words_of(figure: Figure) -> list[Text]:
    """What is written, but for the numbers of matplotlib's own ticks, some of which it does not draw."""
    ticks = {label for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) for label in axis.get_ticklabels()}
    return [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip() and t not in ticks]


def check(figure: Figure, least: int = 3) -> None:
    """All words lie inside the figure, and none on others."""
    drawn = FigureCanvasAgg(figure).get_renderer()
    figure.draw(drawn)
    page, words = figure.bbox, words_of(figure)
    boxes = [(t, t.get_window_extent(drawn)) for t in words]
    assert len(words) >= least
    for text, box in boxes:
        inside = box.x0 >= page.x0 - 1 and box.x1 <= page.x1 + 1 and box.y0 >= page.y0 - 1 and box.y1 <= page.y1 + 1
        assert inside, f"{text.get_text()!r} is cut off: {box} of {page}"
    for (a, one), (b, other) in itertools.combinations(boxes, 2):
        across = min(one.x1, other.x1) - max(one.x0, other.x0)
        along = min(one.y1, other.y1) - max(one.y0, other.y0)
        assert across < 1.5 or along < 1.5, f"{a.get_text()!r} stands on {b.get_text()!r}"


def raw(figure: Figure) -> list[str]:
    """Words with mathematics in them that is not set."""
    return [t.get_text() for t in words_of(figure) if "$" in t.get_text() and not t.get_parse_math()]


def measured(kind: str, names=None):
    x, time = np.array([0.0, 0.31, 0.55, 0.9, 7.0]), np.arange(0.0, 60.0, 0.05)
    rng = np.random.default_rng(3)
    if kind == "regular":
        front = flumes.regular(x[:4], time, 1.37, [(1, "bound", 0.02, 0.005), (2, "bound", 0.003, 0.001j)])
        behind = flumes.regular(x[4:], time, 1.37, [(1, "bound", 0.012, 0)])
    else:
        front = flumes.irregular(x[:4], time, 1.37, 0.4, rng)
        behind = flumes.irregular(x[4:], time, 1.37, 0.0, rng, transmit=0.6)
    levels = np.vstack([front, behind]) + 1e-3 * rng.standard_normal((5, len(time)))
    source = analysis.gauges(time, x, levels, names)
    return analysis.reflection(source, depth=0.25, period=1.37, kind=kind, behind=[4], window=(1, 59))


@pytest.mark.parametrize("kind", ["regular", "irregular"])
def test_the_picture_of_a_reflection(tmp_path, figures, kind):
    """The headline is set, three coefficients with their intervals, none of them cut off."""
    found = measured(kind)
    found.plot(tmp_path / "r.png")
    check(figures[-1], 10)
    assert raw(figures[-1]) == []
    title = figures[-1].texts[0].get_text()
    assert all(f"$C_{letter}$ = " in title for letter in "RTD") and title.count(" to ") == 3
    names = [AWKWARD, "W_1", "$x$", "a gauge with a long name in the middle of the flume", "T"]
    measured(kind, names).plot(tmp_path / "r.png")
    check(figures[-1], 10)
    literal = raw(figures[-1])
    assert len(literal) == 2 and literal[0][:6] == AWKWARD[:6] and literal[1].startswith("$x$")


@pytest.mark.parametrize("title", TITLES)
@pytest.mark.parametrize("dimension", [2, 3])
def test_the_pictures_of_a_run(tmp_path, figures, dimension, title):
    from houle.output import pictures

    grid, case = made_grid(dimension), made_case(dimension, case={"name": "slosh", "title": title})
    outputs = made_outputs(tmp_path, case, grid)
    write(outputs, grid, range(6), range(21))
    outputs.close()
    files = read_series(tmp_path), read_surface(tmp_path), read_fields(tmp_path)
    made = pictures.write_pictures(tmp_path, case, grid, *files)
    assert len(figures) == len(made) >= 4
    for figure in figures:
        check(figure)
        drawn = figure.texts[0].get_text()
        plain = " ".join(title.split())
        assert drawn == plain or (drawn.endswith("…") and plain.startswith(drawn[:-1]) and len(drawn) > 60)


@pytest.mark.parametrize("title", TITLES)
@pytest.mark.parametrize(
    "name", ["breakwater", "wave-block", "dam-break-rock-35", "spheric-2", "beach", "porous-column"]
)
def test_the_picture_of_a_check(tmp_path, figures, name, title):
    from houle.output.section import draw

    case = load(name, {"case.title": title})
    names = [g.model_copy(update={"name": f"{AWKWARD} {g.name}"[-25:]}) for g in case.gauge]
    case = case.model_copy(update={"gauge": names})
    draw(case, tmp_path / "section.png")
    check(figures[-1])


def test_our_own_mathematics_in_other_pictures(tmp_path, figures):
    with drawing.style():
        page = drawing.sheet(2, 2, (3.0, 1.5), AWKWARD, "words")
        mesh = page.panels[0].imshow(np.eye(3))
        drawing.colour_bar(page, mesh, "$u_x$ [m/s]", mathematics=True)
        drawing.headings(page.panels[1], "$C_R$, wall behind, n = 0.4", mathematics=True)
        drawing.headings(page.panels[0], "Level at " + LONG, "rms 3.4 mm")
        page.save(tmp_path / "p.png")
    check(figures[-1])
    assert [t for t in raw(figures[-1]) if not t.startswith("Level at")] == [AWKWARD]
