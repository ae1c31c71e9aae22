"""The drive over the load cycle: torque and speed, current and voltage, heat, energy."""

from __future__ import annotations

from collections.abc import Iterator

from drivesizer.output.report.figures.field_panels import TOGETHER
from drivesizer.output.report.figures.load_and_loop import stretches
from drivesizer.output.report.figures.wheels import MOST_WHEELS
from drivesizer.output.report.lines.drive import figure_row
from drivesizer.output.report.sections.blocks import Block, Facts, Picture, Words
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import Section
from drivesizer.output.report.sections.texts import TableLink, Text
from drivesizer.units import show

__all__ = ["CYCLE", "ENERGY", "HEAT", "field_picture"]


def _unknown(subject: str) -> Text:
    reason = "the motor's current depends on figures that the catalogue does not know"
    return (f"{subject}: {reason} (", TableLink("unknown"), ").")


def _machine_words(content: Content, wheel: str, cases: str) -> str:
    """Words for a platform with wheels, for several load cases, or none."""
    return wheel if content.wheel else cases if content.cases else ""


# -- over the cycle


_VOLTAGE = (
    "Voltage is what the controller can give at the lowest voltage of the supply, with the winding at its highest "
    "temperature and at the ambient. Torque is that of the motor's shaft, its rotor's acceleration included; below 0 "
    "it brakes."
)
_PULL_OUT = (
    "Torque and speed of the stepper: its pull-out torque at the lowest voltage of the supply, and the part of it that "
    "the cycle may take by the factor of the spec. Torque is that of the motor's shaft, its rotor's acceleration "
    "included; below 0 it brakes."
)
_DOT = "The dot draws the RMS current of the cycle at its RMS speed."
_ON_PAGE = (
    "Shaded dark: allowed continuously; light: over short times, as rated for controller and gearhead; both with a hot "
    "winding."
)
_EFFICIENCY = (
    "Efficiency of motor and gearhead at constant speed, in per cent: copper losses at the mean temperature of the "
    "winding over the cycle, the motor's friction, and the gearhead's loss on the side that the power comes from. "
    "Where it brakes, the share of the power that reaches the supply. Dots, where there are few, are the ends of the "
    "cycle's segments."
)


def _cycle(content: Content) -> Iterator[Block]:
    best = content.drive
    if best is None:
        return
    if best.steps:
        yield Words("The rated current flows in the stepper's windings at any time, whatever the load.")
    elif "demand" not in content.drawings:
        yield Words(_unknown("The motor's current over time is unknown"))
    if best.figures:
        wheel = f"; energy and power of the supply as if every drive did what that of {content.wheel} does"
        cases = "; energy is that of the case as specified, the rest of the worst case"
        of = _machine_words(content, wheel, cases)
        yield Facts(f"Figures of the drive over the cycle{of}", [*map(figure_row, best.figures)], halves=True)
    if "fields" in content.drawings:
        yield Picture("fields", f"The motor's torque-speed field with each load case alone. {_VOLTAGE} {_DOT}",
                      "torque-speed field of the motor with each load cycle",
                      about="sets each load case against the limits of the motor.")  # fmt: skip
    first = f" The load cycle is that of {content.cycles[0][0]}." if len(content.cycles) > TOGETHER else ""
    yield Picture("efficiency", _EFFICIENCY + first,
                  "efficiency of motor and gearhead over torque and speed with the load cycle",
                  about="shows the share of the power that arrives.", floats=True)  # fmt: skip
    cases = f", in the first {MOST_WHEELS} load cases" if len(content.cases) > MOST_WHEELS else ""
    of = "" if content.wheel else " those of the case as specified,"
    cut = " The longest stretch without change is left out." if len(stretches(content.cycles)) > 1 else ""
    yield Picture("demand", "Current and voltage of the motor over the cycle, at the mean temperature of the winding "
                  f"over the cycle{cases}. Limits are{of} without the margins that the spec requires.{cut}",
                  "current and voltage over the cycle with their limits",
                  about="shows current and voltage over time, as the checks by physics use them.",
                  floats=True)  # fmt: skip


def field_picture(content: Content) -> Picture:
    """The motor's torque-speed field with the load cycle in it."""
    more = ""
    if content.drive is not None and content.drive.steps:
        return Picture("field", _PULL_OUT, "torque-speed field of the stepper with the load cycle")
    if content.result.method == "paper":
        more += " The points of the paper are brought to the shaft as in (18), their speeds with the reserve of (1)."
    if "fields" in content.drawings and content.cycles[0][0]:
        more += f" The load cycle is that of {content.cycles[0][0]}; each load case has a diagram of its own below."
    return Picture(
        "field", f"Torque and speed of the motor: the shaded field is allowed continuously. {_VOLTAGE} {_DOT}{more}",
        "torque-speed field of the motor with the load cycle",
        on_page=f"Torque and speed of the motor. {_ON_PAGE} {_VOLTAGE} {_DOT}{more}")  # fmt: skip


CYCLE = Section(name="cycle", title="Over the cycle", level=2, blocks=_cycle, tabled=False)


# -- heat


def _heat(content: Content) -> Iterator[Block]:
    behaviour = content.behaviour
    if behaviour is None:
        return
    of = _machine_words(content, f" at {content.wheel}", " in the case as specified")
    yield Facts(f"Losses and temperatures{of}, in periodic steady state", behaviour.heat, "heat", halves=True)
    if behaviour.hottest is None:
        yield Words(f"The course of the temperatures over time is not drawn: {behaviour.heat_lacks}.")
        return
    several = len(behaviour.cycles) > 1
    worst = f" {'at' if content.wheel else 'in load case'} {behaviour.hottest[0]}, the warmest" if several else ""
    yield Picture("heat", f"Winding and housing{worst}. Left from cold to where less than 1 % of the rise remains, the "
                  "winding as a band between its lowest and its highest in each cycle; right the periodic steady "
                  "state, with its peak.", "temperatures of winding and housing from cold and over the cycle",
                  about="shows the motor warming up.")  # fmt: skip


HEAT = Section(name="heat", title="Heat", level=2, blocks=_heat, tabled=False)


# -- energy


def _energy(content: Content) -> Iterator[Block]:
    behaviour = content.behaviour
    if behaviour is None:
        return
    if not behaviour.energy.known:
        yield Words(_unknown("Unknown"))
        return
    kept = show(content.result.spec.supply.regeneration, "%", "dimensionless")
    yield Words(f"The cycle costs the supply {behaviour.cost}: drawn less what is regenerated and kept ({kept} of it, "
                "by the spec).")  # fmt: skip
    of = _machine_words(content, ", each at its wheel", ", as specified")
    yield Picture("energy", f"Energy of one cycle, all drives{of}. Each bar begins where the one above it ends.",
                  "losses and work in the energy of a cycle",
                  about="splits the energy that the supply gives in a cycle; the parts sum to the whole.")  # fmt: skip


ENERGY = Section(name="energy", title="Energy", level=2, blocks=_energy, tabled=False)
