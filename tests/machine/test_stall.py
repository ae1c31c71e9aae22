"""All drives stalled at once on one supply: R I² at the supply by hand, of one axis and of several."""

import pytest

from drivesizer.errors import InputError
from drivesizer.multi_axis import size_machine
from drivesizer.sizing import explain
from drivesizer.spec.machine import load_machine
from drivesizer.spec.robot import load_spec

LIFT = {
    "name": "lift", "load": {"kind": "hoist", "mass": "2 kg", "drum_diameter": "50 mm", "motors": 2},
    "motion": {"speed": "60 mm/s", "acceleration_time": "0.2 s", "cruise_time": "2 s", "rest_time": "4 s"},
    "supply": {"nominal": "24 V", "current": "10 A", "stalled": True}, "power_stage": {"motor_current": "4 A"},
    "select": {"motor": {"part": "118752"}, "gearhead": {"part": "406767"}},
}  # fmt: skip


def stall(drive):
    return next(one for one in drive.budget if one.name == "supply_stall")


def by_hand(drive, current):
    """What 4 A take of a cold winding, and the controller's own losses."""
    found = current**2 * drive.motor.resistance / 24.0
    return found, found + 0.2 * current


def test_two_drives_that_stall():
    (drive,) = explain(load_spec(LIFT), "118752", "406767")
    low, high = by_hand(drive, 4.0)
    found = stall(drive)
    assert (found.status, found.limit) == ("pass", 10.0)
    assert 2 * low < found.demand < 2 * high
    (tight,) = explain(load_spec({**LIFT, "supply": {**LIFT["supply"], "current": "3 A"}}), "118752", "406767")
    assert stall(tight).status == "fail"
    with pytest.raises(InputError, match="give current with stalled"):
        load_spec({**LIFT, "supply": {"nominal": "24 V", "stalled": True}})


def test_all_axes_that_stall_are_added_up():
    shared = {name: LIFT[name] for name in ("motion", "power_stage", "select")}
    axis = {"load": {**LIFT["load"], "motors": 1}}
    machine = load_machine(
        {"name": "two", "supply": LIFT["supply"], **shared, "axes": {"a": axis, "b": axis, "c": axis}}
    )
    found = size_machine(machine)
    low, high = by_hand(found.axes[0].best, 4.0)
    (check,) = (one for one in found.checks if one.name == "supply_stall")
    assert 3 * low < check.demand < 3 * high
    assert not any(one.name == "supply_stall" for axis in found.axes for one in axis.best.budget)
