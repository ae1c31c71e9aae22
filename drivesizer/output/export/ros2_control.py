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

from xml.etree.ElementTree import Element, SubElement

from drivesizer.errors import InputError
from drivesizer.output.export.common import Export
from drivesizer.output.export.gains import lacking, torque_law
from drivesizer.output.export.joint import JOINT, limited
from drivesizer.output.export.markup import document, identifier, number, remark, text
from drivesizer.output.export.urdf import robot

__all__ = ["CONTROLLER", "controllers", "render"]

CONTROLLER = "velocity_controller"
_MOCK = "mock_components/GenericSystem"


def render(of: Export) -> bytes:
    """The URDF of a set with its ``ros2_control`` block."""
    root = robot(of)
    block = SubElement(root, "ros2_control", name=f"{identifier(of.name)}_drive", type="system")
    hardware = SubElement(block, "hardware")
    remark(hardware, f"{_MOCK} to try it; put your drive's own plugin here.")
    SubElement(hardware, "plugin").text = _MOCK
    joint = SubElement(block, "joint", name=JOINT)
    known = limited(of)
    for name in ("position",) if of.stepper else ("velocity", "effort"):
        command = SubElement(joint, "command_interface", name=name)
        for side, sign in (("min", "-"), ("max", "")) if name in known else ():
            SubElement(command, "param", name=side).text = sign + known[name]
    for name in ("position", "velocity") if of.stepper else ("position", "velocity", "effort"):
        SubElement(joint, "state_interface", name=name)
    _transmission(block, of)
    return document(root)


def _transmission(block: Element, of: Export) -> None:
    transmission = SubElement(block, "transmission", name=f"{JOINT}_transmission")
    SubElement(transmission, "plugin").text = "transmission_interface/SimpleTransmission"
    SubElement(transmission, "actuator", name="motor", role="motor")
    joint = SubElement(transmission, "joint", name=JOINT, role=JOINT)
    SubElement(joint, "mechanical_reduction").text = number(of.train.ratio)


def controllers(of: Export) -> bytes:
    """The parameters of controller manager and velocity controller, as YAML.

    Raises
    ------
    InputError
        When there is a position loop, which a velocity controller cannot have.
    """
    if of.stepper:
        return _trajectory(of)
    law, train = torque_law(of), of.train
    if law.ki:
        raise InputError("--format: ros2_control gets a velocity loop; leave control.position out of the spec")
    at_shaft = train.ratio**2 * train.efficiency
    most, feedforward = of.limits.peak_torque.value, law.per_speed * at_shaft
    held = most + abs(feedforward) * of.limits.peak_speed.value
    said = [of.label, of.program, *lacking(of), *_REMARKS, *_rate_remarks(of)]
    if law.per_acceleration or law.per_direction:
        said.append("feedforward of acceleration and friction is left out")
    head = "".join(f"# {_line(line)}\n" for line in said)
    body = _PARAMETERS.format(
        rate=_rate(of), name=CONTROLLER, joint=JOINT, p=_yaml(law.kd * at_shaft), i=_yaml(law.kp * at_shaft),
        ff=_yaml(feedforward), most=_yaml(held), least=_yaml(-held),
    )  # fmt: skip
    return (head + body).encode()


def _trajectory(of: Export) -> bytes:
    """A controller of positions along a trajectory: a stepper has no loop."""
    said = [
        of.label, of.program,
        "a stepper runs open-loop: it goes to the commanded positions, or loses steps unseen; keep accelerations to "
        "those that drivesizer validate has simulated",
    ]  # fmt: skip
    head = "".join(f"# {_line(line)}\n" for line in said)
    return (head + _POSITIONS.format(joint=JOINT)).encode()


def _rate(of: Export) -> int:
    """Of the controller manager [Hz]."""
    return max(1, round(1.0 / of.period))


def _rate_remarks(of: Export) -> list[str]:
    designed = 1.0 / of.period
    said = [
        f"p and i belong to a loop at {designed:.6g} Hz: where the controller manager does not run at update_rate they "
        "do not hold; for a loop at another rate give control: {rate: 1 kHz} in the spec and export anew"
    ]
    if abs(_rate(of) - designed) > _NEAR * designed:
        said.append(f"update_rate is a whole number: {_rate(of)} Hz for {designed:.6g} Hz")
    return said


def _line(said: str) -> str:
    return " ".join(text(said).split())


def _yaml(value: float) -> str:
    """A float that YAML and ROS read as one: an integer is another type to them."""
    shown = number(value)
    return shown if set(shown) & {".", "e", "n"} else f"{shown}.0"


_NEAR = 1e-6  # of a rate: what is no whole number
_REMARKS = (
    "u_clamp_max, u_clamp_min and antiwindup_strategy are of ros2_controllers 4.27 and 5.2 or later; older ones, "
    "such as Humble's 2.x, ignore them and limit the integral by i_clamp_max and i_clamp_min",
    "enable_feedforward is of 4.x and 5.0; later feedforward is always on; 2.x: the service set_feedforward_control",
    "the clamps limit p and i: the joint's effort, and the feedforward at the joint's velocity",
)
_POSITIONS = """controller_manager:
  ros__parameters:
    update_rate: 100  # Hz
    joint_state_broadcaster:
      type: joint_state_broadcaster/JointStateBroadcaster
    joint_trajectory_controller:
      type: joint_trajectory_controller/JointTrajectoryController

joint_trajectory_controller:
  ros__parameters:
    joints: [{joint}]
    command_interfaces: [position]
    state_interfaces: [position, velocity]
"""
_PARAMETERS = """controller_manager:
  ros__parameters:
    update_rate: {rate}  # Hz
    joint_state_broadcaster:
      type: joint_state_broadcaster/JointStateBroadcaster
    {name}:
      type: pid_controller/PidController

{name}:
  ros__parameters:
    update_rate: {rate}  # Hz, that of the controller manager
    dof_names: [{joint}]
    command_interface: effort
    reference_and_state_interfaces: [velocity]
    enable_feedforward: true
    gains:
      {joint}:
        p: {p}  # N*m*s/rad at the driven shaft
        i: {i}  # N*m/rad
        d: 0.0
        feedforward_gain: {ff}  # N*m*s/rad
        u_clamp_max: {most}  # N*m
        u_clamp_min: {least}
        i_clamp_max: {most}  # N*m
        i_clamp_min: {least}
        antiwindup_strategy: conditional_integration
"""
