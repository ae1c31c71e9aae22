r"""A recording of speed or position and of torque as the load: segments between its samples as they are.

.. math:: T = \frac{T_{rec} + J a}{N}

a is the slope of the speed over each segment, N the drives that share the shaft. Speed and slope come from local
parabolas, least squares through all samples within half the smoothing W of each sample and through three at least
(none of its own at an end: the three nearest). So no difference is taken of differences of two samples.

- A recorded speed is taken as it is; with smoothing, the parabola's value.
- Of a recorded position, the parabola's slope; without smoothing that is the three-point formula.

What the rule costs, for even steps inside the recording: the speed is off by x''' h^2 / 6 with three samples h apart,
by x''' W^2 / 40 with many; a speed that is smoothed is off by v'''' W^4 / 4480. Noise of the standard deviation s in
the position becomes s / h^2 in the acceleration with three samples, and 8.5 s / W^2 with many, however fast they come;
noise in the speed becomes 2.1 s / W. At the ends, where a window has one side only, it is several times that.

Worked example: from standstill to 10 rad/s in 1 s, 1 s at that, 1 s back; the torque rises to 3 N*m with the speed and
falls with it. RMS torque: the root of (9/3 + 9 + 9/3)/3 (N*m)^2, 2.236 N*m; mean power (30/3 + 30 + 30/3)/3 W, 16.67 W;
both however unevenly it was sampled, as long as the corners are samples.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from math import nan
from pathlib import Path
from typing import Any, ClassVar, Literal, Self

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from pydantic import Field

from drivesizer.errors import FieldError, InputError
from drivesizer.files.fields import Axis, Inertia, Pause, default
from drivesizer.files.sheets import columns
from drivesizer.loads.model import SharedLoad
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.physics.motion_curves import local_parabola

Column = NDArray[np.float64]

_FORMS = tuple(
    {"time": "time", name: kind, "torque": "torque"}
    for name, kind in (("speed", "rotary_speed"), ("position", "angle"), ("angle", "angle"))
)
_MOST_ROWS = 10_000_000  # a day at 100 Hz has 8.64 million; of so many rows 90 s of a busy processor and 0.9 GB
_MOST_CUT = 3  # segments that become of one where speed and torque change their sign
_PART = 1 << 15  # segments of a long recording at a time
_ROUNDING = 1e-9  # of the largest speed: less is what sums over windows leave where the load stands


class Recorded(SharedLoad):
    """A recording of speed or position and of torque at the driven shaft."""

    axis: ClassVar[Axis] = "rotary"
    of_shaft: ClassVar[bool] = True
    kind: Literal["recorded"]
    file: str = Field(min_length=1, description="CSV: columns time, speed or position, torque; then a row of units")
    smoothing: Pause = default("0 s", "width of the window in which position or speed is smoothed")
    inertia: Inertia = default("0 kg*m^2", "that turns with the shaft and is not in the torque")

    @property
    def shaft_inertia(self) -> float:
        """Inertia that one drive moves, as far as it is known, at the shaft [kg*m^2]."""
        return self.inertia / self.motors


def recorded(load: Recorded, path: Path) -> LoadCycle:
    """Load cycle of a recording.

    Parameters
    ----------
    load
        The recording's fields.
    path
        The file that they name, from the folder of the spec.

    Returns
    -------
    LoadCycle
        At the shaft of one drive: a segment between each two samples.

    Raises
    ------
    FieldError
        When the smoothing is longer than the recording.
    InputError
        When the file is wrong, or a figure leaves the range of numbers that can be computed with.
    """
    sheet = columns(path, *_FORMS, most=_MOST_ROWS)
    with np.errstate(all="ignore"):  # the load cycle refuses what is not finite
        speed, time, torque = _speed(path, sheet, load.smoothing), sheet["time"], sheet["torque"]
        sheet.clear()
        slices = (slice(k, k + _PART + 1) for k in range(0, len(time) - 1, _PART))
        parts = (_segments(load, time[k], speed[k], torque[k]) for k in slices)
        if len(time) <= _PART + 1:
            return next(parts)
        return _joined(parts, len(time) - 1, jumps=load.inertia != 0.0)


def _segments(load: Recorded, time: Column, speed: Column, torque: Column) -> LoadCycle:
    """A segment between each two samples, cut where speed or torque changes its sign."""
    duration = np.diff(time)
    ends, by_ends = (np.stack([c[:-1], c[1:]], axis=1) for c in (speed, torque))
    acceleration = np.repeat(np.diff(ends, axis=1) / duration[:, None], 2, axis=1)
    at_shaft = (by_ends + load.inertia * acceleration) / load.motors
    inertia = load.inertia / load.motors or nan
    return LoadCycle(load.file, duration, ends, acceleration, at_shaft, inertia).split()


def _joined(parts: Iterable[LoadCycle], segments: int, *, jumps: bool) -> LoadCycle:
    """One cycle of consecutive parts of a long one; ``jumps``: the torque is not at both sides of a sample the same.

    The speed is, and the acceleration is one over each segment: what is there once takes half the room.
    """
    most = _MOST_CUT * segments  # what is not written takes no memory
    duration, speed, acceleration, torque = np.empty((4, most + 1))
    ends, end = np.empty((most if jumps else 0, 2)), 0
    for part in parts:
        first, end = end, end + len(part.duration)
        duration[first:end], acceleration[first:end] = part.duration, part.acceleration[:, 0]
        speed[first:end], speed[end] = part.speed[:, 0], part.speed[-1, 1]
        torque[first:end], torque[end] = part.torque[:, 0], part.torque[-1, 1]
        if jumps:
            ends[first:end] = part.torque
    accelerations = np.broadcast_to(acceleration[:end, None], (end, 2))
    torques = ends[:end] if jumps else sliding_window_view(torque[: end + 1], 2)
    return replace(part, duration=duration[:end], speed=sliding_window_view(speed[: end + 1], 2),
                   acceleration=accelerations, torque=torques)  # fmt: skip


def _speed(path: Path, sheet: dict[str, Column], smoothing: float) -> Column:
    """The speed at each sample [rad/s]."""
    time, name = sheet["time"] - sheet["time"][0], list(sheet)[1]
    fitted = name != "speed" or smoothing > 0.0
    if fitted and len(time) < 3:
        raise InputError(f"{path}: rows: {len(time)} found; expected at least 3, to take a slope of or to smooth")
    if smoothing > time[-1]:
        raise FieldError(("load", "smoothing"), f"{smoothing:g} s is longer than the recording, {time[-1]:g} s")
    speed = sheet[name]
    if fitted:
        value, slope = local_parabola(time, speed, smoothing)
        speed = value if name == "speed" else slope
        speed = np.where(np.abs(speed) <= _ROUNDING * np.abs(speed).max(), 0.0, speed)
    return speed


# -- A load that comes with its load cycle: computed of a whole machine, not recorded.


class ComputedLoad(Recorded):
    """A load of kind recorded that has its cycle already."""

    cycle: Any  # a LoadCycle, of its shaft

    @classmethod
    def with_cycle(cls, cycle: LoadCycle, motors: int = 1, **more: Any) -> Self:
        """The load that a cycle of one drive is of, so many drives sharing it equally."""
        return cls.model_construct(
            kind="recorded", file=cycle.name, smoothing=0.0, inertia=0.0, cycle=cycle, motors=motors, **more
        )

    @property
    def shaft_inertia(self) -> float:
        """Of all that one drive moves, at its shaft [kg*m^2]."""
        return float(self.cycle.inertia)
