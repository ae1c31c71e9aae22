"""From Python: machines, load cycles out of arrays, catalogues out of tables, results as rows."""

from __future__ import annotations

import numpy as np
import pytest

import drivesizer
from drivesizer import LoadCycle, catalog, design, load_spec, size, size_variants
from drivesizer.errors import InputError

SPEC = {
    "name": "table",
    "load": {"kind": "rotary_table", "inertia": "0.02 kg*m^2", "friction_torque": "0.1 N*m"},
    "motion": {"speed": "2 rad/s", "acceleration_time": "1 s", "cruise_time": "1 s"},
    "supply": {"nominal": "24 V", "accepts": "all"},
    "select": {"motor": {"family": "RE 25"}, "gearhead": {"family": "GP 26 A"}},
}
TABLE = {
    "part": ["A1", "A2"], "kind": ["brushed"] * 2, "nominal_voltage (V)": [24.0] * 2, "mass (g)": [300.0, np.nan],
    "no_load_current (mA)": [100.0] * 2, "torque_constant (mN*m/A)": [52.0] * 2, "resistance (ohm)": [0.5] * 2,
    "rotor_inertia (g*cm^2)": [100.0] * 2, "nominal_current (A)": [9.0] * 2, "no_load_speed (rpm)": [4300.0] * 2,
}  # fmt: skip


def test_samples_of_a_motion_size_as_the_motion():
    """A trapezoid by its corners, twice at each jump of the torque but for a nanosecond."""
    spec = load_spec(SPEC)
    jump = 1e-9
    time = [0, 1 - jump, 1, 2, 2 + jump, 3]
    torque = [0.14, 0.14, 0.1, 0.1, 0.06, 0.06]
    found = size(spec, load=LoadCycle.from_arrays(time, [0, 2, 2, 2, 2, 0], torque, inertia=0.02), detail="drives")
    own = size(spec, detail="drives")
    assert [one.label for one in found.sets] == [one.label for one in own.sets]
    for name in ("energy", "joule_heat"):
        one, other = ({f.name: f.value for f in result.sets[0].figures}[name] for result in (found, own))
        assert one == pytest.approx(other, rel=1e-6)


@pytest.mark.parametrize("arrays", [([0, 1], [0, 1], [1]), ([0, 0], [0, 1], [1, 1]), ([0], [0], [0])])
def test_arrays_that_do_not_go_together_are_refused(arrays):
    with pytest.raises(InputError, match="load cycle arrays"):
        LoadCycle.from_arrays(*arrays)


def test_a_table_is_a_catalogue_and_catalogues_add_up():
    own = catalog.of(TABLE, name="own")
    assert own.motors["mass"][0] == pytest.approx(0.3)
    assert np.isnan(own.motors["mass"][1])
    both = own + catalog.load(["maxon"])
    assert {"A1", "118752"} <= set(both.motors["part"].tolist())
    direct = load_spec({**SPEC, "select": {"motor": {"part": "A1"}}, "transmission": [{"kind": "direct"}]})
    assert size(direct, catalog=both, detail="drives").counts.considered == 1


def test_a_result_is_printed_short_and_has_its_drives_as_rows():
    found = size(load_spec(SPEC), top=3)
    assert len(str(found).splitlines()) == 1 + len(found.sets)
    assert str(found.sets[0]).split() == str(found).splitlines()[1].split()  # but for the widths of columns
    rows = found.rows()
    assert [row["rank"] for row in rows[:3]] == [1, 2, 3]
    check = next(one for one in found.sets[0].checks if one.margin == one.margin)
    assert rows[0][f"margin {check.name}"] == check.margin


def test_a_spec_may_be_its_fields_and_a_catalogue_is_printed_short():
    assert str(size(SPEC, detail="drives")) == str(size(load_spec(SPEC), detail="drives"))
    assert repr(catalog.of(TABLE, name="own")) == "Catalog(own: 2 motors, 1 gearheads)"


def test_machines_of_a_front_are_rows():
    """The heavier the table, the dearer its drive or the same: both ends of a front of one figure against the other."""
    free = {"load.inertia": ["0.02 kg*m^2", "0.05 kg*m^2"]}
    found = design(SPEC, free=free, minimise="mass", pareto=["mass", "-load.inertia"])
    assert [row["machine_mass_kg"] for row in found.rows()] == [choice.goals[0] for _, choice in found.front]
    alone = design(SPEC, free=free, minimise="mass")
    assert [row["load.inertia (kg*m^2)"] for row in alone.rows()] == [float(alone.values["load.inertia"].split()[0])]


def test_a_price_in_another_currency_is_not_one_in_euros():
    """345 USD are no 345 EUR: unknown without a rate, and by a rate what it makes of them."""
    spec = {
        "name": "elbow", "supply": {"nominal": "24 V", "accepts": "all"}, "transmission": [{"kind": "gearhead"}],
        "load": {"kind": "arm", "mass": "1 kg", "length": "200 mm"}, "select": {"catalogs": ["myactuator"]},
        "motion": {"speed": "90 deg/s", "acceleration_time": "0.4 s", "cruise_time": "1 s", "there_and_back": True},
    }  # fmt: skip
    rated = {**spec, "select": {**spec["select"], "rates": {"USD": "0.9 EUR"}}}
    rows = [size_variants(one, {"load.mass": ["1 kg", "1.5 kg"]}).rows()[0] for one in (spec, rated)]
    drive = size(spec, detail="drives").sets[0]
    assert drive.currency == "USD"
    assert [row["machine_price_EUR"] for row in rows] == [None, pytest.approx(0.9 * drive.price)]


def test_a_function_of_a_drive_is_made_least():
    def merit(drive):
        return drive.mass + 0.01 * drive.total_ratio

    found = design(
        SPEC, free={"motion.speed": ["2 rad/s", "20 rad/s"], "load.inertia": ["0.02 kg*m^2"]}, minimise=merit
    )
    every = [
        size(load_spec({**SPEC, "motion": {**SPEC["motion"], "speed": speed}}), top=1000, detail="drives").sets
        for speed in ("2 rad/s", "20 rad/s")
    ]
    assert found.choice.goals[0] <= min(merit(one) for sets in every for one in sets[:10]) + 1e-9


def test_every_public_name_stays_what_it_is():
    """A room of the same name would take the place of a function."""
    for name in drivesizer.__all__:
        assert getattr(drivesizer, name) is getattr(drivesizer, name)
