"""Speed profiles: the spec's trapezoid and recorded files, which are read strictly."""

from __future__ import annotations

import pytest

from drivesizer import profile as module
from drivesizer.errors import InputError
from drivesizer.profile import from_csv, profile, trapezoid
from drivesizer.spec import Trapezoid


def motion(**figures):
    return Trapezoid(**({"speed": "1.5 m/s", "acceleration_time": "2 s", "cruise_time": "3 s"} | figures))


def test_trapezoid_covers_speed_times_acceleration_and_cruise():
    found = trapezoid(motion(rest_time="4 s"))
    assert found.time == (0.0, 2.0, 5.0, 7.0, 11.0)
    assert found.speed == (0.0, 1.5, 1.5, 0.0, 0.0)
    assert found.distance == pytest.approx(1.5 * (2.0 + 3.0))
    assert found.top_speed == 1.5


def test_legs_without_length_leave_no_breakpoint():
    assert trapezoid(motion(cruise_time="0 s")).time == (0.0, 2.0, 4.0)


def test_acceleration_lost_beside_the_cruise_is_refused():
    with pytest.raises(InputError, match="acceleration_time"):
        trapezoid(motion(acceleration_time="1 us", cruise_time="1e12 d"))


def write(tmp_path, text):
    path = tmp_path / "run.csv"
    path.write_bytes(text.encode("utf-8") if isinstance(text, str) else text)
    return path


def test_units_of_the_file_are_converted(tmp_path):
    found = from_csv(write(tmp_path, "\ufefftime,speed\r\nms,km/h\r\n0,0\r\n1500,-3.6\r\n2.5e3,7.2\r\n\r\n"))
    assert found.time == pytest.approx((0.0, 1.5, 2.5))
    assert found.speed == pytest.approx((0.0, -1.0, 2.0))
    assert found.distance == pytest.approx(1.5 * -0.5 + 1.0 * 0.5)


HEAD = "time,speed\ns,m/s\n"

WRONG = {
    "empty": ("", ":1: header: nothing; expected time,speed"),
    "header": ("t,v\ns,m/s\n0,0\n1,1\n", ':1: header: "t,v"; expected time,speed'),
    "no units": ("time,speed\n", ":2: units: "),
    "numbers for units": ("time,speed\n0,0\n1,1\n", ":2: time: "),
    "unit of another kind": ("time,speed\ns,rpm\n0,0\n1,1\n", ':2: speed: "rpm" is a unit of rotary speed'),
    "one row": (HEAD + "0,0\n", ": rows: 1 found; expected at least 2"),
    "order": (HEAD + "0,0\n2,1\n1,1\n", ':5: time: "1" is not after the row before'),
    "twice": (HEAD + "0,0\n0,1\n", ':4: time: "0" is not after the row before'),
    "nan": (HEAD + "0,0\n1,nan\n", ':4: speed: "nan" is not a finite number'),
    "inf": (HEAD + "0,0\ninf,1\n", ':4: time: "inf" is not a finite number'),
    "overflow": (HEAD + "0,0\n1,1e999\n", ':4: speed: "1e999" is not a finite number'),
    "underscore": (HEAD + "0,0\n1_0,1\n", ':4: time: "1_0" is not a finite number'),
    "missing cell": (HEAD + "0,0\n1\n", ':4: row: "1" has 1 of 2 columns'),
    "empty cell": (HEAD + "0,0\n1,\n", ':4: speed: "" is not a finite number'),
    "decimal comma": (HEAD + "0,0\n0,5,1,2\n", ':4: row: "0,5,1,2" has 4 columns; a decimal comma'),
    "semicolon": (HEAD + "0;0\n1;1\n", "a semicolon does not separate"),
    "gap": (HEAD + "0,0\n\n1,1\n", ":4: row: a blank line"),
    "quote": (HEAD + '0,0\n1,"1\n', "row: "),
    "text": (HEAD + "0,0\n1,fast\n", ':4: speed: "fast" is not a finite number'),
    "latin-1": (HEAD.encode() + b"0,0\n1,\xe9\n", ":4: the file is not UTF-8"),
}


@pytest.mark.parametrize(("text", "message"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_told_in_a_line(tmp_path, text, message):
    with pytest.raises(InputError) as caught:
        from_csv(write(tmp_path, text))
    assert message in str(caught.value)
    assert str(caught.value).startswith(str(tmp_path / "run.csv"))
    assert "\n" not in str(caught.value)


def test_too_many_rows(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "_MOST_ROWS", 3)
    with pytest.raises(InputError, match=":6: row: more than 3 rows"):
        from_csv(write(tmp_path, HEAD + "0,0\n1,1\n2,1\n3,1\n"))


@pytest.mark.parametrize("name", ["gone.csv", ".", "a\0b.csv"])
def test_unreadable_file(tmp_path, name):
    with pytest.raises(InputError, match="cannot be read"):
        from_csv(tmp_path / name)


def test_name_or_file(spec, tmp_path):
    assert profile(spec, "trapezoid") == trapezoid(spec.motion)
    assert profile(spec, str(write(tmp_path, HEAD + "0,0\n1,1\n"))).speed == (0.0, 1.0)
    with pytest.raises(InputError, match='"s-curve" is not known; expected trapezoid or a file'):
        profile(spec, "s-curve")
