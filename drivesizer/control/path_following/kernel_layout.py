"""Layout of the arrays of the compiled simulation of a platform.

``W`` has a row per wheel, ``K`` one per caster, ``B`` platform and floor; ``M`` and ``C`` are inertia and Coriolis
matrix without the wheels. ``y`` is the state (posture, velocity, wheel speeds, work and losses), ``w`` the figures of
each wheel at a state, ``f`` generalised forces, ``power`` powers and losses. ``G`` holds gains and limit of each
wheel's controller, ``E`` maps the platform's velocity to wheel speeds, ``P`` are the figures of the pose loop. ``A``
and ``s`` are the platform's matrix and the stages of a step, ``z`` pose errors, their integrals, the velocity command
and torques.
"""

from __future__ import annotations

from drivesizer.platform.matrix_equation import Array

__all__ = ["Array"]

GAMMA = 1.0 - 0.5**0.5  # of the Rosenbrock step: order 2 and L-stable
FASTEST = 1e6  # m/s and rad/s: faster diverges

# a wheel: rows of slip (AX, AY, AT | -RA) and of the roller, or sideways, (BX, BY, BT | RB) over velocity | wheel
# speed; resistances; kind (0 motor, 1 free, 2 blocked); load N0 - height * (SX, SY) . floor's force; torque over
# torque command
AX, AY, AT, BX, BY, BT, RA, RB, R, J, CW, CR, FW, HELD, KIND, N0, SX, SY, STRENGTH = range(19)
COLUMNS = 19

# a wheel at a state: forces along and across and their slopes, over the load; slip and roller speed; load;
# slope of its resistance to turning; its column of the linear equations
FA, FB, DAA, DAB, DBB, SLIP, RHO, LOAD, DW, BOTTOM, SIDE = range(11)
WORK = SIDE + 3

# a caster, and its force and slope over the load
CASTER_X, CASTER_Y, CASTER_RR, CASTER_N0, CASTER_SX, CASTER_SY, CASTER_FX, CASTER_FY, CASTER_K = range(9)
CASTER_COLUMNS = 9

# platform and floor
PX, PY, WEIGHT, PULL, UPHILL, HEIGHT, FRICTION, SLIP_SPEED, CREEP, TURNROUND = range(10)

POSE = 3  # entries of the state before the velocities: x, y, heading
# after them: work of motors and weight; losses
INPUT, LOST_SLIP, LOST_WHEEL, LOST_ROLLER, LOST_CASTER = range(5)
TALLIES = 5

# pose feedback: law (0 none, 1 of three freedoms, 2 of a unicycle), periods between poses, gains
LAW, EVERY, K_P, K_I, K_X, K_Y, APERIODIC = range(7)
