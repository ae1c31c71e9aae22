"""The kernel against SciPy's integrators, closed forms, fine sampling, and the same code as plain Python."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from drivesizer.kernel.cycle import ACCOUNT, ENERGY, HEAT
from drivesizer.kernel.evaluate import evaluate, pieces
from drivesizer.kernel.heat import Law, added, change_of, periodic, phi_2, spread, top_within
from drivesizer.kernel.records import Drive, Figures

DRIVE = Drive(
    driving=0.61, braking=0.43, resting=0.52, accelerating=0.013, direction=0.17, turning=0.021, emf=0.83,
    surplus=0.04, R=1.3, R_rise=0.0051, R_th1=2.7, R_th2=6.1, C_w=3.3, C_h=29.0, friction=0.21, iron=0.017,
    permitted=120.0, course=1.0, rise=math.nan, mean_rise=math.nan, finest=0.004, leads=0.0, loss=0.7,
    least_loss=0.35, R_stage=0.11, standby=1.7, V_0=24.0, R_source=0.31, drives=2.0, bus_share=0.6, limit=2.2,
    commutation=0.09, least_commutation=0.03,
)  # fmt: skip


def cycle(seed=1, count=9, longest=3.0):
    """Segments whose speed, and torque, has one sign each; a rest and a steady run among them."""
    rng = np.random.default_rng(seed)
    way = np.sign(rng.normal(size=count))[:, None]
    speed, torque = way * rng.uniform(0.3, 6.0, (count, 2)), rng.uniform(0.2, 5.0, (count, 2))
    torque *= np.sign(rng.normal(size=count))[:, None]
    speed[2], speed[4, 1], torque[4, 1] = 0.0, speed[4, 0], torque[4, 0]
    acceleration = np.where(speed == 0.0, 0.0, rng.normal(size=(count, 2)))
    acceleration[4, 1] = acceleration[4, 0]
    return SimpleNamespace(
        duration=rng.uniform(0.2, longest, count), speed=speed, acceleration=acceleration, torque=torque
    )


def flows(d, c):
    """Time, and functions of it: current and speed, segment by segment, by the definition."""
    found, start = [], 0.0
    for t, w, a, T in zip(c.duration, c.speed, c.acceleration, c.torque, strict=True):
        at_rest, drives = not w.any(), T.sum() * w.sum() > 0.0
        per = d.resting if at_rest else d.driving if drives else d.braking
        I = per * T + d.accelerating * a + d.direction * np.sign(w.sum()) + d.turning * w
        found.append((start, t, I, w))
        start += t
    return found


def line(ends, x):
    return ends[0] + x * (ends[1] - ends[0])


def warmed(d, c, cycles=40):
    """Winding and housing by SciPy's integrator until they come back; segment by segment of the last cycle."""
    state, kept = np.zeros(2), []
    for n in range(cycles):
        for _, t, I, w in flows(d, c):

            def slope(x, rises, t=t, I=I, w=w):
                i, v = line(I, x / t), abs(line(w, x / t))
                through = (rises[0] - rises[1]) / d.R_th1
                copper = (d.R + d.R_rise * rises[0]) * i * i
                loss = d.friction * v + d.iron * v * v
                return [(copper - through) / d.C_w, (loss + through - rises[1] / d.R_th2) / d.C_h]

            last = n == cycles - 1
            done = solve_ivp(slope, (0.0, t), state, rtol=1e-10, atol=1e-9, dense_output=last)
            state = done.y[:, -1]
            if last:
                kept.append(done.sol)
    return state, kept


def powers(d, i, w, rise):
    """Power into motor and stage, by the printed formulas."""
    motor = (d.emf * w + (d.R + d.R_rise * rise) * i) * i + max(0.0, -2.0 * d.surplus * w * i)
    return motor, motor + d.loss * abs(i) + d.R_stage * i * i


@pytest.fixture(scope="module", params=[1, 2, 3])
def simulated(request):
    c = cycle(request.param)
    slow = DRIVE._replace(C_h=6.0, R_th2=2.1)  # so that few cycles settle
    return slow, c, *warmed(slow, c)


def test_heat_voltage_and_energy_are_those_of_an_integrator(simulated):
    """Pieces so fine that the mean of each does: to a share of what they change."""
    d, c, settled, course = simulated
    fine = d._replace(finest=1e-4)
    found = Figures(*(float(x) for x in evaluate(fine, c, ACCOUNT)))
    assert found.winding_start == pytest.approx(settled[0], rel=1e-4)
    assert found.housing_start == pytest.approx(settled[1], rel=1e-4)
    x, volts, least, most, rises = np.linspace(0.0, 1.0, 801), [], [], [], []
    drawn = returned = heat = motor = copper = unlike = square = 0.0
    for (_, t, I, w), sol in zip(flows(d, c), course, strict=True):
        i, v, rise = line(I, x), line(w, x), sol(x * t)[0]
        own, driving = np.abs(d.emf * v + (d.R + d.R_rise * rise) * i), np.maximum(i * v, 0.0)
        volts.append((own + d.commutation * driving).max())
        least.append((own + d.least_commutation * driving).max())
        rises.append(rise.max())
        each = [powers(d, *point) for point in zip(i, v, rise, strict=True)]
        most.append(max(one for _, one in each))

        def taken(y, of, t=t, I=I, w=w, sol=sol):
            return of(*powers(d, line(I, y), line(w, y), sol(y * t)[0]))

        def resisted(_, inner):
            power = max(inner, 0.0) + d.standby
            current = 2 * power * d.drives / (d.V_0 + math.sqrt(d.V_0**2 - 4 * d.R_source * power * d.drives))
            return (d.V_0 * current / d.drives - power) * (inner > 0.0) + (inner <= 0.0) * (
                d.V_0 * current / d.drives - power
            )

        def whole(of):
            return t * quad(taken, 0.0, 1.0, (of,), limit=400, epsabs=1e-7)[0]  # noqa: B023

        drawn += whole(lambda _, inner: max(inner, 0.0))
        returned += whole(lambda _, inner: max(-inner, 0.0))
        heat += whole(resisted)
        motor += whole(lambda own, _: own)
        copper += t * np.trapezoid((d.R + d.R_rise * rise) * i * i, x)
        unlike += t * np.trapezoid(np.abs(d.surplus * v * i), x)
        square += t * np.trapezoid(i * i, x)
    total = c.duration.sum()
    assert found.winding == pytest.approx(max(rises), rel=1e-3)
    assert found.voltage == pytest.approx(max(volts), rel=1e-4)
    assert found.least_voltage == pytest.approx(max(least), rel=1e-4)
    assert found.power == pytest.approx(max(most), rel=1e-4)
    assert (found.drawn, found.returned) == (pytest.approx(drawn, rel=1e-4), pytest.approx(returned, rel=1e-4))
    assert found.source_heat == pytest.approx(heat, rel=1e-3)
    assert found.motor == pytest.approx(motor, rel=2e-4)
    assert found.copper == pytest.approx(copper / total, rel=1e-4)
    assert found.unlike == pytest.approx(unlike, rel=1e-4)
    assert found.I_rms == pytest.approx(math.sqrt(square / total), rel=1e-4)


def test_times_above_and_what_is_stored_are_those_of_fine_steps():
    """Of a winding that is held; the cycle comes twice."""
    for seed in range(1, 9):
        c, d = cycle(seed), DRIVE._replace(course=0.0, rise=31.0, mean_rise=31.0)
        found = evaluate(d, c, ENERGY)
        store = lowest = risen = now = longest = 0.0
        for _ in range(2):
            for _, t, I, w in flows(d, c):
                x = (np.arange(4000) + 0.5) / 4000
                for i, v in zip(line(I, x), line(w, x), strict=True):
                    power = powers(d._replace(loss=d.least_loss), i, v, 31.0)[1]
                    store += (-power * d.bus_share if power < 0.0 else -power) * t / 4000
                    lowest = min(lowest, store)
                    risen = max(risen, store - lowest)
                    now = now + t / 4000 if abs(i) > d.limit else 0.0
                    longest = max(longest, now)
        assert float(found.above) == pytest.approx(min(longest, c.duration.sum()), abs=3e-3)
        if math.isfinite(float(found.stored)):
            assert float(found.stored) == pytest.approx(risen, rel=2e-3, abs=2e-3)
        else:
            assert store > 0.0


def test_a_constant_current_settles_where_the_handbook_says():
    """R_th R I^2 / (1 - R_th R' I^2), with a loss at the housing besides."""
    c = SimpleNamespace(duration=np.array([7.0]), speed=np.full((1, 2), 3.0), acceleration=np.zeros((1, 2)),
                        torque=np.full((1, 2), 2.5))  # fmt: skip
    I = DRIVE.driving * 2.5 + DRIVE.direction + DRIVE.turning * 3.0
    loss = DRIVE.friction * 3.0 + DRIVE.iron * 9.0
    R_th = DRIVE.R_th1 + DRIVE.R_th2
    rise = (R_th * DRIVE.R * I**2 + DRIVE.R_th2 * loss) / (1.0 - R_th * DRIVE.R_rise * I**2)
    found = evaluate(DRIVE, c, HEAT)
    assert (float(found.winding), float(found.winding_mean)) == (pytest.approx(rise), pytest.approx(rise))
    volts = DRIVE.emf * 3.0 + (DRIVE.R + DRIVE.R_rise * rise) * I
    assert float(found.voltage) == pytest.approx(volts + DRIVE.commutation * I * 3.0)
    assert np.isnan(found.power) and np.isnan(found.drawn) and np.isnan(found.above)


def test_a_winding_that_runs_away_is_held_at_its_permitted_rise():
    hot = DRIVE._replace(R_th2=600.0)
    found, held = evaluate(hot, cycle(), ENERGY), DRIVE._replace(course=0.0, rise=120.0, mean_rise=120.0)
    other = evaluate(held, cycle(), ENERGY)
    assert np.isinf(found.winding) and np.isnan(other.winding)
    for name in ("voltage", "copper", "power", "drawn", "returned", "stored"):
        assert float(getattr(found, name)) == float(getattr(other, name))


@pytest.mark.parametrize(
    ("t", "square"), [*((t, I2) for t in (1e-6, 1e-3, 0.3, 5.0, 400.0) for I2 in (0.0, 4.0, 60.0)), (1e5, 0.0)]
)
def test_a_step_is_that_of_the_matrix_exponential(t, square):
    """Against it in many digits, by squaring a short step."""
    law = Law(0.0155 * square - 0.11, 0.11, 0.013, -0.018, 0.4 * square, 0.07)
    A, b, x = np.array([law[:2], law[2:4]]), np.array(law[4:]), np.array([3.0, 1.0])
    n = max(int(np.ceil(np.log2(np.abs(A).sum() * t))), 0) + 6
    M = np.zeros((3, 3), np.longdouble)
    M[:2, :2], M[:2, 2] = A * (t / 2**n), b * (t / 2**n)
    P, term = np.zeros_like(M), np.eye(3, dtype=np.longdouble)
    for k in range(1, 25):
        term = term @ M / k
        P = P + term
    for _ in range(n):
        P = 2 * P + P @ P  # the exponential less one
    w, h, _ = P @ np.array([*x, 1.0], np.longdouble)
    more_w, more_h, _ = added(law, spread(law, t), t, *x)
    assert (more_w, more_h) == (pytest.approx(float(w), rel=1e-10), pytest.approx(float(h), rel=1e-10))
    change = change_of(law, spread(law, t), t)
    assert change == pytest.approx([float(v) for v in (*P[0, :2], *P[1, :2], P[0, 2], P[1, 2])], rel=1e-9, abs=1e-12)


def test_functions_of_the_exponent_meet_where_the_series_ends():
    for x in (-0.5, 0.5):
        assert phi_2(math.nextafter(x, 0.0)) == pytest.approx(phi_2(math.nextafter(x, 2 * x)), rel=1e-14)
    law = Law(-0.02, 0.012, 0.003, -0.005, 0.0, 0.0)  # sum of amounts 0.04: 1.5 s and 0.1 s are the series' ends
    for t in (1.5, 0.1):
        assert spread(law, t * (1 - 1e-12)) == pytest.approx(spread(law, t * (1 + 1e-12)), rel=1e-10)


def test_the_top_within_a_piece_is_where_it_turns():
    law = Law(-0.11, 0.11, 0.013, -0.018, 0.35, 0.0)
    w, h = 2.0, 60.0  # the housing warms the winding, and cools
    top, when = top_within(law, 900.0, w, h)
    times = np.linspace(0.0, 900.0, 100_001)
    course = [w + added(law, spread(law, t), t, w, h)[0] for t in times]
    assert max(course) <= top * (1 + 1e-14) and top == pytest.approx(max(course), rel=1e-8)
    assert when == pytest.approx(times[np.argmax(course)], abs=0.02)


def test_a_winding_that_settles_from_above_had_its_top_before():
    """Rests so long that nothing moves at the end: the housing's heat comes, and goes while the winding settles."""
    law = Law(-0.03, 0.03, 0.002, -0.006, 0.17, 0.0)
    top, when = top_within(law, 1e4, 2.0, 40.0)
    course = [2.0 + added(law, spread(law, t), t, 2.0, 40.0)[0] for t in np.linspace(1.0, 1e4, 40_000)]
    assert top == pytest.approx(max(course), rel=1e-6) and 0.0 < when < 1e3 and top > course[-1] + 1.0
    c = SimpleNamespace(duration=np.array([40.0, 1e4]), speed=np.array([[6.0, 6.0], [0.0, 0.0]]),
                        acceleration=np.zeros((2, 2)), torque=np.array([[1.0, 1.0], [0.4, 0.4]]))  # fmt: skip
    found = evaluate(DRIVE._replace(C_w=12.0, friction=9.0), c, HEAT)
    settled = (DRIVE.R_th1 + DRIVE.R_th2) * DRIVE.R * (0.4 * DRIVE.resting) ** 2
    assert float(found.winding_start) == pytest.approx(settled, rel=5e-3)
    assert float(found.winding_time) > 40.0


def test_a_cycle_comes_back_to_its_start():
    law = Law(-0.11, 0.11, 0.013, -0.018, 0.35, 0.4)
    w, h = periodic(change_of(law, spread(law, 0.01), 0.01))
    assert added(law, spread(law, 0.01), 0.01, w, h)[:2] == pytest.approx((0.0, 0.0), abs=1e-12)


def test_samples_have_cycles_of_their_own():
    """Two drives and three samples at once, and one by one; columns that neighbours share, or are there once."""
    several = [cycle(seed) for seed in (4, 5, 6)]
    side = SimpleNamespace(**{n: np.stack([getattr(c, n) for c in several], axis=-1) for n in vars(several[0])})
    drives = DRIVE._replace(R=np.array([[1.3], [0.9]]), emf=np.array([[0.83, 0.8, 0.77]]))
    found = evaluate(drives, side, ENERGY)
    for n, m in np.ndindex(2, 3):
        one = evaluate(DRIVE._replace(R=drives.R[n, 0], emf=drives.emf[0, m]), several[m], ENERGY)
        for name, whole, single in zip(Figures._fields, found, one, strict=True):
            assert np.array_equal(whole[n, m], single, equal_nan=True), name
    points, load = np.linspace(1.0, 2.0, 10), np.broadcast_to(np.array([[1.5]]), (9, 2))
    shared = np.lib.stride_tricks.sliding_window_view(points, 2)
    lean = SimpleNamespace(duration=np.full(9, 0.4), speed=shared, acceleration=load, torque=load)
    full = SimpleNamespace(**{name: np.array(column) for name, column in vars(lean).items()})
    assert np.array_equal(evaluate(DRIVE, lean, ENERGY), evaluate(DRIVE, full, ENERGY), equal_nan=True)


@pytest.mark.parametrize("cuts", [0, 1, 3])
def test_pieces_add_up_to_the_figures(cuts):
    figures, course = pieces(DRIVE, c := cycle(7), cuts)
    whole = evaluate(DRIVE, c, ENERGY)
    for name in ("drawn", "returned", "source_heat"):
        assert float(getattr(course, name).sum()) == pytest.approx(float(getattr(whole, name)), rel=1e-12)
        assert float(getattr(figures, name)[0]) == pytest.approx(float(getattr(whole, name)), rel=1e-12)
    assert course.duration.sum() == pytest.approx(c.duration.sum(), rel=1e-12)
    assert course.most.max() == pytest.approx(float(whole.power), rel=1e-12) and course.least.min() < 0.0
    assert (course.motor_drawn - course.motor_returned).sum() == pytest.approx(float(figures.motor[0]), rel=1e-12)
    silent = course.returned == 0.0
    assert (silent[1:] & silent[:-1]).any() == (cuts != 0)
