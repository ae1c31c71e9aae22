"""The report of a machine of several axes: one parts list, a row and a chapter for each axis."""

from __future__ import annotations

from math import isnan

import pytest
from forty_motors import catalogue

from drivesizer.multi_axis.sizing import size_machine
from drivesizer.output.parts import machine_parts, machine_parts_of_axes, parts_by_axis, totals
from drivesizer.results.machine import MachineSizing
from drivesizer.spec.several_axes.machine_file import load_machine

LONG = "carriage of the second portal behind the guard door"  # an axis may have 60 letters
_PRICES = "price: 80 EUR, price_5: 70 EUR"


def _axis(mass: str, **more: object) -> dict:
    load = {"kind": "belt_axis", "mass": mass, "pulley_diameter": "40 mm", "friction_coefficient": 0.01}
    motion = {"profile": "trapezoid", "speed": "1 m/s", "acceleration_time": "0.3 s", "cruise_time": "0.5 s",
              "rest_time": "0.5 s"}  # fmt: skip
    return {"load": load | more, "motion": motion}


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> MachineSizing:
    """Two axes of the same drives, one that carries the other, and a third that no motor moves."""
    shelf = tmp_path_factory.mktemp("shelf") / "shelf.yaml"
    text = catalogue(lambda n: 0.6 - 0.01 * n, "0.1 K/W", "mass: 100 g")
    shelf.write_text(text.replace("max_speed:", f"{_PRICES}, max_speed:"), encoding="utf-8")
    axes = {"x": _axis("9 kg", motors=2) | {"carries": [LONG]}, LONG: _axis("6 kg", motors=3), "z": _axis("9000 kg")}
    spec = {"name": "portal", "supply": {"nominal": "24 V", "current": "60 A"}, "axes": axes,
            "select": {"catalogs": [str(shelf)], "estimates": "off"}}  # fmt: skip
    return size_machine(load_machine(spec))


# -- the parts list


def test_equal_parts_of_axes_are_one_line_whose_quantities_add_up(machine):
    lines = machine_parts_of_axes(machine)
    assert [(x.line.role, x.line.part, x.line.quantity, x.axes) for x in lines] == [
        ("motor", "m00", 5, ("x", LONG)), ("encoder", "", 5, ("x", LONG)), ("controller", "only", 5, ("x", LONG)),
    ]  # fmt: skip
    alone = [line for axis in machine.axes[:2] for line in machine_parts(axis.best, axis.result.problem)]
    assert sum(line.quantity for line in alone) == sum(x.line.quantity for x in lines) == 15
    assert not parts_by_axis(machine)["z"]


def test_a_price_is_that_of_all_pieces_of_the_machine(machine):
    """Of two or three pieces it is 80 EUR, of five 70."""
    alone = [machine_parts(axis.best, axis.result.problem)[0].price for axis in machine.axes[:2]]
    together = machine_parts_of_axes(machine)[0].line
    assert alone == [80.0, 80.0] and (together.price, together.pieces) == (70.0, 5)
    mass, price = totals([x.line for x in machine_parts_of_axes(machine)])
    assert (price.value, price.over, price.lacks) == (350.0, ("motor",), ("encoder", "controller"))
    by_axis = [totals(lines) for lines in parts_by_axis(machine).values() if lines]
    assert [found[1].value for found in by_axis] == [140.0, 210.0]
    assert sum(found[0].value for found in by_axis) == pytest.approx(mass.value) == pytest.approx(5 * (0.3 + 0.1))
    assert isnan(together.mass_low)
