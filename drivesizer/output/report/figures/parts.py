"""Curves of one part out of the catalogue: what a motor, gearhead, stepper or battery does."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import isnan, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import columns_of
from drivesizer.catalog.parts import CONSTANT_DRAWS, PullOuts
from drivesizer.catalog.query import PartRow
from drivesizer.machine.battery import pack_of, run_time
from drivesizer.machine.part_curves import continuous_curve, gear_efficiency, line, nominal_voltage_curves
from drivesizer.output.report.figures.picture import DASHED, DOTTED, MIXED, Curve, Diagram, Plot
from drivesizer.output.report.figures.style import torque_unit
from drivesizer.output.words import figure
from drivesizer.physics.stepper import PULL_OUT_SHARE, pull_out_torque, rotor_teeth
from drivesizer.physics.thermal import data_temperature, rated_ambient
from drivesizer.spec.sections import Battery
from drivesizer.units import from_si, label, show

Array = NDArray[np.float64]
NamedPlots = Iterator[tuple[str, Plot]]
_POINTS = 121
_TALL = 1.8  # in, of a diagram alone on paper
_SUPPLIES = (24.0, 48.0)  # V, of a stepper without a printed curve
_USEFUL = 0.15  # of its torque at rest
_COLOURS = ("blue", "vermillion", "green", "purple", "orange", "grey")
_DASHES = ("solid", DASHED, DOTTED, MIXED)


def part_plots(hit: PartRow) -> dict[str, Plot]:
    """Curves of a part that its figures give, by a name."""
    return dict(_OF[hit.section](hit)) if hit.section in _OF else {}


def _look(number: int) -> dict[str, Any]:
    return {"colour": _COLOURS[number % len(_COLOURS)], "dashes": _DASHES[number % len(_DASHES)]}


def _alone(curves: list[Curve]) -> str:
    """Name of a line that has no legend, for it is alone."""
    return f": {curves[0].name}" if len(curves) == 1 else ""


_READ = 3.0  # times the nominal torque, the end of the axis; a large motor's stall is at 40 times


def reach_of(hit: PartRow) -> float:
    """End of the torque axis [N*m]: stall, or less where stall is far beyond the nominal torque; NaN unknown."""
    ends, continuous = line(hit), continuous_curve(hit)[0]
    nominal = hit["nominal_torque"]
    if isnan(nominal):
        own = 0.0 if isnan(hit["no_load_current"]) else hit["no_load_current"]
        nominal = hit["torque_constant"] * (hit["nominal_current"] - own)
    cut = ends.torque * (1.0 - min(hit["max_speed"] / ends.speed, 1.0))  # where the line starts, at the top speed
    torques = [x for x in (_READ * nominal, _READ * max(continuous, default=nan), 2.0 * cut) if x > 0.0]
    return min([*([max(torques)] if torques else []), *([] if isnan(ends.torque) else [ends.torque])], default=nan)


def _speeds(hit: PartRow, unit: str, reach: float) -> Iterator[Curve]:
    """Speed over torque: the line, the continuous region, peak and nominal torque, as far as known."""

    def curve(name: str, torque: Sequence[float], speed: Sequence[float], **look: Any) -> Curve:
        return Curve(name=name, x=from_si(np.asarray(torque), unit, "torque"),
                     y=from_si(np.asarray(speed), "rpm", "rotary_speed"), **look)  # fmt: skip

    ends, speeds, (torque, speed) = line(hit), [0.0], continuous_curve(hit)
    if not isnan(ends.torque):
        start = min(ends.speed, hit["max_speed"]) if hit["max_speed"] > 0.0 else ends.speed
        at = [0.0, ends.torque * (1.0 - start / ends.speed), ends.torque]
        yield curve(_line_name(hit, ends, start, reach), at, [start, start, 0.0])
        speeds.append(start)
    if torque:
        around = show(float(rated_ambient(hit)), "degC", "temperature")
        yield curve(f"continuous, at {around} around the motor", torque, speed, colour="green", dashes=DASHED)
        speeds += speed
    peak, nominal, fast = hit["peak_torque"], hit["nominal_torque"], hit["nominal_speed"]
    if len(speeds) > 1 and peak <= reach:
        yield curve(
            "peak torque, for a short time", [peak, peak], [0.0, max(speeds)], colour="vermillion", dashes=DOTTED
        )
    name = "nominal torque, on the line" if isnan(fast) else "nominal point"
    fast = ends.speed * (1.0 - nominal / ends.torque) if isnan(fast) else fast
    if len(speeds) > 1 and not isnan(nominal + fast):
        yield curve(name, [nominal], [fast], colour="green", mark="o", joined=False)


def _line_name(hit: PartRow, ends: Any, start: float, reach: float) -> str:
    schema = columns_of(hit.section)

    def text(name: str) -> str:
        return figure(hit[name], schema[name])

    at = "nominal voltage" if isnan(hit["nominal_voltage"]) else text("nominal_voltage")
    name = f"at {at}, winding at {show(float(data_temperature(hit)), 'degC', 'temperature')}"
    name += ", computed from R, k_t and the no-load speed" if ends.computed else ""
    name += f"; cut at the permitted {text('max_speed')}" if start < ends.speed else ""
    stall = figure(ends.torque, schema["stall_torque"])
    name += f"; stall, {stall}, is beyond the chart" if ends.torque > reach else ""
    return name


def _motor(hit: PartRow) -> NamedPlots:
    """Speed, current and efficiency over one axis of torque, of a motor or an actuator."""
    reach = reach_of(hit)
    unit = torque_unit(reach)
    speeds = [*_speeds(hit, unit, reach)]
    if not speeds or isnan(reach):
        return
    torque = reach * np.linspace(0.0, 1.0, _POINTS) ** 2  # dense where the efficiency rises
    _, current, efficiency = nominal_voltage_curves(hit, torque)
    below = [("current", "A", "vermillion", current)]
    if np.nanmax(efficiency, initial=0.0) <= 1.0:  # else its figures contradict one another
        below.append(("efficiency", "%", "purple", 100.0 * efficiency))
    below = [curve for curve in below if not np.isnan(curve[-1]).all()]
    across = from_si(torque, unit, "torque")
    diagrams = [Diagram(name="speed", unit="rpm", curves=speeds, whole=True, height=1.0 if below else 1.5)]
    diagrams += [
        Diagram(name=name, unit=of, whole=True, height=1.0,
                curves=[Curve(name=name, x=across, y=values, colour=colour, listed=False)])
        for name, of, colour, values in below
    ]  # fmt: skip
    names = ", ".join(("Speed", *(name for name, *_ in below)))
    yield "speed-torque", Plot(diagrams=diagrams, across="torque", unit=unit, ends=(0.0, 1.04 * float(across[-1])),
                               title=f"{names} over torque at nominal voltage")  # fmt: skip


def _gearhead(hit: PartRow) -> NamedPlots:
    """Efficiency over load where the torque without load is known, and permissible torques of its family over ratio."""
    reach = hit["intermittent_torque"] if hit["intermittent_torque"] > 0.0 else hit["continuous_torque"]
    if reach > 0.0 and not isnan(hit["no_load_torque"] + hit["efficiency"]):
        unit, torque = torque_unit(reach), np.linspace(0.0, reach, _POINTS)[1:]
        curve = Curve(name="efficiency", x=from_si(torque, unit, "torque"), y=100.0 * gear_efficiency(hit, torque))
        diagram = Diagram(name="efficiency", unit="%", curves=[curve], whole=True, height=_TALL)
        yield "efficiency", Plot(diagrams=[diagram], across="torque at the output", unit=unit,
                                 title="Efficiency over load, as sizing computes it")  # fmt: skip
    table = hit.table
    family = np.flatnonzero((table["family"] == hit["family"]) & ~table.excluded)
    curves = []
    for name, words, colour, mark in (("continuous_torque", "continuous", "blue", "o"),
                                      ("intermittent_torque", "intermittent", "vermillion", "s")):  # fmt: skip
        known = family[np.isfinite(table[name][family] + table["ratio"][family])]
        if len(np.unique(table["ratio"][known])) < 2:
            continue
        look: dict[str, Any] = {"colour": colour, "mark": mark, "joined": False}
        curves.append(Curve(name=words, x=table["ratio"][known], y=table[name][known], hollow=True,
                            texts=[str(part) for part in table["part"][known]], **look))  # fmt: skip
        if hit.row in known:
            curves.append(Curve(name=f"{hit.part}, {words}", x=[hit["ratio"]], y=[hit[name]], **look))
    if curves:
        diagram = Diagram(name="torque at the output", unit="N*m", curves=curves, whole=True, height=_TALL)
        yield "torque-ratio", Plot(diagrams=[diagram], across="ratio", unit="", log=True,
                                   title=f"Permissible torque in {hit['family']} over ratio")  # fmt: skip


def _stepper(hit: PartRow) -> NamedPlots:
    """Pull-out torque over speed: as printed, else of the model with its band."""
    own = hit.catalog.pull_outs.on(hit.catalog.pull_outs.stepper == hit.row)
    unit, curves = torque_unit(hit["holding_torque"]) if hit["holding_torque"] > 0.0 else "N*m", list[Curve]()
    for number, curve in enumerate(np.unique(own.curve).tolist()):
        rows = own.on(own.curve == curve)
        curves.append(Curve(name=pull_out_conditions(rows), x=from_si(rows.speed, "rpm", "rotary_speed"),
                            y=from_si(rows.torque, unit, "torque"), mark="o", **_look(number)))  # fmt: skip
    title = f"Pull-out torque as printed{_alone(curves)}"
    if not curves:
        curves, title = list(_modelled(hit, unit)), "Pull-out torque, estimated: no curve is printed"
    if curves:
        diagram = Diagram(name="pull-out torque", unit=unit, curves=curves, whole=True, height=_TALL)
        yield "pull-out", Plot(diagrams=[diagram], across="speed", unit="rpm", title=title)


def pull_out_conditions(curve: PullOuts) -> str:
    """Supply voltage, current and driver with which a curve was measured."""
    amps = float(curve.current[0])
    with_ = [show(float(curve.voltage[0]), "V", "voltage")]
    with_ += [] if np.isnan(amps) else [f"{show(amps, 'A', 'current')} amplitude"]
    with_ += [str(curve.driver[0])] if curve.driver[0] else []
    return ", ".join(with_)


def _modelled(hit: PartRow, unit: str) -> Iterator[Curve]:
    """Share of the ideal model at two supply voltages, and the band of the share."""
    known = {name: hit[name] for name in ("holding_torque", "phase_current", "resistance", "inductance")}
    teeth, (share, band) = rotor_teeth(hit["full_steps"]), PULL_OUT_SHARE
    if isnan(sum(known.values()) + teeth):
        return
    for number, voltage in enumerate(_SUPPLIES):
        far = np.geomspace(1.0, 1e4, 400)  # rad/s; up to where enough of the torque at rest is left to be of use
        torque = pull_out_torque(far, voltage, teeth=teeth, **known)
        left = np.flatnonzero(torque > _USEFUL * torque[0])
        speed = np.linspace(0.0, float(far[left[-1]] if len(left) else far[-1]), _POINTS)
        torque = from_si(share * pull_out_torque(speed, voltage, teeth=teeth, **known), unit, "torque")
        rpm, supply = from_si(speed, "rpm", "rotary_speed"), show(voltage, "V", "voltage")
        most = np.minimum(torque * band, torque / share)  # no more than the model itself
        yield Curve(name=f"5 to 95 % at {supply}", x=np.concatenate([rpm, rpm[::-1]]), filled=0.15,
                    y=np.concatenate([torque / band, most[::-1]]), colour=_COLOURS[number])  # fmt: skip
        yield Curve(name=f"{supply} supply, {share:g} of the ideal model", x=rpm, y=torque, **_look(number))


def _battery(hit: PartRow) -> NamedPlots:
    """Run time over current or power: as printed, else of one cell or block by the rule that sizing uses."""
    own = hit.catalog.discharges.on(hit.catalog.discharges.battery == hit.row)
    for quantity, unit in CONSTANT_DRAWS.items():
        known, curves = own.on(~np.isnan(getattr(own, quantity))), []
        for number, end in enumerate(np.unique(known.cutoff_voltage)):
            rows = known.on(known.cutoff_voltage == end)
            draw = getattr(rows, quantity)
            order = np.argsort(draw)
            curves.append(Curve(name=f"down to {show(float(end), 'V', 'voltage')}", x=draw[order],
                                y=rows.time[order] / 3600.0, mark="o", **_look(number)))  # fmt: skip
        if curves:
            title = f"Run time at constant {quantity} as printed{_alone(curves)}"
            yield f"discharge-{quantity}", _run_times(curves, f"constant {quantity}", label(unit), title)
    pack = pack_of(Battery(part=hit.part), hit.catalog) if not len(own.time) else None
    if pack and pack.law is not None:
        most = hit["continuous_current"] if hit["continuous_current"] > 0.0 else 2.0 * pack.capacity / 3600.0
        current = np.geomspace(pack.capacity / (20.0 * 3600.0), most, 41)
        times = np.asarray(run_time(pack, current * pack.mean_voltage)) / 3600.0
        curve = Curve(name=pack.rule, x=current, y=times)
        yield (
            "discharge",
            _run_times([curve], "constant current", "A", f"Run time at constant current, computed: {pack.rule}"),
        )


def _run_times(curves: list[Curve], across: str, unit: str, title: str) -> Plot:
    diagram = Diagram(name="run time", unit="h", curves=curves, log=True, height=_TALL)
    return Plot(diagrams=[diagram], across=across, unit=unit, log=True, title=title)


_OF: dict[str, Callable[[PartRow], NamedPlots]] = {
    "motors": _motor, "actuators": _motor, "gearheads": _gearhead, "steppers": _stepper, "batteries": _battery,
}  # fmt: skip
