"""Candidates as the kernel takes them, out of the columns that the search, a record and samples have."""

from __future__ import annotations

import numpy as np

from drivesizer.kernel.records import Drive
from drivesizer.physics.cycle_at_gearhead import ACCELERATION, AT_REST, BRAKING, DIRECTION, DRIVING, SPEED, AtGearhead
from drivesizer.physics.drive_train import COMMUTATION_BAND, commutation
from drivesizer.physics.figures import Alike, Figures
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed
from drivesizer.physics.thermal import COPPER, resistance_at, two_bodies
from drivesizer.physics.winding import Heat

_ERROR = 1e-3  # of what a change within a segment does to the winding at its end


def drives_of(
    ambient: Alike,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    motor: Figures,
    feed: Feed,
    *,
    leads: Alike = 0.0,
    kept: Alike = 0.0,
    limit: Alike = np.nan,
    error: float = _ERROR,
    band: tuple[float, float] = COMMUTATION_BAND,
    cold: bool = False,
) -> Drive:
    """Drives as columns; a winding whose course cannot be computed has to be held at a rise.

    Parameters
    ----------
    ambient
        Temperature around the motors [K].
    cycle
        The load cycle behind their belts; the kernel takes that at the load.
    demand, heating
        Required torque and current, and losses.
    motor
        Figures of the motors by field name.
    feed
        Their power stages and the supply.
    leads
        Resistance that takes of the voltage before the winding [ohm].
    kept
        Share of what is returned that stays on the bus [1].
    limit
        Current of which the time above counts [A].
    error
        Permitted at the end of a segment, as a share of what the change within it does to the winding [1]; a cycle of
        several samples is cut by the time constant of each, another by the shortest.
    band
        Of what commutation takes of the voltage, least and most of ``drive_train.commutation`` [1].
    cold
        Whether the cycle is run once, from the temperature around the motors; else it repeats.

    Returns
    -------
    Drive
        Columns.
    """
    bodies, k_t, belt, e = two_bodies(motor), motor["torque_constant"], np.asarray(cycle.belt), cycle.base.efficiency
    several = cycle.base.load_cycle.speed.shape[2:]
    c, stage = demand.coefficients / np.reshape(k_t, (-1, 1)), feed.stage
    X = commutation(motor) * demand.total_ratio * belt
    with np.errstate(divide="ignore", invalid="ignore"):  # of unknown figures
        C_w, C_h = bodies.capacity_w, bodies.capacity_h
    drive = Drive(
        driving=c[:, DRIVING] / e / belt,
        braking=c[:, BRAKING] * e / belt,
        resting=c[:, AT_REST] / belt,
        accelerating=c[:, ACCELERATION] * belt,
        direction=c[:, DIRECTION],
        turning=c[:, SPEED] * belt,
        emf=demand.back_emf * demand.total_ratio * belt,
        surplus=demand.surplus(k_t) * belt,
        R=resistance_at(bodies.R_25, ambient),
        R_rise=np.asarray(bodies.R_25) * COPPER,
        R_th1=bodies.R_th1,
        R_th2=bodies.R_th2,
        C_w=C_w,
        C_h=C_h,
        friction=heating.friction * belt,
        iron=heating.iron * belt**2,
        permitted=motor["max_winding_temperature"] - ambient,
        course=1.0,
        held=np.nan,
        held_mean=np.nan,
        finest=12.0 * error * np.asarray(bodies.tau_w if several else cycle.base.quickest),
        leads=leads,
        loss=stage.loss,
        least_loss=stage.least_loss,
        R_stage=stage.resistance,
        standby=stage.standby,
        V_0=feed.voltage,
        R_source=feed.resistance,
        drives=float(feed.drives),
        kept=kept,
        limit=limit,
        commutation=band[1] * X,
        least_commutation=band[0] * X,
    )
    if cold:
        drive = drive._replace(winding_start=0.0, housing_start=0.0)
    current = sum(drive[:6])
    known = bodies.known & ~np.isnan(current + heating.friction + heating.iron + ambient)
    shape = np.broadcast_shapes(np.shape(current), several)
    return drive._replace(course=np.broadcast_to(known, shape).astype(float))


def held(drives: Drive, rise: Alike, mean: Alike) -> Drive:
    """Drives with windings at given rises."""
    return drives._replace(course=np.zeros_like(drives.course), held=rise, held_mean=mean)
