"""Maps of studies: what is on them, in what place, and what they say of what is not known."""

import numpy as np
import pytest
from lxml import etree
from studies import CHEAP, laid

from drivesizer.sizing import size
from drivesizer.study.maps import drawings, look_of, map_axes, points
from drivesizer.study.plan import read_study
from drivesizer.study.rows import rows_of, spec_of

GRID = """\
spec: robot.yaml
vary:
  load.mass: [30 kg, 60 kg, 90 kg, -5 kg]
  motion.speed: [1.2 m/s, 1.9 m/s]
"""


def mapped(folder, study, names=(), spec=CHEAP):
    plan = read_study(laid(folder, study, spec))
    variants = [plan.variant(n) for n in range(1, plan.total + 1)]
    rows = rows_of(plan.job, variants).rows
    over = map_axes(plan, names)
    return over, points(plan, over, rows), plan


def texts(svg):
    """The texts of a drawing for a typesetter, where letters are letters."""
    return [" ".join(t.itertext()).strip() for t in etree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")]


def test_a_map_of_drives_numbers_and_names_them(tmp_path):
    over, found, _ = mapped(tmp_path, GRID)
    made, said = drawings(over, found)
    assert said == [] and list(made) == ["best_set", "mass", "price", "smallest_margin"]
    seen = texts(made["best_set"]("typeset"))
    sets = {row["set"] for row in found[()] if row["set"]}
    assert len(sets) >= 2
    for number, name in enumerate(sorted(sets, key=lambda s: (-sum(r["set"] == s for r in found[()]), s)), 1):
        assert f"{number}  {name}" in seen
        assert seen.count(str(number)) == sum(row["set"] == name for row in found[()])
    assert seen.count("×") == 2  # of -5 kg at both speeds
    assert "load.mass (kg)" in seen and "motion.speed (m/s)" in seen
    assert any("hatched: no drive passes" in text and "×: an invalid variant" in text for text in seen)


def test_several_motor_families_are_a_map_of_their_own(tmp_path):
    over, found, _ = mapped(tmp_path, GRID)
    passing = [row for row in found[()] if row["set"]]
    for row in passing:
        row["motor_family"] = "RE 30"
    passing[0]["motor_family"] = "EC-max 40"
    seen = texts(drawings(over, found)[0]["motor_family"]("typeset"))
    assert {"1  RE 30", "2  EC-max 40", "Motor family of the best drive"} <= set(seen)


def test_the_colour_blind_distinguish_the_colours_of_drives():
    """As seen without red or green cones (Viénot, Brettel, Mollon 1999): CIE 1976 differences above 10 throughout."""
    short = {
        "protan": [[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]],
        "deutan": [[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]],
    }
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    rgb = np.array(
        [[int(face[n : n + 2], 16) / 255 for n in (1, 3, 5)] for face in {look_of(n).face for n in range(1, 9)}]
    )
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    for seen in (np.eye(3), *map(np.array, short.values())):
        xyz = np.cbrt(np.clip(linear @ seen.T, 0.0, 1.0) @ to_xyz.T / to_xyz.sum(axis=1))
        lab = np.stack([116 * xyz[:, 1] - 16, 500 * (xyz[:, 0] - xyz[:, 1]), 200 * (xyz[:, 1] - xyz[:, 2])], axis=1)
        apart = np.linalg.norm(lab[:, None] - lab, axis=2) + 1e3 * np.eye(8)
        assert apart.min() > 10.0


def test_the_same_drawing_has_the_same_bytes(tmp_path):
    made, _ = drawings(*mapped(tmp_path, GRID)[:2])
    again, _ = drawings(*mapped(tmp_path, GRID)[:2])
    for form in ("svg", "png"):
        assert made["mass"](form) == again["mass"](form)
    assert b"<text" not in made["mass"]("svg") and made["mass"]("png").startswith(b"\x89PNG")


@pytest.mark.slow
def test_probabilities_are_drawn_where_the_spec_has_tolerances(tmp_path):
    """Each variant has the probabilities that `size` reports for the same machine."""
    spec = CHEAP.replace("mass: 45 kg", "mass: 45 kg +- 3 kg") + "tolerances: {samples: 256}\n"
    study = "spec: robot.yaml\nvary:\n  motion.speed: [1.2 m/s, 1.5 m/s]\n  supply.current: [5 A, 8 A]\n"
    over, found, plan = mapped(tmp_path, study, spec=spec)
    probabilities = [row["none_fails"] for row in found[()]]
    assert 0.0 < min(probabilities) < 0.95 < max(probabilities)
    seen = texts(drawings(over, found)[0]["none_fails"]("typeset"))
    assert all(f"{100 * share:.3g}" in seen for share in probabilities)
    for number, share in enumerate(probabilities, 1):
        alone = size(spec_of(plan.job, plan.variant(number))).sets[0].reliability
        assert alone and alone.probability == share


def test_an_unknown_figure_is_no_colour_of_the_scale(tmp_path):
    """A set of which the mass is not known has an empty cell without a text, not a zero."""
    over, found, _ = mapped(tmp_path, GRID)
    known, *others = [row for row in found[()] if row["set"]]
    rows = [known, *(row | {"machine_mass_kg": None} for row in others)]
    seen = texts(drawings(over, {(): rows})[0]["mass"]("typeset"))
    mass = f"{known['machine_mass_kg']:.3g}"
    assert [text for text in seen if text.lstrip("≥") in (mass, "0")] == [
        text for text in seen if mass == text.lstrip("≥")
    ]
    assert any(text.endswith("wherever it is known: one value, so no colour scale") for text in seen)
