r"""ros2_control: the URDF with its hardware block, and the YAML of a velocity controller with the designed gains.

The pid_controller of ros2_controllers takes reference and state of velocity and commands effort. The gains of
``gains``, from the motor to the driven shaft with gears that drive (torque by K e, speed by 1/K), are

.. math:: p = K^2 e\, k_d, \qquad i = K^2 e\, k_p

With feedforward its output is p (w_r - w) + i \int (w_r - w) + f w_r. Its clamps hold the first two terms alone, which
carry the effort and what feedforward takes away: they are the joint's effort and f times its velocity.

Names of parameters by version of ros2_controllers, as its pid_controller/src/pid_controller.yaml declares them (tags
2.54.0, 4.42.1, 5.17.0, 6.9.0); a version ignores those that it does not declare:

- u_clamp_max, u_clamp_min, antiwindup_strategy: from 4.27 (Jazzy) and 5.2 on. Before, as in all 2.x (Humble), only
  the integral is limited, by i_clamp_max and i_clamp_min, whose default there is 0.
- enable_feedforward: 4.x and 5.0, off by default. From 5.1 on feedforward is always on; in 2.x it takes a call of the
  service set_feedforward_control.

The controller manager's update_rate is a whole number of hertz, 100 where none is given.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from xml.etree.ElementTree import Element, SubElement

from drivesizer.errors import InputError
from drivesizer.output.export.common import Export
from drivesizer.output.export.gains import lacking, torque_law
from drivesizer.output.export.joint import JOINT, limited
from drivesizer.output.export.markup import document, identifier, number, remark, text
from drivesizer.output.export.urdf import robot

__all__ = [
    "CONTROLLER", "LOOP", "REMARKS", "STEPS", "TRAJECTORY", "commented", "controllers", "float_text", "hardware",
    "interfaces", "rate_of", "rate_remarks", "render", "transmission", "velocity_gains", "velocity_loops",
]  # fmt: skip

CONTROLLER = "velocity_controller"
LOOP, STEPS = ("velocity", "effort"), ("position",)  # what commands a drive with a loop, and a stepper
_MOCK = "mock_components/GenericSystem"


def render(of: Export) -> bytes:
    """The URDF of a set with its ``ros2_control`` block."""
    root = robot(of)
    block = hardware(root, identifier(of.name))
    interfaces(block, JOINT, limited(of), STEPS if of.stepper else LOOP)
    transmission(block, JOINT, of.train.ratio, "motor")
    return document(root)


def hardware(root: Element, name: str) -> Element:
    """Add a ``ros2_control`` block with its hardware."""
    block = SubElement(root, "ros2_control", name=f"{name}_drive", type="system")
    plugin = SubElement(block, "hardware")
    remark(plugin, f"{_MOCK} to try it; put your drive's own plugin here.")
    SubElement(plugin, "plugin").text = _MOCK
    return block


def interfaces(block: Element, joint: str, known: dict[str, str], takes: Sequence[str]) -> None:
    """Add the interfaces of a joint."""
    of_joint = SubElement(block, "joint", name=joint)
    for name in takes:
        command = SubElement(of_joint, "command_interface", name=name)
        for side, sign in (("min", "-"), ("max", "")) if name in known else ():
            SubElement(command, "param", name=side).text = sign + known[name]
    for name in ("position", "velocity", "effort") if "effort" in takes else ("position", "velocity"):
        SubElement(of_joint, "state_interface", name=name)


def transmission(block: Element, joint: str, ratio: float, actuator: str) -> None:
    """Add a transmission."""
    added = SubElement(block, "transmission", name=f"{joint}_transmission")
    SubElement(added, "plugin").text = "transmission_interface/SimpleTransmission"
    SubElement(added, "actuator", name=actuator, role=actuator)
    of_joint = SubElement(added, "joint", name=joint, role=joint)
    SubElement(of_joint, "mechanical_reduction").text = number(ratio)


def controllers(of: Export) -> bytes:
    """The parameters of controller manager and velocity controller, as YAML."""
    if of.stepper:
        return _trajectory(of)
    law = torque_law(of)
    said = [of.label, of.program, *lacking(of), *REMARKS, *rate_remarks(of)]
    if law.per_acceleration or law.per_direction:
        said.append("feedforward of acceleration and friction is left out")
    return commented(said, velocity_loops({JOINT: velocity_gains(of)}, rate_of(of)))


def commented(said: Iterable[str], body: str) -> bytes:
    """A YAML file with remarks at its head."""
    return ("".join(f"# {_line(line)}\n" for line in said) + body).encode()


def velocity_gains(of: Export, travel: float = 1.0, efficiency: float = 1.0, *, slides: bool = False) -> str:
    """Gains and clamps of one joint's velocity loop, as lines of YAML."""
    law, train = torque_law(of), of.train
    if law.ki:
        raise InputError("--format: ros2_control gets a velocity loop; leave control.position out of the spec")
    at_joint = train.ratio**2 * train.efficiency * efficiency / travel**2
    most, feedforward = of.limits.peak_torque.value * efficiency / travel, law.per_speed * at_joint
    held = most + abs(feedforward) * of.limits.peak_speed.value * travel
    force, angle = ("N", "/m") if slides else ("N*m", "/rad")
    place = " at the driven shaft" if travel == 1.0 else " at the joint"
    return _GAINS.format(
        p=float_text(law.kd * at_joint), i=float_text(law.kp * at_joint), ff=float_text(feedforward),
        most=float_text(held), least=float_text(-held),
        force=force, per=f"{force}*s{angle}{place}", angle=angle, speed=f"{force}*s{angle}",
    )  # fmt: skip


def velocity_loops(
    gains: dict[str, str], rate: int, steppers: Sequence[str] = (), more: Mapping[str, str] | None = None
) -> str:
    """Parameters of one velocity controller of several joints, as YAML."""
    named = {CONTROLLER: "pid_controller/PidController"} if gains else {}
    named |= {_ALONG: "joint_trajectory_controller/JointTrajectoryController"} if steppers else {}
    named |= more or {}
    found = _MANAGER.format(rate=rate) + "".join(f"    {name}:\n      type: {kind}\n" for name, kind in named.items())
    if gains:
        joints = "".join(f"      {joint}:\n{lines}" for joint, lines in gains.items())
        found += _VELOCITY.format(rate=rate, name=CONTROLLER, joints=", ".join(gains), gains=joints)
    return found + (_POSITIONS.format(name=_ALONG, joints=", ".join(steppers)) if steppers else "")


def _trajectory(of: Export) -> bytes:
    """A controller of positions along a trajectory: a stepper has no loop."""
    said = [
        of.label, of.program,
        "a stepper runs open-loop: it goes to the commanded positions, or loses steps unseen; keep accelerations to "
        "those that drivesizer validate has simulated",
    ]  # fmt: skip
    return commented(said, velocity_loops({}, TRAJECTORY, (JOINT,)))


def rate_of(of: Export) -> int:
    """Rate of the controller manager [Hz]."""
    return max(1, round(1.0 / of.period))


def rate_remarks(of: Export) -> list[str]:
    """Remarks on the rate for which gains hold, as sentences."""
    designed = 1.0 / of.period
    said = [
        f"p and i belong to a loop at {designed:.6g} Hz: where the controller manager does not run at update_rate they "
        "do not hold; for a loop at another rate give control: {rate: 1 kHz} in the spec and export anew"
    ]
    if abs(rate_of(of) - designed) > _NEAR * designed:
        said.append(f"update_rate is a whole number: {rate_of(of)} Hz for {designed:.6g} Hz")
    return said


def _line(said: str) -> str:
    return " ".join(text(said).split())


def float_text(value: float) -> str:
    """A figure that YAML and ROS read as a float: an integer is another type to them.

    >>> float_text(2.0), float_text(1e-9)
    ('2.0', '1e-09')
    """
    shown = number(value)
    return shown if set(shown) & {".", "e", "n"} else f"{shown}.0"


_NEAR = 1e-6  # of a rate: what is no whole number
REMARKS = (
    "u_clamp_max, u_clamp_min and antiwindup_strategy are of ros2_controllers 4.27 and 5.2 or later; older ones, "
    "such as Humble's 2.x, ignore them and limit the integral by i_clamp_max and i_clamp_min",
    "enable_feedforward is of 4.x and 5.0; later feedforward is always on; 2.x: the service set_feedforward_control",
    "the clamps limit p and i: the joint's effort, and the feedforward at the joint's velocity",
)
_ALONG = "joint_trajectory_controller"
TRAJECTORY = 100  # Hz, of the controller manager where there are steppers alone
_MANAGER = """controller_manager:
  ros__parameters:
    update_rate: {rate}  # Hz
    joint_state_broadcaster:
      type: joint_state_broadcaster/JointStateBroadcaster
"""
_POSITIONS = """
{name}:
  ros__parameters:
    joints: [{joints}]
    command_interfaces: [position]
    state_interfaces: [position, velocity]
"""
_VELOCITY = """
{name}:
  ros__parameters:
    update_rate: {rate}  # Hz, that of the controller manager
    dof_names: [{joints}]
    command_interface: effort
    reference_and_state_interfaces: [velocity]
    enable_feedforward: true
    gains:
{gains}"""
_GAINS = """        p: {p}  # {per}
        i: {i}  # {force}{angle}
        d: 0.0
        feedforward_gain: {ff}  # {speed}
        u_clamp_max: {most}  # {force}
        u_clamp_min: {least}
        i_clamp_max: {most}  # {force}
        i_clamp_min: {least}
        antiwindup_strategy: conditional_integration
"""
