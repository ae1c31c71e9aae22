"""Pull-out curves in the catalogues: as printed, read strictly, kept, joined, and checked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from refusals import refusal

from drivesizer.catalog import Catalog, load
from drivesizer.catalog.parts import PullOuts
from drivesizer.errors import CatalogError

RPM = np.pi / 30.0
TEXT = """\
catalog: 1
manufacturer: Steps
sources:
  sheet: {document: "sheet", confidence: quoted}
steppers:
- family: S
  source: sheet
  common: {full_steps: 200}
  columns: [part, phase_current (A), holding_torque (N*m)]
  rows:
  - [S1, 2, 0.6]
  - [S2, 3, 1.2]
pull_outs:
- stepper: S2
  source: sheet
  voltage: 24 V
  columns: [speed (rpm), torque (mN*m)]
  rows: [[60, 900], [600, 500]]
"""


def of(catalog: Catalog, part: str) -> PullOuts:
    return catalog.pull_outs.on(catalog.pull_outs.stepper == catalog.steppers.rows[part])


def written(folder: Path, text: str, name: str = "steps.yaml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_chart_of_the_maker() -> None:
    """StepperOnline's chart of 17HS19-2004S1 at 24 V with a DM320T: 0.232 N*m at 1000 rpm, 0.172 at 1200."""
    own = of(load(["stepperonline"]), "17HS19-2004S1")
    assert own.voltage.tolist() == [24.0] * 12
    assert own.current[0] == 2.2
    assert own.torque[np.isclose(own.speed, 1000 * RPM) | np.isclose(own.speed, 1200 * RPM)].tolist() == [0.232, 0.172]


def test_read_and_joined_with_other_catalogues(tmp_path: Path) -> None:
    path = written(tmp_path, TEXT)
    alone = of(load([str(path)]), "S2")
    assert alone.torque == pytest.approx([0.9, 0.5])
    assert np.isnan(alone.current).all()
    for _ in range(2):  # read, then out of the compiled file
        both = load(["stepperonline", str(path)])
        own = of(both, "S2")
        assert own.speed == pytest.approx([60 * RPM, 600 * RPM])
        assert {both.sources[number].document for number in own.source} == {"sheet"}
        assert own.curve[0] not in of(both, "17HS19-2004S1").curve


def test_the_curve_of_a_replaced_part_is_the_last(tmp_path: Path) -> None:
    first = written(tmp_path, TEXT)
    other = TEXT.replace("catalog: 1", "catalog: 1\noverrides: true").replace("900", "800")
    found = of(load([str(first), str(written(tmp_path, other, "own.yaml"))]), "S2")
    assert found.torque.tolist() == pytest.approx([0.8, 0.5])


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("stepper: S2", "stepper: S9", "is not a stepper of this file"),
        ("voltage: 24 V", "voltage: 0 V", '"0 V" is not above 0'),
        ("voltage: 24 V", "voltage: 24", "unit"),
        ("[speed (rpm), torque (mN*m)]", "[speed (rpm), force (N)]", "expected [speed (rpm), torque (N*m)]"),
        ("[600, 500]", "[60, 500]", "speed 60 is not above that of the row before"),
        ("[600, 500]", "[600, -5]", "is not a speed and a torque of 0 or more"),
        ("[[60, 900], [600, 500]]", "[[60, 900]]", "found 1 points; expected at least 2"),
    ],
)
def test_bad_curves_are_refused_in_a_line(tmp_path: Path, old: str, new: str, said: str) -> None:
    path = written(tmp_path, TEXT.replace(old, new))
    line = refusal(lambda: load([str(path)]), CatalogError)
    assert said in line
    assert "steps.yaml:" in line
