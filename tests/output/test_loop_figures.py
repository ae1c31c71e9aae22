"""Loops in figures, tables and JSON: held against a sampled integrator, all of whose figures have closed forms."""

import json
import struct
from dataclasses import replace
from math import degrees, nan
from xml.etree import ElementTree

import numpy as np
import pytest
import yaml
from loops_by_hand import CASCADE, UNSTABLE, lag
from printed import blank_figures, text_of
from synthetic_validation import labels, synthetic_validation

from drivesizer.control.validation import ControllerGain, Validation
from drivesizer.errors import InputError
from drivesizer.output.document.axes import content_of
from drivesizer.output.json import documents as json_documents
from drivesizer.output.loop_table import cell, loop_figures, settled
from drivesizer.output.report import pdf, write_loop_figures
from drivesizer.output.report.figures import cycle
from drivesizer.output.report.figures import loops as bode_and_step
from drivesizer.output.report.figures.loops import block_diagram
from drivesizer.output.report.figures.picture import abreast, on_paper
from drivesizer.output.terminal import sizing as terminal
from drivesizer.output.thinning import curve_points, extremes
from drivesizer.results.sizing import SizingResult
from drivesizer.simulate import validate
from drivesizer.sizing import explain
from drivesizer.spec.robot import load_spec

VELOCITY = CASCADE[1]


@pytest.fixture(scope="module")
def proof(result: SizingResult) -> Validation:
    """A made-up cascade: every loop, a position error, and a winding that warms."""
    plain = synthetic_validation(result)
    time = plain.series["time"]
    more = {"position_error": 0.002 * np.sin(time), "winding_temperature": 298.15 + 3.0 * time}
    units = {"position_error": ("length", "mm"), "winding_temperature": ("temperature", "degC")}
    return replace(plain, loops=CASCADE, series=plain.series | more, series_units=plain.series_units | units)


# -- what is drawn


def marks(axes) -> dict[str, tuple[float, float]]:
    """Single points of a diagram by their colour."""
    return {
        line.get_color(): (*line.get_xdata(), *line.get_ydata()) for line in axes.lines if len(line.get_xdata()) == 1
    }


def test_crossover_margin_and_bandwidth_are_marked_where_the_closed_forms_have_them(canvas):
    opened, phase, closed = canvas(on_paper, bode_and_step.bode(CASCADE)).axes
    for loop in CASCADE:
        colour = bode_and_step.COLOURS[bode_and_step.look_of(loop)[0]]
        assert marks(opened)[colour] == (loop.crossover, 0.0)
        assert marks(phase)[colour] == pytest.approx((loop.crossover, -180.0 + degrees(loop.phase_margin)), abs=0.01)
        assert marks(closed)[colour] == pytest.approx((loop.bandwidth, -3.0103), abs=1e-3)
        (margin,) = [x for x in phase.lines if len(x.get_xdata()) == 2 and x.get_color() == colour]
        assert np.ptp(margin.get_ydata()) == pytest.approx(degrees(loop.phase_margin), abs=0.01)
        assert margin.get_ydata()[0] == -180.0


def test_two_integrators_start_at_minus_180_degrees_on_either_side_of_the_cut():
    for start in (np.pi, np.pi - 1e-9, -np.pi):
        bode = replace(VELOCITY.bode, open_phase=np.linspace(start, start - 1.0, 1500))
        assert bode_and_step.response_of(replace(VELOCITY, bode=bode)).phase[0] == pytest.approx(-180.0)


def test_an_unstable_loop_is_drawn_without_marks_and_says_so(canvas):
    opened, phase, closed = canvas(on_paper, bode_and_step.bode(UNSTABLE)).axes
    assert [len(marks(axes)) for axes in (opened, phase, closed)] == [1, 1, 1]  # those of the current loop
    assert len([line for line in opened.lines if len(line.get_xdata()) > 2]) == 2
    said = labels(on_paper(bode_and_step.bode(UNSTABLE)))
    assert "velocity, braking: unstable, largest pole 1.6" in said
    steps = canvas(abreast, bode_and_step.steps(UNSTABLE), 1.0).axes
    assert [any(len(line.get_xdata()) > 2 for line in axes.lines) for axes in steps] == [True, False]
    assert "largest pole 1.6" in steps[1].get_title(loc="left")


def test_a_step_is_drawn_until_it_has_settled_with_a_mark_where(canvas):
    for axes, loop in zip(canvas(abreast, bode_and_step.steps(CASCADE), 1.0).axes, CASCADE, strict=True):
        curve, mark = axes.lines[:2]
        time = curve.get_xdata() * (1.0 if "(s)" in axes.get_xlabel() else 1e-3)
        assert time[-1] >= 2.0 * loop.settling_time or len(loop.step) == settled(loop)
        a = loop.poles[0].real
        np.testing.assert_allclose(curve.get_ydata(), 100.0 * (1.0 - a ** (time / loop.period)), atol=1e-9)
        assert mark.get_xdata()[0] in (1e3 * loop.settling_time, loop.settling_time)


def test_the_closed_loop_shows_what_is_known_and_no_more(proof):
    said = labels(on_paper(cycle.closed_loop(proof)))
    assert {"position", "error", "(mm)", "winding", "temperature", "(°C)", "(V)", "(A)", "(m/s)"} <= said
    turning = replace(proof, series_units=proof.series_units | {"position_error": ("angle", "deg")})
    assert "(°)" in labels(on_paper(cycle.closed_loop(turning)))
    unknown = {"winding_temperature": np.full_like(proof.series["time"], nan)}
    assert "winding" not in labels(on_paper(cycle.closed_loop(replace(proof, series=proof.series | unknown))))
    held = {"winding_temperature": np.full_like(proof.series["time"], 298.15)}  # kept, as it is not known
    assert "winding" not in labels(on_paper(cycle.closed_loop(replace(proof, series=proof.series | held))))
    bare = {name: values for name, values in proof.series.items() if name not in ("position_error", "voltage")}
    titles = [title for _, title in cycle.closed_loop_rows(replace(proof, series=bare))]
    assert titles == ["speed", "speed error", "current", "winding temperature"]


# -- files


def test_figures_go_into_a_folder_as_drawing_and_picture(proof, tmp_path):
    folder = tmp_path / "loop"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    paths = write_loop_figures(proof, folder)
    names = [f"{name}.{form}" for name in ("closed_loop", "bode", "step") for form in ("svg", "png")]
    assert [path.name for path in paths] == names and {p.name for p in folder.iterdir()} == {*names, "notes.txt"}
    for path, content in ((path, path.read_bytes()) for path in paths):
        if path.suffix == ".png":
            assert content.startswith(b"\x89PNG") and struct.unpack(">I", content[16:20]) == (1300,)  # 6.5 in
            assert b"pHYs" in content and b"tEXt" not in content and b"tIME" not in content
        else:
            assert ElementTree.fromstring(content).tag.endswith("svg")
    assert (folder / "notes.txt").read_text() == "mine"


def test_no_figure_changes_when_one_cannot_be_written(proof, tmp_path):
    (tmp_path / "closed_loop.svg").write_text("older")
    (tmp_path / "step.png").mkdir()
    with pytest.raises(InputError, match=r"step\.png: cannot be written"):
        write_loop_figures(proof, tmp_path)
    assert (tmp_path / "closed_loop.svg").read_text() == "older"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["closed_loop.svg", "step.png"]


# -- tables


def test_a_table_says_the_figures_of_the_closed_forms():
    said = {figure.name: cell(figure) for figure in loop_figures(lag("velocity", 0.5, 2e-3))}
    # g = 1/2: crossover 2 asin(1/4)/(2 pi T), margin 90° - asin(1/4), gain margin 4, pole 1/2; cos of the bandwidth 3/4
    assert said["crossover"] == "40.2 Hz" and said["phase_margin"] == "75.5 °" and said["gain_margin"] == "4"
    assert said["pole_radius"] == "0.5" and said["bandwidth"] == "57.5 Hz" and said["overshoot"] == "0 %"
    assert said["settling_time"] == "12 ms" and said["period"] == "2 ms"  # 0.5^6 = 0.016 is below 2 %
    none = {figure.name: cell(figure) for figure in loop_figures(UNSTABLE[1])}
    assert none["pole_radius"] == "1.6" and {none[n] for n in ("bandwidth", "phase_margin", "sensitivity")} == {"–"}


@pytest.mark.parametrize("width", [80, 140])
def test_the_terminal_prints_the_loops_of_a_validation(width, proof, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(width))
    terminal.validation(proof, checks=True)
    out = capsys.readouterr().out
    assert "The loops by linear analysis" in out and max(len(line.rstrip()) for line in out.splitlines()) <= width
    assert ("sensitivity" in out) == (width == 140)


def test_a_validation_answers_first(proof, capsys, monkeypatch):
    """Verdict and the three tightest checks; all checks, gains and loops only on request."""
    monkeypatch.setenv("COLUMNS", "80")
    terminal.validation(proof)
    out = capsys.readouterr().out
    assert "the tightest of" in out and "linear analysis" not in out and "controller" not in out.splitlines()[-1]
    assert len(out.splitlines()) < 20


def test_the_report_has_table_figures_and_the_controllers_own_units(result, proof):
    own = ControllerGain(place="0x30A0:01", name="current controller P gain", value=250_000, unit="µV/A")
    with blank_figures():
        content = pdf.report_pdf(
            content_of(result, replace(proof, loops=(*UNSTABLE, CASCADE[2]), controller_gains=(own,)))
        )
        bare = text_of(pdf.report_pdf(content_of(result, replace(proof, loops=()))))
    text = text_of(content)
    for said in (
        "The loops by linear theory", "velocity, braking unstable", "1.6", "Frequency response",
        "Response of each loop", "An unstable loop has no margins", "0x30A0:01", "250000 µV/A",
        "position error, current, voltage and winding",
    ):  # fmt: skip
        assert said in text, said
    assert "linear theory" not in bare and "Frequency response" not in bare and "0x30A0" not in bare


# -- JSON


def document(proof: Validation) -> list[dict]:
    text = json_documents.as_text(proof)
    return json.loads(text, parse_constant=lambda c: pytest.fail(f"{c} in the JSON"))["loops"]


def test_curves_in_the_document_are_thin_true_and_say_of_how_many(proof):
    for written, loop in zip(document(proof), CASCADE, strict=True):
        bode, step = written["bode"], written["step"]
        assert bode["thinned_from"] == 1500 and step["thinned_from"] == len(loop.step)
        bode, step = bode["columns"], step["columns"]
        assert {len(column) for column in bode.values()} == {len(bode["frequency"])}
        assert len(bode["frequency"]) <= 200 and len(step["time"]) == len(step["response"]) <= 200
        theta = 2.0 * np.pi * np.array(bode["frequency"]) * loop.period
        gain = 1.0 - loop.poles[0].real
        np.testing.assert_allclose(bode["open_magnitude"], gain / (2.0 * np.sin(theta / 2.0)), rtol=1e-9)
        assert bode["frequency"][-1] == pytest.approx(0.5 / loop.period)
        answer = 1.0 - loop.poles[0].real ** (np.array(step["time"]) / loop.period)
        np.testing.assert_allclose(step["response"], answer, atol=1e-9)
        assert abs(step["response"][-1] - 1.0) < 0.02


def test_an_unstable_loop_is_null_where_it_has_no_figure(proof):
    _, written = document(replace(proof, loops=UNSTABLE))
    assert written["stable"] is False and written["step"] is None and written["pole_radius"] == pytest.approx(1.6)
    for key in ("gain_margin", "phase_margin", "crossover", "bandwidth", "rise_time", "settling_time"):
        assert written[key] is None
    assert len(written["bode"]["columns"]["frequency"]) > 100


# -- thinning


def test_thinning_keeps_peaks_wherever_they_are_and_no_more_than_was_asked_for():
    for count in (1499, 1500, 1777, 20_000):
        for place in (1, count // 3, count - 2):
            smooth, peaked = np.linspace(1.0, 0.0, count), np.zeros(count)
            peaked[place] = 7.0
            rows = curve_points((smooth, peaked), 200)
            assert place in rows and {0, count - 1} <= set(rows.tolist()) and len(rows) <= 200
            assert np.all(np.diff(rows) > 0)
            assert place in extremes(-peaked, 300)  # in the last bin, which is not full, as well


# -- the block diagram


@pytest.mark.parametrize(
    ("control", "said"),
    [
        ({"bandwidth": "20 Hz"}, ["PI", "encoder, 500 lines; counts of", "R 2.32 Ω", "K 29.54", "load torque"]),
        ({"structure": "cascade", "position": {}, "speed_from": "exact"},
         ["position P", "velocity PI", "current PI", "feedforward", "path's speed", "speed measured exactly", "angle"]),
    ],
    ids=["voltage PID", "cascade"],
)  # fmt: skip
def test_the_block_diagram_names_what_is_in_the_loop(example, catalog, control, said):
    """Figure 3 of the paper: RE 25 with 2.32 ohm behind 26.85 x 1.1."""
    data = yaml.safe_load(example.read_text(encoding="utf-8"))
    data["control"] = control
    spec = load_spec(data)
    proof = validate(spec, explain(spec, "118752", "406764", catalog=catalog)[0])
    text = block_diagram(proof, proof.linear)("typeset").decode()
    for word in said:
        assert f">{word}" in text, word
