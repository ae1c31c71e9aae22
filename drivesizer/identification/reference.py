"""A drive as it is known before its log: a motor's data sheet, or a spec with its drive."""

from __future__ import annotations

from drivesizer.catalog.query import Hit
from drivesizer.control.drive_train import drive_train, mechanics
from drivesizer.identification.identify import Reference
from drivesizer.physics.drive_train import back_emf_constant
from drivesizer.physics.figures import Figures
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.robot import RobotSpec

_PERIOD = 1e-3  # s, of the controller: of a train whose inductance is unknown


def of_motor(hit: Hit, ratio: float = 1.0) -> Reference:
    """A motor by its data sheet.

    Parameters
    ----------
    hit
        The motor.
    ratio
        Of gears before a torque that was logged.

    Returns
    -------
    Reference
        Its printed figures.
    """
    columns: Figures = {name: hit.table[name][hit.row : hit.row + 1] for name in hit.table.columns}
    return Reference(label=hit.part, ratio=ratio, figures={
        "R": hit["resistance"], "L": hit["inductance"], "k_t": hit["torque_constant"],
        "k_e": float(back_emf_constant(columns)[0]), "J": hit["rotor_inertia"],
    })  # fmt: skip


def of_drive(spec: RobotSpec, drive: DriveSet) -> Reference:
    """A spec with its drive: figures of the motor, gears, and the weight that pulls at rest.

    Parameters
    ----------
    spec, drive
        The machine and its drive.

    Returns
    -------
    Reference
        The load's inertia and friction are not in it: they are to be found.

    Raises
    ------
    NoLoopError
        When the catalogue lacks a figure without which nothing can be simulated.
    """
    train, _ = drive_train(spec, drive, _PERIOD)
    rigid, _ = mechanics(spec, drive)
    return Reference(
        label=drive.label, ratio=rigid.ratio, gear_ratio=rigid.gear_ratio, per_speed=rigid.motor_per_speed,
        weight=rigid.rest_torque,
        figures={"R": train.resistance, "L": train.inductance, "k_t": train.torque_constant,
                 "k_e": train.back_emf_constant, "J": rigid.motor_inertia, "e": rigid.efficiency},
    )  # fmt: skip
