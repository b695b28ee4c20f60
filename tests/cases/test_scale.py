"""A laboratory beside its prototype, `houle check --scale`: similar flow in pores, and the grain that gives it."""

from math import sqrt

import pytest
from typer.testing import CliRunner

from houle import design
from houle.case.model import load
from houle.check.scale import layers
from houle.cli import app
from houle.errors import CaseError

SCALE = 25.0


def only(case, scale=SCALE):
    (layer,) = layers(case, scale)
    return layer


def test_a_drop_of_level_gives_the_grain_of_the_formula():
    """Without waves there is one gradient, as in `houle.design.core_scale`."""
    case = load("dam-break-beads", {"porous.beads.resistance": {"law": "van-gent-1995"}})
    body, layer = case.porous[0], only(case)
    assert case.drag_period == float("inf")
    formula = design.core_scale(
        scale=SCALE, gradient=layer.gradient, porosity=body.porosity, law=body.resistance.law,
        grain_diameter=SCALE * body.grain_diameter,
    )  # fmt: skip
    assert layer.grain == pytest.approx(formula.grain_diameter, rel=1e-9)
    assert layer.prototype.velocity == pytest.approx(formula.velocity, rel=1e-9)
    assert layer.prototype.reynolds == pytest.approx(formula.reynolds, rel=1e-9)


def test_a_ship_has_no_wavelength_whose_pressure_decays_in_a_bank():
    """The length of its waves is that of their record, a kilometre: the gradient is assumed, as without waves."""
    layer = only(load("bank-ship-wave"))
    assert layer.cause.startswith("assumed") and layer.gradient == pytest.approx(0.1)


def test_water_moves_by_froude_with_the_grain_that_is_advised():
    """Taken in place of the case's own, the grains give the prototype's velocities over sqrt(S) and its KC numbers."""
    before = layers(load("breakwater"), SCALE)
    grains = {f"porous.{layer.name}.grain_diameter": layer.grain for layer in before}
    for old, new in zip(before, layers(load("breakwater", grains), SCALE), strict=True):
        assert old.grain > old.own and new.own == old.grain
        assert new.laboratory.velocity == pytest.approx(old.prototype.velocity / sqrt(SCALE), rel=1e-9)
        assert old.laboratory.velocity < new.laboratory.velocity


def test_turbulent_flow_needs_no_other_grain():
    """Without the laminar part of the drag velocities follow Froude's law with grains scaled by length."""
    case = load("breakwater", {f"porous.{name}.resistance.alpha": 0.0 for name in ("armour", "filter", "core")})
    for layer in layers(case, SCALE):
        assert layer.grain == pytest.approx(layer.own, rel=1e-9)
        assert layer.laboratory.velocity * sqrt(SCALE) == pytest.approx(layer.prototype.velocity, rel=1e-9)
        ours, theirs = layer.laboratory.keulegan_carpenter, layer.prototype.keulegan_carpenter
        assert ours == pytest.approx(theirs, rel=1e-9)
        assert layer.prototype.reynolds == pytest.approx(SCALE**1.5 * layer.laboratory.reynolds, rel=1e-9)


def test_coefficients_say_nothing_of_a_prototype():
    layer = only(load("porous-dyke"))
    assert layer.prototype is None and layer.grain is None
    assert layer.laboratory.velocity == pytest.approx(0.05, rel=1e-3)  # K = 0.1 m/s under the gradient 0.5


@pytest.mark.parametrize("scale", ["0.5", "1", "1001", "nan"])
def test_a_scale_that_is_none_is_refused(tmp_path, scale):
    picture = tmp_path / "section.png"
    with pytest.raises(CaseError, match="above 1 and at most 1000"):
        layers(load("porous-dyke"), float(scale))
    shown = CliRunner().invoke(app, ["check", "porous-dyke", "--scale", scale, "--picture", str(picture)])
    assert shown.exit_code == 2 and "40 for a model of 1:40" in shown.output and not picture.exists()


def test_the_table_names_grains_and_factors(tmp_path):
    words = CliRunner().invoke(app, ["check", "breakwater", "--scale", "40", "--picture", str(tmp_path / "s.png")])
    assert words.exit_code == 0
    shown = " ".join(words.output.split())
    assert "forces per metre x 1600" in shown and "discharges per metre x 253" in shown
    for layer in layers(load("breakwater"), 40.0):
        assert f"take {1000 * layer.grain:.3g} mm" in shown
