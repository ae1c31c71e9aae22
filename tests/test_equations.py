"""Equations (1)-(20): worked by hand, held to laws, refused with wrong units; and their declarations."""

import dataclasses
import inspect
import math
from functools import partial

import numpy as np
import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refusal

from drivesizer import equations as eq
from drivesizer.errors import InputError
from drivesizer.output import derivation
from drivesizer.physics.equation import COMPANIONS, EQUATIONS

U = pint.UnitRegistry()  # a user's own registry, not ours
EVERY = [*EQUATIONS.values(), *COMPANIONS.values()]
positive = st.floats(1e-3, 1e3)


# Worked by hand with a pocket calculator from the printed forms; half of the last digit is the tolerance.
@pytest.mark.parametrize(
    ("got", "by_hand", "half_digit"),
    [
        pytest.param(
            eq.nominal_speed(1.5, 0.1524, 0.9) * 30 / math.pi, 208.865, 5e-4, id="(1): 60*1.5/(pi*0.1524*0.9) rpm"
        ),
        pytest.param(eq.nominal_torque(0.1524, 8.829, 0.95), 0.7082, 5e-5, id="(2): 0.0762*8.829/0.95"),
        pytest.param(eq.nominal_force(0.02, 45.0, 9.81), 8.829, 5e-4, id="(3): 0.02*45*9.81"),
        pytest.param(eq.nominal_force(0.02, 45.0, 9.81, math.radians(5.0)), 47.2703, 5e-5, id="(3) on 5 degrees"),
        pytest.param(eq.rolling_resistance_coefficient(0.00006, 0.15), 0.02, 5e-6, id="(4): sqrt(0.0004)"),
        pytest.param(eq.nominal_torque_per_motor(0.708, 4), 0.177, 5e-4, id="(5)"),
        pytest.param(eq.acceleration(1.5, 2.0), 0.75, 5e-3, id="(6)"),
        pytest.param(
            eq.nominal_power_per_motor(1.2, 45, 1.5, 0.75, 9.81, 0.0, 0.9, 4), 2.6857, 5e-5, id="(7): 60.75/22.6195"
        ),
        pytest.param(eq.cylinder_mass(1100, 0.0762, 0.03, 0.05), 0.84777, 5e-6, id="(8)"),
        pytest.param(eq.cylinder_inertia(0.8478, 0.0762, 0.03), 0.0028428, 5e-7, id="(9)"),
        pytest.param(
            eq.acceleration_torque(4, 0.0028, 1e-6, 2e-6, 45, 0.9, 0.1524, 0.75, 1.2), 3.5614, 5e-5, id="(10)"
        ),
        pytest.param(eq.maximum_torque_per_motor(4.4, 4), 1.1, 5e-2, id="(11)"),
        pytest.param(eq.deceleration_torque(0.7, 3.5), -2.8, 5e-2, id="(12)"),
        pytest.param(eq.rms_torque(2, 4.0, 10, 1.0, 2, -2.0, 6, 0.0), math.sqrt(2.5), 1e-12, id="(13): (32+10+8)/20"),
        pytest.param(eq.rms_torque_per_motor(0.84, 4), 0.21, 5e-3, id="(14)"),
        pytest.param(eq.maximum_power_per_motor(1.068, 21.872), 23.359, 5e-4, id="(15)"),
        pytest.param(eq.rms_speed(3.0, 3, 4, 3, 0), 3 * math.sqrt(0.6), 1e-12, id="n_rms: (1+4+1)/10"),
        pytest.param(eq.rms_power_per_motor(0.2, 21.0), 4.2, 5e-2, id="(16)"),
        pytest.param(eq.rms_torque_at_motor(0.21, 26.85, 0.8), 0.0097765, 5e-8, id="(17) as printed"),
        pytest.param(eq.rms_torque_at_motor(0.21, 26.85, 0.8, 1.1, 0.95), 0.0093555, 5e-8, id="(17) with the belt"),
        pytest.param(eq.maximum_torque_at_motor(1.07, 26.85, 0.8, 1.1, 0.95), 0.047669, 5e-7, id="(18) with the belt"),
        pytest.param(eq.speed_constant(8097.0, 24.0), 337.375, 5e-4, id="(19)"),
        pytest.param(eq.no_load_speed(208.865, 29.536, 40.5, 47.57), 8095.6, 0.05, id="(20) in rpm and mN*m"),
    ],
)
def test_by_hand(got, by_hand, half_digit):
    assert got == pytest.approx(by_hand, abs=half_digit)


@given(positive, positive, positive, st.floats(0.1, 0.99))
def test_acceleration_torque_is_the_work_to_reach_the_speed(m, d, a, eta):
    """Without inertias, factor 1: torque times angle equals kinetic energy over the efficiency."""
    t = 3.7
    v, angle = a * t, a * t**2 / 2 / (d / 2)
    torque = eq.acceleration_torque(4, 0.0, 0.0, 0.0, m, eta, d, a, 1.0)
    assert torque * angle == pytest.approx(m * v**2 / 2 / eta, rel=1e-12)


@given(positive, positive, positive, st.floats(0.0, 0.9))
def test_cylinder_inertia_is_the_integral_of_r_squared(rho, r_a, h, share):
    r = np.linspace(share * r_a, r_a, 4001)
    shells = np.trapezoid(rho * 2 * math.pi * h * r**3, r)
    m = eq.cylinder_mass(rho, r_a, share * r_a, h)
    assert eq.cylinder_inertia(m, r_a, share * r_a) == pytest.approx(shells, rel=1e-5)


@given(positive, st.floats(1.1, 300), st.floats(0.3, 0.99), st.floats(1.1, 9), st.floats(0.3, 0.99))
def test_power_at_the_motor_exceeds_the_wheels_by_the_losses(M, K, eta, i, eta_b):
    at_motor = eq.maximum_torque_at_motor(M, K, eta, i, eta_b)
    assert at_motor * K * i * eta * eta_b == pytest.approx(M)


@given(st.lists(positive, min_size=4, max_size=4), st.lists(st.floats(-50, 50), min_size=4, max_size=4))
def test_rms_lies_between_mean_and_peak(times, torques):
    pairs = [x for pair in zip(times, torques, strict=True) for x in pair]
    rms = eq.rms_torque(*pairs)
    assert abs(np.average(torques, weights=times)) - 1e-9 <= rms <= max(map(abs, torques)) + 1e-9


@given(positive, positive, positive, positive, st.floats(0, 1e3))
def test_rms_speed_against_a_sampled_trapezoid(n, t_acc, t_nom, t_dec, t_rest):
    total = t_acc + t_nom + t_dec + t_rest
    t = (np.arange(200_000) + 0.5) / 200_000 * total
    speed = np.interp(t, [0, t_acc, t_acc + t_nom, t_acc + t_nom + t_dec], [0, n, n, 0])
    speed[t > total - t_rest] = 0.0
    sampled = math.sqrt(np.mean(speed**2))
    assert eq.rms_speed(n, t_acc, t_nom, t_dec, t_rest) == pytest.approx(sampled, rel=1e-2, abs=n * 3e-3)


@pytest.mark.parametrize("declared", EVERY, ids=lambda e: e.name)
def test_quantities_in_any_unit_give_what_floats_give(declared):
    others = {"m": "inch", "kg": "lb", "m/s": "ft/s", "N*m": "ozf*inch", "N": "lbf", "s": "min", "rad/s": "rpm",
              "kg*m^2": "g*cm^2", "m/s^2": "ft/s^2", "kg/m^3": "g/cm^3", "V": "mV", "rad": "deg",
              "rad/s/(N*m)": "rpm/(mN*m)"}  # fmt: skip
    plain = {term.name: 0.3 + 0.07 * k for k, term in enumerate(declared.terms)}
    given = {
        t.name: U.Quantity(plain[t.name], t.unit).to(others[t.unit]) if t.unit != "1" else plain[t.name]
        for t in declared.terms
    }
    if all(t.unit == "1" for t in declared.terms):
        return
    result = declared(**given)
    assert result.check(declared.result.unit if declared.result.unit != "1" else "")
    assert result.magnitude == pytest.approx(declared(**plain), rel=1e-12)


@pytest.mark.parametrize("declared", EVERY, ids=lambda e: e.name)
def test_a_wrong_dimension_is_refused_by_name(declared):
    for wrong in (t for t in declared.terms if t.unit != "1"):
        given = {t.name: U.Quantity(0.9, t.unit if t.unit != "1" else "") for t in declared.terms}
        given[wrong.name] = U.Quantity(0.9, f"({wrong.unit})*m*kg")
        with pytest.raises(InputError, match=rf"{wrong.name} \("):
            declared(**given)
        given[wrong.name] = 0.9
        if len(declared.terms) > 1 and any(hasattr(v, "check") and not v.unitless for v in given.values()):
            with pytest.raises(InputError, match="without a unit"):
                declared(**given)


def test_what_counts_no_angle_is_no_rotary_speed():
    """1 N·m at one turn a second is 2π W; at 1 Hz it is nothing, for pint takes 1 Hz as 1 rad/s."""
    torque = U.Quantity(1.0, "N*m")
    for unit in ("turn/s", "revolution/s", "rpm * 60"):
        assert eq.maximum_power_per_motor(torque, U.Quantity(f"1 {unit}")).to("W").magnitude == pytest.approx(
            2 * math.pi
        )
    with pytest.raises(
        InputError, match=r"^equation \(15\): n_nom \(.*\) must be in rad/s, e\.g\. 3000 rpm; got 1.* Hz, a unit "
    ):
        eq.maximum_power_per_motor(torque, U.Quantity(1.0, "Hz"))
    with pytest.raises(InputError, match=r"got 1.* 1/s, which has no angle in it"):
        eq.maximum_power_per_motor(torque, 1.0 / U.Quantity(1.0, "s"))
    with pytest.raises(InputError, match=r"got 1.* J, a unit of energy"):
        eq.maximum_power_per_motor(U.Quantity(1.0, "J"), U.Quantity(1.0, "turn/s"))
    with pytest.raises(InputError, match="a plain number; got 90 deg, a unit of angle"):
        eq.nominal_speed(U.Quantity(1.5, "m/s"), U.Quantity(6.0, "inch"), U.Quantity(90, "deg"))
    by_power = U.Quantity(12.0, "W") / U.Quantity(3.0, "rad/s")  # a torque of 4 N·m
    assert eq.maximum_power_per_motor(by_power, U.Quantity(5.0, "rad/s")).to("W").magnitude == pytest.approx(20.0)


NO_NUMBERS = ["1.5 m/s", "", None, True, [1.5, 2.5], 1 + 2j, {}, np.array(["1.5"]), U]
NOT_FINITE = [math.nan, -math.inf, 10**400]


@pytest.mark.parametrize("declared", EVERY, ids=lambda e: e.name)
def test_each_argument_that_is_no_figure_is_refused_in_one_line(declared):
    """Equation, argument, what was given, what is expected; beside numbers, arrays and quantities alike."""
    quantities = {t.name: U.Quantity(0.9, t.unit) if t.unit != "1" else 0.9 for t in declared.terms}
    single, columns = dict.fromkeys(quantities, 0.9), dict.fromkeys(quantities, np.array([0.4, 1.7]))
    for others in (single, columns, quantities):
        for term in declared.terms:
            for wrong in NO_NUMBERS + NOT_FINITE * (others is not columns):  # there NaN is unknown
                line = refusal(partial(declared, **others | {term.name: wrong}))
                assert line.startswith(f"{declared.label}: {term.name} ({term.meaning}) must be "), line
                assert "; got " in line and len(line) < 260
        missing = dict(list(others.items())[1:])
        for call in (lambda m=missing: declared(**m), lambda o=others: declared(**o, other=2.0)):
            with pytest.raises(InputError, match=rf"argument.*; expected .*{declared.terms[0].name} \["):
                call()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("declared", EVERY, ids=lambda e: e.name)
def test_zeros_and_figures_below_zero_give_a_figure_or_one_line(declared):
    for value in (0.0, 0, -0.7, 1e308, 5e-324):
        for term in declared.terms:
            plain = dict.fromkeys((t.name for t in declared.terms), 0.8) | {term.name: value}
            united = {
                t.name: U.Quantity(plain[t.name], t.unit) if t.unit != "1" else plain[t.name] for t in declared.terms
            }
            for figures in (plain, united):
                try:
                    found = declared(**figures)
                except InputError as error:
                    assert str(error).startswith(declared.label) and "\n" not in str(error)
                    assert f"{term.name} ({term.meaning})" in str(error) or abs(value) in (1e308, 5e-324)
                else:
                    assert math.isfinite(getattr(found, "magnitude", found))


def test_a_factor_of_zero_is_named():
    with pytest.raises(
        InputError, match=r"^equation \(1\) has no value where eta_speed \(.*\) is 0; expected more than 0$"
    ):
        eq.nominal_speed(1.5, 0.1524, 0.0)
    with pytest.raises(InputError, match=r"where d \(wheel diameter\) is 0 and eta_speed"):
        eq.nominal_speed(1.5, 0, U.Quantity(0, "percent").magnitude)
    with pytest.raises(InputError, match=r"t_acc .* is 0 and t_nom .* is 0 and t_dec .* is 0 and t_rest .* is 0"):
        eq.rms_torque(0, 4.0, 0, 1.0, 0, -2.0, 0, 0.0)
    with pytest.raises(
        InputError, match=r"^equation \(4\): z \(sinking depth\) must be in m, .* got -0\.001, below 0$"
    ):
        eq.rolling_resistance_coefficient(-0.001, 0.15)
    with pytest.raises(InputError, match="of one length"):
        eq.nominal_torque(np.ones(2), np.ones(3), 0.9)


def test_pint_finds_the_unit_of_the_result_and_none_is_attached():
    """A power declared as a force is found out, by pint's own error: a fault of the program, not of its user."""
    wrong = dataclasses.replace(EQUATIONS[15], result=EQUATIONS[3].result)
    with pytest.raises(pint.DimensionalityError):
        wrong(U.Quantity(1.0, "N*m"), U.Quantity(60.0, "rpm"))


@pytest.mark.parametrize("declared", EVERY, ids=lambda e: e.name)
def test_docstring_and_signature_say_the_same(declared):
    assert [t.name for t in declared.terms] == list(inspect.signature(declared.formula).parameters)
    assert declared.result.unit
    assert declared.__name__ if hasattr(declared, "__name__") else declared.name
    assert all(t.meaning for t in declared.terms)


@pytest.mark.parametrize("declared", EVERY, ids=lambda e: e.name)
def test_the_computed_form_has_the_declared_unit(declared):
    """The function itself, fed with bare pint quantities, gives its declared unit: no unit is only claimed."""
    given = {t.name: U.Quantity(1.5, t.unit if t.unit != "1" else "") for t in declared.terms}
    result = U.Quantity(declared.formula(**given))
    assert result.check(U.Quantity(1, declared.result.unit if declared.result.unit != "1" else "").dimensionality)


@pytest.mark.parametrize("number", sorted(EQUATIONS))
def test_printed_forms_pass_the_unit_check_but_10_and_20(number):
    failure = derivation.printed_failure(EQUATIONS[number])
    assert (failure is not None) == (number in (10, 20))


def test_what_fails_says_why():
    assert "N·m times m" in derivation.printed_failure(EQUATIONS[10])
    assert "cannot be added" in derivation.printed_failure(EQUATIONS[20])


@pytest.mark.parametrize("number", [n for n in EQUATIONS if n not in (1, 3, 7, 10, 11, 15, 16, 17, 18, 20)])
def test_where_printed_and_computed_agree_they_give_the_same_number(number):
    declared = EQUATIONS[number]
    values = {t.name: 0.3 + 0.07 * k for k, t in enumerate(declared.terms)}
    space = {"sqrt": math.sqrt, "sin": math.sin, "pi": math.pi} | values
    assert eval(declared.printed, space) == pytest.approx(declared(**values), rel=1e-12)


def test_formulas_as_text_and_typst():
    assert derivation.text(EQUATIONS[1].printed, paper=True) == "60 V_nom / (π d η)"
    assert derivation.text(EQUATIONS[1].computed) == "2 V_nom / (d η_speed)".replace("speed", "v")
    assert derivation.typst("a / (b + c)") == "(a) / (b + c)"
    assert derivation.text("a - (b - c)") == "a − (b − c)"
    assert derivation.text("(a / b)**2") == "(a / b)²"
    assert derivation.text("a / (b * c)") == "a / (b c)"
    assert derivation.typst("a * b", values={"a": "2", "b": "3"}) == "2 dot 3"
    assert derivation.find("(10)") is EQUATIONS[10]
    assert derivation.find("rms_torque") is EQUATIONS[13]
    assert derivation.find("99") is None


@pytest.mark.parametrize(
    ("call", "refused"),
    [
        (lambda: eq.nominal_speed(1.5, 0.15, 2.0), r"\(1\): eta_speed .* got 2(\.0)?, above 1"),
        (lambda: eq.nominal_torque(0.15, F_nom=8.8, delta=1.5), r"\(2\): delta .* got 1\.5, above 1"),
        (lambda: eq.rms_torque_at_motor(0.21, 26.85, 1.8), r"\(17\): eta_gear .* got 1\.8, above 1"),
        (lambda: eq.maximum_torque_at_motor(U("0.2 N*m"), 26.85, 0.8, 1.1, 1.2), r"\(18\): eta_b .* got 1\.2, above 1"),
    ],
)
def test_a_factor_that_only_takes_away_is_1_at_most(call, refused):
    with pytest.raises(InputError, match=refused):
        call()
