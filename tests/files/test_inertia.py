"""Inertia of bodies: printed examples of makers, the theorem of parallel axes, and the lines for what is wrong."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refusal

from drivesizer.files.fields import DENSITIES, Solid, moment
from drivesizer.load_cases import load_cycle
from drivesizer.search.uncertainty.uncertain_figures import applied
from drivesizer.spec.robot import load_spec


def spec_of(inertia):
    return load_spec({
        "name": "axis",
        "load": {"kind": "ball_screw", "mass": "250 kg", "lead": "10 mm", "efficiency": 0.9, "inertia": inertia},
        "motion": {"profile": "triangle", "distance": "300 mm", "time": "0.5 s"},
        "supply": {"nominal": "48 V"},
    })  # fmt: skip


def cylinder(diameter, length, density, **more):
    return {"diameter": diameter, "length": length, "density": density, **more}


@pytest.mark.parametrize(
    ("given", "printed", "half_digit"),
    [
        pytest.param(
            [cylinder("40 mm", "1000 mm", "7.80 g/cm^3"), "8.1 kg*cm^2"], 27.7e-4, 0.05e-4,
            id="Mitsubishi Electric, MELDAS MDS-B-SVJ2 series, 11-5: screw and secondary gear",
        ),
        pytest.param(
            cylinder("32 mm", "1 m", "7800 kg/m^3"), 0.0008, 0.00005, id="Fanuc, B-65142E/04, selecting a motor"
        ),
        pytest.param(
            cylinder("0.02 m", "1.0 m", "7870 kg/m^3"), 4 * 0.31e-4, 4 * 0.005e-4,
            id="Yaskawa, servomotor selection: screw behind a gear of 2",
        ),
        pytest.param(
            {"mass": "50 kg", "diameter": "500 mm"}, 15625e-4, 0.5e-4, id="machinemfg.com, servo motor sizing, disc"
        ),
        pytest.param(
            {"shape": "block", "length": "12 cm", "width": "2 cm", "thickness": "2 cm", "density": "7.8 g/cm^3",
             "offset": "5 cm"}, 0.014 * 9.80665 / 100, 0.0005 * 9.80665 / 100,
            id="Yamaha, YK120X user's manual, 7-3: stay off the R-axis, kgf·cm·s²",
        ),
    ],
)  # fmt: skip
def test_as_printed(given, printed, half_digit):
    assert spec_of(given).load.inertia == pytest.approx(printed, abs=half_digit)


LENGTH = st.floats(1e-3, 2.0)


@given(LENGTH, st.floats(0.05, 0.95), LENGTH, st.sampled_from(sorted(DENSITIES)))
def test_a_hollow_cylinder_is_the_whole_less_its_core(diameter, share, length, material):
    def of(outer, inner=0.0):
        return Solid(diameter=f"{outer!r} m", inner_diameter=f"{inner!r} m", length=f"{length!r} m", material=material)

    core = share * diameter
    assert of(diameter, core).moment == pytest.approx(of(diameter).moment - of(core).moment, rel=1e-9)
    assert of(diameter).moment == pytest.approx(math.pi * DENSITIES[material] * length * diameter**4 / 32)


@given(LENGTH, LENGTH, LENGTH)
def test_a_block_is_its_quarters_beside_the_axis(a, b, thickness):
    """The theorem of parallel axes against the formula of the whole."""
    across = {"shape": "block", "thickness": f"{thickness!r} m", "material": "aluminium"}
    whole = Solid(length=f"{a!r} m", width=f"{b!r} m", **across)
    quarter = Solid(
        length=f"{a / 2!r} m", width=f"{b / 2!r} m", offset=f"{math.hypot(a, b) / 4!r} m", count=4, **across
    )
    assert quarter.moment == pytest.approx(whole.moment, rel=1e-12)


def test_a_body_is_the_figure_that_it_has():
    """The same load cycle to the last bit, whether figure or body; bodies and figures add up."""
    body = cylinder("40 mm", "1 m", "7800 kg/m^3")
    figure = float(spec_of(body).load.inertia)
    one, other = (load_cycle(spec_of(given)) for given in (body, f"{figure!r} kg*m^2"))
    assert (one.torque == other.torque).all()
    point = {"shape": "point", "mass": "2 kg", "offset": "0.3 m", "count": 3}
    assert spec_of([body, point, "1 kg*cm^2"]).load.inertia == pytest.approx(figure + 6 * 0.09 + 1e-4)


def test_a_tolerance_of_a_dimension_moves_the_inertia():
    spec = spec_of([cylinder("40 mm +- 1 mm", "1 m", "7800 kg/m^3"), "8.1 kg*cm^2"])
    (one,) = spec.toleranced
    assert one.path == ("load", "inertia", 0, "diameter")
    thicker = applied(spec, {one.path: 0.001}).load.inertia
    assert thicker == pytest.approx(moment(spec_of(cylinder("41 mm", "1 m", "7800 kg/m^3")).load.inertia) + 8.1e-4)


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"diameter": "40 mm", "length": "1 m"}, "load.inertia: give material or density or mass, exactly one of them"),
        ({"diamter": "40 mm", "mass": "1 kg"}, 'load.inertia.diamter: unknown key; did you mean "diameter"?'),
        ({"mass": "1 kg"}, "load.inertia: give diameter of the cylinder, e.g. diameter: 40 mm"),
        ({"diameter": "4 mm", "inner_diameter": "5 mm", "mass": "1 kg"}, "inner_diameter must be below diameter"),
        ({"diameter": "4 mm", "material": "steel"}, "load.inertia: give length of the cylinder"),
        ({"diameter": "4 mm", "length": "1 m", "material": "gold"}, "load.inertia.material: .*expected 'steel'"),
        ({"shape": "block", "diameter": "3 mm", "mass": "1 kg"}, "expected shape: block without diameter"),
        ({"shape": "point", "mass": "1 kg", "offset": "3 mm", "inner_diameter": "1 mm"}, "without inner_diameter"),
        ([[]], r'load.inertia\[1\]: .* is not a quantity; expected inertia'),
        ([], "load.inertia: .*too short; expected at least 1"),
    ],
)  # fmt: skip
def test_refused_in_one_line(given, line):
    refusal(lambda: spec_of(given), match=line)
