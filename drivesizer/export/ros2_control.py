r"""ros2_control: the URDF with its hardware block, and the YAML of a velocity controller with the designed gains.

The pid_controller of ros2_controllers takes reference and state of velocity and commands effort. The gains of
``gains``, from the motor to the driven shaft with gears that drive (torque by K e, speed by 1/K), are

.. math:: p = K^2 e\, k_d, \qquad i = K^2 e\, k_p

With feedforward its output is p (w_r - w) + i \int (w_r - w) + f w_r.
"""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from drivesizer.errors import InputError
from drivesizer.export.common import Export
from drivesizer.export.gains import lacking, torque_law
from drivesizer.export.joint import JOINT, limited
from drivesizer.export.markup import document, identifier, number, remark, text
from drivesizer.export.urdf import robot

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
    for name in ("velocity", "effort"):
        command = SubElement(joint, "command_interface", name=name)
        for side, sign in (("min", "-"), ("max", "")):
            SubElement(command, "param", name=side).text = sign + known[name]
    for name in ("position", "velocity", "effort"):
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
        When the gains ask for an angle: a position loop has no place in a velocity controller.
    """
    law, train = torque_law(of), of.train
    if law.ki:
        raise InputError("--format: ros2_control gets a velocity loop; leave control.position out of the spec")
    at_shaft = train.ratio**2 * train.efficiency
    rate = max(1, round(1.0 / of.period))
    most = of.limits.peak_torque.value
    said = [of.label, of.program, *lacking(of), *_REMARKS,
            f"the loop was designed for {1.0 / of.period:.6g} Hz; at a lower update_rate design it anew"]  # fmt: skip
    if law.per_acceleration or law.per_direction:
        said.append("feedforward of acceleration and friction is left out")
    head = "".join(f"# {_line(line)}\n" for line in said)
    body = _PARAMETERS.format(
        rate=rate, name=CONTROLLER, joint=JOINT, p=_yaml(law.kd * at_shaft), i=_yaml(law.kp * at_shaft),
        ff=_yaml(law.per_speed * at_shaft), most=_yaml(most), least=_yaml(-most),
    )  # fmt: skip
    return (head + body).encode()


def _line(said: str) -> str:
    return " ".join(text(said).split())


def _yaml(value: float) -> str:
    """A float that YAML and ROS read as one: an integer is another type to them."""
    shown = number(value)
    return shown if set(shown) & {".", "e", "n"} else f"{shown}.0"


_REMARKS = (
    "feedforward is off until it is switched on: enable_feedforward, or the service set_feedforward_control",
    "u_clamp and antiwindup_strategy as the newer control_toolbox has them; an older one has i_clamp and antiwindup",
)
_PARAMETERS = """controller_manager:
  ros__parameters:
    update_rate: {rate}  # Hz
    joint_state_broadcaster:
      type: joint_state_broadcaster/JointStateBroadcaster
    {name}:
      type: pid_controller/PidController

{name}:
  ros__parameters:
    dof_names: [{joint}]
    command_interface: effort
    reference_and_state_interfaces: [velocity]
    gains:
      {joint}:
        p: {p}  # N*m*s/rad at the driven shaft
        i: {i}  # N*m/rad
        d: 0.0
        feedforward_gain: {ff}  # N*m*s/rad
        u_clamp_max: {most}  # N*m, the joint's effort
        u_clamp_min: {least}
        antiwindup_strategy: conditional_integration
"""
