"""A log to an identification: which model it allows, the fit, figures with bands, and the log's checks.

Out of voltage, current and speed come resistance, constants, inertia and friction, the torque constant as the voltage
per speed unless a load is known. Out of voltage and speed alone come voltages per speed, acceleration and against
friction, as many logs have them; out of current and speed alone currents. A data sheet beside it makes inertia and
friction of these.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isnan, nan, pi, sqrt
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.catalog_file import parse
from drivesizer.catalog.importing import file_text
from drivesizer.catalog.parts import NAMES, Column, printed
from drivesizer.catalog.query import PartRow, digits, is_known, partners
from drivesizer.control.drive_train import drive_train, mechanics
from drivesizer.errors import InputError, quoted
from drivesizer.files.text import read_bytes
from drivesizer.files.yaml_source import YamlSource
from drivesizer.identification import declared
from drivesizer.identification.calibration import calibration
from drivesizer.identification.fit import BAND, BOUND, Fit, Heat, Record, fitted, heated, of_points, widest
from drivesizer.identification.log import LARGEST, Log, read_log
from drivesizer.physics.drive_train import back_emf_constant
from drivesizer.physics.figures import Figures
from drivesizer.physics.motion_curves import local_parabola
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.identification import Identification, IdentifiedFigure, Inseparable, LogFinding, Trace
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import from_si, show

Array = NDArray[np.float64]

_MOST = 8000  # samples that are fitted
_RESTARTS = 30  # stretches of a log driven by its current, which would drift
_SHORTEST = 100  # samples of such a stretch
_START = 9.0  # samples whose parabola gives the speed at a start
_TOLERANCE = {"R": 0.10, "k_e": 0.10, "k_t": 0.10, "J": 0.15, "L": 0.20}  # of a data sheet, where it says none
_FEWEST_POINTS = 8  # at constant speed
_LATE = 1.0  # samples of delay that are worth a word


class Reference(NamedTuple):
    """The drive that a log is held against, as far as it is known, SI."""

    label: str = ""
    figures: Mapping[str, float] = {}  # R, L, k_e, k_t, J, e: by the model's names
    ratio: float = 1.0  # of all gears, behind which a load is
    gear_ratio: float = nan  # of the gearhead alone, behind which its torque was logged
    per_speed: float = nan  # speed of the motor by that of the load [rad/m or 1]
    weight: float = 0.0  # N*m at the output of the gears, that is known to pull at rest
    inertia: float = nan  # kg*m^2 of what is known to be mounted at the output


NOTHING = Reference()


def identify(path: Path, of: Reference = NOTHING, *, scales: Mapping[str, float] | None = None,
             named: Mapping[str, str] | None = None, content: bytes | None = None) -> Identification:  # fmt: skip
    """Identify a drive by its log."""
    content = read_bytes(path, LARGEST) if content is None else content
    identification = calibration(path, content)
    if identification is not None:
        return identification
    log = scaled(read_log(path, named or {}, content), scales or {})
    columns = at_motor(log, of)
    current, R_25 = columns.get("current"), of.figures.get("R", nan)
    if "speed" not in columns and (heat := heated(log, current, R_25)).figures:
        return _of_heat(log, heat, of)
    if "speed" not in columns or not {"voltage", "current"} & set(columns):
        have = ", ".join(log.heads.values())
        raise InputError(f"{path}: {quoted(have)}; expected the motor's speed or position, and its voltage or current")
    if log.steady:
        return _of_points(log, columns, of)
    record, time = record_of(log, columns, of)
    known = {name: x for name, x in of.figures.items() if x > 0.0}
    free, known = _fitted_figures(record, known)
    fit = fitted(record, known, free)
    heat = heated(log, current, fit.values["R"] if "R" in fit.free else R_25)
    figures = [*_figures(record, fit, known, of, log), *heat.figures]
    traces = [
        Trace(
            "motor speed" if of.label else "speed",
            "rotary_speed",
            "rpm",
            record.outputs["speed"],
            fit.modelled["speed"],
        )
    ]
    if "current" in record.outputs:
        traces.append(Trace("current", "current", "A", record.outputs["current"], fit.modelled["current"]))
    remarks = [*log.remarks, *_remarks(record, fit, known, of)]
    return Identification(
        log=log.name, label=of.label, columns=log.heads, samples=len(record.u), duration=float(time[-1] - time[0]),
        driven=record.driven, figures=tuple(figures), inseparable=(*_structural(record, fit), *fit.inseparable,
        *heat.inseparable), findings=tuple(_findings(log, record, fit, of)), condition=fit.condition, time=time,
        traces=tuple(traces), remarks=tuple(remarks),
    )  # fmt: skip


def _of_heat(log: Log, heat: Heat, of: Reference) -> Identification:
    """Of a log at rest: temperatures alone."""
    return Identification(
        log=log.name, label=of.label, columns=log.heads, samples=len(log.columns["time"]),
        duration=float(np.ptp(log.columns["time"])), driven="current", figures=heat.figures,
        inseparable=(*heat.inseparable, Inseparable("all but heat", "no speed was logged", "the motor's speed")),
        findings=tuple(log_findings(log, pulled=True)), condition=nan, time=heat.time, traces=heat.traces,
        remarks=log.remarks,
    )  # fmt: skip


def _of_points(log: Log, columns: Mapping[str, Array], of: Reference) -> Identification:
    """Of points at constant speed: torque and voltage in proportion to current and speed."""
    behind = "gearhead_torque" if "gearhead_torque" in columns else "torque"
    if not {"current", behind} <= set(columns) or len(columns["speed"]) < _FEWEST_POINTS:
        expected = f"the time of each row, or {_FEWEST_POINTS} steady points or more with current, speed and torque"
        raise InputError(f"{log.name}: no time; expected {expected}")
    i, w = columns["current"], columns["speed"]
    laws = {"k_t M_c b": ([i, -np.sign(w), -w], columns[behind] / of.ratio)}
    laws |= {"R k_e": ([i, w], columns["voltage"])} if "voltage" in columns else {}
    figures, traces = [], []
    for names, (table, right) in laws.items():
        values, three = of_points(np.column_stack(table), right)
        for name, x, sigma, basis in zip(names.split(), values, BAND * three.max(axis=0), widest(three), strict=True):
            title, kind, unit = _TITLES[name]
            printed = of.figures.get(name, nan)
            deviation = (x - printed) / sqrt((sigma / BAND) ** 2 + (_TOLERANCE.get(name, 0.2) * printed) ** 2)
            value, low, high = (max(float(y), 0.0) for y in (x, x - sigma, x + sigma))  # no friction drives
            figures.append(
                IdentifiedFigure(name, title, kind, unit, value, low, high, basis, printed, float(deviation))
            )
        quantity = ("torque", "torque", "mN*m") if "k_t" in names else ("voltage", "voltage", "V")
        traces.append(Trace(*quantity, right, np.column_stack(table) @ values))
    tied = Inseparable("inertia, inductance, delay", "it has steady points alone", "a log of a move")
    lossy = ("a loss of the gears is in the torque constant",) if of.ratio != 1.0 else ()
    return Identification(
        log=log.name, label=of.label, columns=log.heads, samples=len(w), figures=tuple(figures), inseparable=(tied,),
        findings=tuple(log_findings(log, pulled=True)), time=np.arange(float(len(w))), traces=tuple(traces),
        remarks=(*log.remarks, *lossy),
    )  # fmt: skip


def scaled(log: Log, scales: Mapping[str, float]) -> Log:
    """A log with some columns times a factor."""
    for name in scales:
        if name not in log.columns:
            raise InputError(f"--scale: {quoted(name)} is no column of the log; expected {', '.join(log.columns)}")
    columns = {name: column * scales.get(name, 1.0) for name, column in log.columns.items()}
    return log._replace(columns=columns)


def at_motor(log: Log, of: Reference) -> dict[str, Array]:
    """Columns at the motor: voltage by duty and supply, speed by the load's, or as slope of a position."""
    columns = dict(log.columns)
    if "voltage" not in columns and {"duty", "supply"} <= set(columns):
        duty = columns["duty"]
        columns["voltage"] = columns["supply"] * (duty / 100.0 if np.abs(duty).max() > 1.5 else duty)
    if "speed" not in columns and "load_speed" in columns and of.per_speed > 0.0:
        columns["speed"] = columns["load_speed"] * of.per_speed
    if "speed" not in columns and "position" in columns and not log.steady:
        columns["speed"] = np.concatenate([
            local_parabola(t, x, 5.0 * float(np.median(np.diff(t))))[1] if len(t) > 3 else np.zeros(len(t))
            for t, x in ((columns["time"][move], columns["position"][move]) for move in log.moves)
        ])  # fmt: skip
    return columns


def record_of(log: Log, columns: Mapping[str, Array], of: Reference) -> tuple[Record, Array]:
    """A log on an even grid; inputs are means over each interval, outputs values at its start."""
    driven = "voltage" if "voltage" in columns else "current"
    time = columns["time"]
    apart = np.diff(time)
    usual = float(np.median(apart[apart > 0.0]))
    moves = [move for move in log.moves if len(time[move]) > 5]
    total = sum(float(t[-1] - t[0]) for t in (time[move] for move in moves))
    h = max(usual, total / _MOST)
    torque = columns.get("gearhead_torque", columns.get("torque")) if log.weight is None else log.weight
    ratio = of.gear_ratio if "gearhead_torque" in columns and of.gear_ratio > 0.0 else of.ratio
    warms: list[Array] | None = [] if driven == "voltage" and {"current", "winding"} <= set(columns) else None
    inputs, loads, starts, outputs, grid = [], [], [], {name: list[Array]() for name in ("current", "speed")}, []
    for move in moves:
        t = time[move]
        even = t[0] + h * np.arange(int((t[-1] - t[0]) / h * (1 + 1e-9)) + 1)
        signal = columns[driven][move]
        between = signal[:-1] if driven == "voltage" else (signal[:-1] + signal[1:]) / 2.0  # held, or on a line
        integral = np.append(0.0, np.cumsum(np.diff(t) * between))
        beyond = integral[-1] + signal[-1] * h
        edges = np.interp(np.append(even, even[-1] + h), np.append(t, t[-1] + h), np.append(integral, beyond))
        inputs.append(np.diff(edges) / h)
        loads.append(np.full(len(even), of.weight) if torque is None else np.interp(even, t, torque[move]))
        smooth = local_parabola(t, columns["speed"][move], _START * h)[0]
        first = np.full(len(even), nan)
        step = len(even) if driven == "voltage" else max(_SHORTEST, total / h / _RESTARTS)
        places = np.arange(0, max(len(even) - 10, 1), int(step))
        first[places] = np.interp(even[places], t, smooth)
        starts.append(first)
        for name in outputs:
            if name in columns and not (name == "current" and driven == "current"):
                outputs[name].append(np.interp(even, t, columns[name][move]))
        if warms is not None:
            warms.append(COPPER * (np.interp(even, t, columns["winding"][move]) - DATA_TEMPERATURE))
        grid.append(even)
    if not moves:
        raise InputError(f"{log.name}: no move of more than 5 rows; expected one without gaps")
    load = np.concatenate(loads)
    rotor = of.figures.get("J", nan) if torque is None else nan
    record = Record(
        h=h, driven=driven, u=np.concatenate(inputs), load=np.append(load, load[-1]),
        outputs={name: np.concatenate(parts) for name, parts in outputs.items() if parts},
        start=np.concatenate(starts), ratio=ratio, rotor=rotor if rotor > 0.0 else nan,
        warm=None if warms is None else np.concatenate(warms),
    )  # fmt: skip
    return record, np.concatenate(grid)


def _fitted_figures(record: Record, known: dict[str, float]) -> tuple[tuple[str, ...], dict[str, float]]:
    """Figures that are fitted of a record, and known ones: without data sheet a resistance or constant of 1."""
    # losses by direction scale as the torque constant does: behind gears that is the voltage per speed
    direct = record.ratio == 1.0 or record.driven == "current" or "current" not in record.outputs
    loads = (("k_t", "e") if direct else ("e", "e_back")) if record.loaded else ()
    if record.driven == "current":
        return ("J", "M_c", "b", *loads, "delay"), known if record.loaded else {"k_t": 1.0, "k_e": 1.0} | known
    if "current" not in record.outputs:
        own = known if "R" in known and "k_t" in known else {"R": 1.0, "k_t": 1.0}
        if record.loaded:  # torque per voltage is what a known load gives
            own = {"R": own["R"]}
        return ("L", "k_e", "J", "M_c", *loads, "delay"), {n: x for n, x in own.items() if n in ("R", "k_t", "e")}
    return ("R", "L", "k_e", "J", "M_c", "b", *loads, "delay"), {n: x for n, x in known.items() if n != "k_t"}


# -- Figures as they are printed.

_TITLES = {name: (title, kind, unit) for name, title, kind, unit in declared("drive")}
_OF_VOLTAGE = {name: words for name, *words in declared("of a voltage")}
_OF_CURRENT = {name: words for name, *words in declared("of a current")}


def _normalised(record: Record, fit: Fit, known: Mapping[str, float], of: Reference) -> dict[str, list[str]]:
    """Other names where torques are not known as such."""
    if "k_t" in fit.free or (record.driven == "voltage" and "current" in record.outputs):
        return {}
    if record.driven == "current":
        return {} if of.figures.get("k_t", nan) > 0.0 else _OF_CURRENT
    return {} if known.get("R") != 1.0 or known.get("k_t") != 1.0 else _OF_VOLTAGE


def _figures(
    record: Record, fit: Fit, known: Mapping[str, float], of: Reference, log: Log
) -> Iterator[IdentifiedFigure]:
    normal = _normalised(record, fit, known, of)
    shared = _sheet_share(record, fit, normal)
    for name in _TITLES:
        if name in fit.free:
            kinds = fit.spread[name]
            basis, value = widest(kinds[:, None])[0], fit.values[name]
            sigma = float(kinds.max())
            if name in ("J", "M_c", "b"):
                sigma = sqrt(sigma**2 + (shared * value) ** 2)
        elif name == "k_t" and "k_e" in fit.free and "current" in record.outputs:
            basis, value = "as the back-EMF constant", fit.values["k_e"]
            sigma = float(fit.spread["k_e"].max())
        else:
            continue
        factor = record.h if name == "delay" else 1.0
        title, kind, unit = _TITLES[name]
        name_, title, kind, unit = normal.get(name, [name, title, kind, unit])
        if name == "k_t" and known.get("R") == 1.0:
            name_, title, kind, unit = "torque_per_volt", "stall torque per voltage", "plain", "N*m/V"
        if log.weight is not None or (not of.label and of.ratio == 1.0):
            title = title.replace(" at the motor", " at the shaft")
        printed = of.figures.get(name, nan) if name not in normal and name_ == name else nan
        printed = nan if name == "J" and not _bare(of, log) else printed
        tolerance = _TOLERANCE.get(name, 0.2) * printed
        deviation = (value - printed) / sqrt(sigma**2 + tolerance**2) if printed > 0.0 else nan
        reach = BAND * sigma
        least, most = -np.inf if name == "delay" else 0.0, 1.0 if name in ("e", "e_back") else np.inf
        yield IdentifiedFigure(name_, title, kind, unit, factor * value, factor * max(value - reach, least),
                               factor * min(value + reach, most), basis, printed, deviation)  # fmt: skip
    if "J" in fit.free and "J" not in normal:
        yield from _inertias(fit, of, log)


def _bare(of: Reference, log: Log) -> bool:
    """Whether the inertia is the rotor's: nothing else turns, or a torque was logged behind it."""
    return bool({"torque", "gearhead_torque"} & set(log.columns)) or (
        isnan(of.inertia) and isnan(of.per_speed) and log.weight is None
    )


def _sheet_share(record: Record, fit: Fit, normal: Mapping[str, Any]) -> float:
    """Relative spread that figures have by those that are taken from the data sheet."""
    if normal or ("current" in record.outputs and record.driven == "voltage") or "k_t" in fit.free:
        return 0.0
    return (
        _TOLERANCE["k_t"] / BAND
        if record.driven == "current"
        else sqrt(_TOLERANCE["k_t"] ** 2 + _TOLERANCE["R"] ** 2) / BAND
    )


def _inertias(fit: Fit, of: Reference, log: Log) -> Iterator[IdentifiedFigure]:
    """Inertia of the load by that of the rotor, or the other way round."""
    mounted = log.inertia if log.inertia > 0.0 else of.inertia
    spread = BAND * float(fit.spread["J"].max())
    if mounted > 0.0:
        value = fit.values["J"] - mounted / of.ratio**2
        yield IdentifiedFigure("rotor_inertia", "inertia without what is mounted", "inertia", "g*cm^2", value,
                               max(value - spread, 0.0), value + spread, "inertia less that which is known",
                               of.figures.get("J", nan))  # fmt: skip
    elif not _bare(of, log) and (rotor := of.figures.get("J", nan)) > 0.0:
        square = of.ratio**2
        value = (fit.values["J"] - rotor) * square
        reach = (spread + _TOLERANCE["J"] * rotor) * square
        yield IdentifiedFigure("load_inertia", "inertia of the load at the output", "inertia", "kg*m^2", value,
                               max(value - reach, 0.0), value + reach, "inertia less that of the rotor")  # fmt: skip


def _structural(record: Record, fit: Fit) -> Iterator[Inseparable]:
    """Figures that the columns themselves do not separate."""
    if record.driven == "voltage" and "current" not in record.outputs:
        yield Inseparable("resistance, torque constant, inertia and friction apart", "the current was not logged",
                          "voltage and current, one move of it under load at low speed")  # fmt: skip
        yield Inseparable("viscous friction apart from back-EMF", "both grow with the speed", "the current")
    if record.driven == "current":
        yield Inseparable("resistance and back-EMF constant", "the voltage was not logged", "the voltage at the motor")
        if "k_t" not in fit.free:
            yield Inseparable("torque constant apart from inertia and friction", "no torque was logged",
                              "a measured torque at the output, or a known load lifted and lowered")  # fmt: skip
    if record.driven == "voltage" and "current" in record.outputs and not record.loaded:
        yield Inseparable("torque constant apart from back-EMF constant, gear loss", "no load at the output is known",
                          "a measured torque, or a known load lifted and lowered")  # fmt: skip
    if "e_back" in fit.free:
        yield Inseparable("torque constant apart from gear loss", "both scale the torque at the output",
                          "a log of the motor alone")  # fmt: skip


def _findings(log: Log, record: Record, fit: Fit, of: Reference) -> Iterator[LogFinding]:
    yield from log_findings(log, pulled=of.weight != 0.0)
    if "k_e" in fit.free:
        yield from unit_findings(
            "the voltage per speed", "speed", fit.values["k_e"], of.figures.get("k_e", nan), of.ratio
        )
    if "R" in fit.free:
        yield from unit_findings("the resistance", "current", fit.values["R"], of.figures.get("R", nan), 1.0)
    late = fit.values["delay"]
    if abs(late) > _LATE:
        yield LogFinding(
            "delay", f"the {record.driven} acts {late:.2g} samples ({1e3 * late * record.h:.3g} ms) after its row"
        )
    for name, values in fit.modelled.items():
        if name in record.outputs:
            measured = record.outputs[name]
            left = float(np.sqrt(((values - measured) ** 2).mean())) / (float(measured.std()) or 1.0)
            if left > 0.3:
                text = f"the model leaves {left:.0%} of the {name}'s spread: another law than friction and inertia acts"
                yield LogFinding("misfit", text, severe=True)


def _remarks(record: Record, fit: Fit, known: Mapping[str, float], of: Reference) -> Iterator[str]:
    of_sheet = [n for n in ("R", "k_t") if n in of.figures and known.get(n) == of.figures[n] and n not in fit.free]
    if of_sheet and (record.driven == "current" or "current" not in record.outputs):
        yield f"{' and '.join(of_sheet)} are the data sheet's: their tolerance is in the bands of inertia and friction"
    if "e_back" in fit.free:
        yield "behind gears k_t is taken as k_e: by as much as it is less, both gear efficiencies are too low"
    if record.warm is not None:
        yield "the resistance is that at 25 °C by the logged temperature of the winding"
    if not isnan(record.rotor) and record.loaded:
        yield "the load's inertia is behind the gears, the rotor's is the data sheet's"


_PERIOD = 1e-3  # s, of the controller: of a train whose inductance is unknown


def of_motor(motor: PartRow, ratio: float = 1.0) -> Reference:
    """A motor by its data sheet."""
    columns: Figures = {name: motor.table[name][motor.row : motor.row + 1] for name in motor.table.columns}
    return Reference(label=motor.part, ratio=ratio, figures={
        "R": motor["resistance"], "L": motor["inductance"], "k_t": motor["torque_constant"],
        "k_e": float(back_emf_constant(columns)[0]), "J": motor["rotor_inertia"],
    })  # fmt: skip


def of_drive(spec: RobotSpec, drive: DriveSet) -> Reference:
    """A spec with its drive: figures of the motor, gears, and the weight that pulls at rest."""
    train, _ = drive_train(spec, drive, _PERIOD)
    rigid, _ = mechanics(spec, drive)
    return Reference(
        label=drive.label, ratio=rigid.ratio, gear_ratio=rigid.gear_ratio, per_speed=rigid.motor_per_speed,
        weight=rigid.rest_torque,
        figures={"R": train.resistance, "L": train.inductance, "k_t": train.torque_constant,
                 "k_e": train.back_emf_constant, "J": rigid.motor_inertia, "e": rigid.efficiency},
    )  # fmt: skip


_JITTER = 0.05  # of the interval
_COARSE = 0.01  # of the largest speed
_LIMITED = 0.02  # of the moments
_SAG = 0.05
_WARMER = 10.0  # K
_NEAR = 0.06  # of a factor
_OFF = 0.12  # of a constant, from which on a factor is looked for
_FAR = 0.5  # and from which on it is said that there is none
_FACTORS = (  # times the column, and what it would be
    (2.0 * pi, "turns per second taken as rad/s"), (1.0 / (2.0 * pi), "rad/s taken as turns per second"),
    (pi / 30.0, "rpm taken as rad/s"), (30.0 / pi, "rad/s taken as rpm"), (60.0, "per second taken as per minute"),
    (1.0 / 60.0, "per minute taken as per second"), (sqrt(3.0) / 2.0, "amplitude of a phase against two in series"),
    (2.0 / sqrt(3.0), "two in series against the amplitude of a phase"), (sqrt(2.0), "effective value of an amplitude"),
    (1.0 / sqrt(2.0), "amplitude of an effective value"), (sqrt(3.0), "a phase against two in series"),
    (1.0 / sqrt(3.0), "two in series against a phase"), (2.0, "a phase against two in series"),
    (0.5, "two in series against a phase"), (1e-3, "thousandths"), (1e3, "thousands"),
)  # fmt: skip


def log_findings(log: Log, *, pulled: bool) -> Iterator[LogFinding]:
    """Sampling, steps, limits, sag and warming of a log; ``pulled``: a load is known to pull one way."""
    columns = log.columns
    if not log.steady:
        apart = np.diff(columns["time"])
        apart = apart[(apart > 0.0) & (apart < 10.0 * np.median(apart))]
        usual, spread = float(np.median(apart)), float(apart.std())
        if spread > _JITTER * usual:
            interval = f"{show(usual, 'ms', 'time', 3)} ± {show(spread, 'ms', 'time', 2)}"
            yield LogFinding("jitter", f"samples every {interval}: they are put on an even grid")
    if "speed" in columns:
        steps = np.diff(np.unique(columns["speed"]))
        top = float(np.abs(columns["speed"]).max())
        if len(steps) and float(steps.min()) > _COARSE * top:
            yield LogFinding(
                "quantisation", f"the speed comes in steps of {float(steps.min()) / top:.1%} of its largest"
            )
    if not pulled and {"current", "speed"} <= set(columns):
        current, speed = columns["current"], columns["speed"]
        if current.min() >= 0.0 < current.max() and speed.max() > -0.2 * speed.min() > 0.0:
            text = f"{log.heads['current']} has no direction: it is never below 0 while the speed reverses"
            yield LogFinding("direction", text, severe=True)
    for name in ("voltage", "current", "duty"):
        if name in columns:
            size = np.abs(columns[name])
            share = float((size >= size.max() * (1.0 - 1e-6)).mean())
            if share > _LIMITED and size.max() > 1.5 * np.median(size):
                yield LogFinding(
                    "saturation", f"{log.heads[name]} is at its largest value {share:.0%} of the time: a limit"
                )
    if "supply" in columns:
        low, high = float(columns["supply"].min()), float(columns["supply"].max())
        if high - low > _SAG * high:
            yield LogFinding("sag", f"the supply sags from {high:.4g} to {low:.4g} V")
    if "winding" in columns and (rise := float(np.ptp(columns["winding"]))) > _WARMER:
        yield LogFinding(
            "warming", f"the winding's temperature changes by {rise:.3g} K: resistance by {0.39 * rise:.2g} %"
        )


def unit_findings(of: str, column: str, value: float, printed: float, ratio: float) -> Iterator[LogFinding]:
    """A factor that would make a constant that of the data sheet, where it is far from it."""
    if isnan(printed) or not value > 0.0 or not printed > 0.0:
        return
    off = value / printed
    if abs(off - 1.0) < _OFF:
        return
    gears = [] if ratio == 1.0 else [(ratio, "the speed of the output"), (1.0 / ratio, "the speed of the motor")]
    factor, meaning = min((*_FACTORS, *gears), key=lambda entry: abs(np.log(off / entry[0])))
    near = abs(off / factor - 1.0) < _NEAR
    if not near and abs(off - 1.0) < _FAR:
        return  # a deviation, which its own row shows
    text = f"{of} is {off:.4g} times that of the data sheet"
    more = f": {column} times {factor:.5g} would fit it ({meaning})" if near else ": no usual factor explains it"
    yield LogFinding("units", text + more, factor if near else float("nan"), severe=True)


# -- A catalogue file of the motor that was identified: the data sheet's row with what was measured in its place.


_DROPPED = {  # of the data sheet: names, and what would contradict
    *NAMES, "speed_constant", "no_load_speed", "no_load_current", "stall_torque", "stall_current",
    "speed_torque_gradient", "mechanical_time_constant", "max_efficiency",
}  # fmt: skip
_NEEDED = ("R", "k_t", "rotor_inertia")


def part_file(identification: Identification, motor: PartRow | None, name: str) -> bytes:
    """The text of a catalogue with the identified motor."""
    if motor is not None and motor.section != "motors":
        raise InputError(
            f"{quoted(motor.part)} is an actuator: its figures are printed at the output; expected a motor to "
            "write a row"
        )
    figures = {figure.name: figure.value for figure in identification.figures if figure.basis != BOUND}
    if "rotor_inertia" not in figures and "load_inertia" not in figures and "J" in figures:
        figures["rotor_inertia"] = figures["J"]
    lacks = [n for n in _NEEDED if not figures.get(n, 0.0) > 0.0]
    if lacks and motor is None:
        raise InputError(
            f"{identification.log}: {', '.join(lacks)} cannot be had from this log alone; expected --motor "
            "for the rest of a row"
        )
    measured = {column: figures[name] for name, column in declared("columns") if name in figures}
    columns = printed("motors")
    stem = name.rsplit(".", 1)[0]
    row: dict[str, str] = {"part": f"{motor.part} measured" if motor else stem, "kind": "brushed"}
    if motor is not None:
        for column in columns.values():
            value = motor[column.name]
            if is_known(value) and column.name not in _DROPPED:
                row[column.name] = str(value) if column.kind == "text" else digits(value, column)
    for column_name, value in measured.items():
        row[column_name] = _rounded(value, columns[column_name])
    return _text(identification, motor, row, sorted(measured), name).encode()


def _rounded(value: float, column: Column) -> str:
    return f"{float(f'{float(from_si(value, column.unit, column.kind)):.5g}'):g}"


def _text(
    identification: Identification, motor: PartRow | None, row: dict[str, str], measured: list[str], name: str
) -> str:
    columns, source = printed("motors"), quoted(f"identified from {identification.log}")
    family = quoted(f"{motor['family'] or motor.part} measured" if motor else row["part"])
    sources = {"log": {"document": source, "confidence": "measured"}}
    table: dict[str, Any] = {
        "family": family, "source": "log", "columns": [columns[n].head for n in row],
        "rows": [[quoted(x) if columns[n].kind == "text" else x for n, x in row.items()]],
    }  # fmt: skip
    pairs = [{"name": "direct drive", "source": "log", "motors": f"[{family}]", "gearheads": "[direct]"}]
    if motor is not None:
        sheet = motor.catalog.sources[motor.table.source[motor.row]]
        sources["sheet"] = {"document": quoted(sheet.document, 200), "confidence": sheet.confidence}
        fields = f"[{', '.join(measured)}]"
        table |= {"source": "sheet",
                  "notes": [{"fields": fields, "text": source, "source": "log", "confidence": "measured"}]}  # fmt: skip
        if listed := [
            f"{{{quoted(motor.catalogue)}: {quoted(partner)}}}" for partner in partners(motor).get("gearheads", {})
        ]:
            across = f"[{', '.join(listed)}]"
            pairs.append(pairs[0] | {"name": "as the data sheet's", "source": "sheet", "gearheads": across})
    maker = quoted(motor["manufacturer"] or "measured") if motor else "measured"
    text = file_text("motors", maker, sources, [table], {"motor_gearhead": pairs})
    parse(YamlSource(text, name), name, "")
    return text
