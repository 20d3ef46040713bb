"""The options of `drakearm evaluate` that perturb the arm."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drakearm.errors import shown

if TYPE_CHECKING:
    from drakearm.diagrams import Perturbation


def _numbers(count: int, what: str) -> Callable[[str], Any]:
    """The parser of an option that is one number, or several with commas between them. what: in words."""

    def parse(text: str) -> Any:
        try:
            values = [float(part) for part in text.split(",")]
        except ValueError:
            values = []
        if len(values) != count or not all(map(math.isfinite, values)):
            raise typer.BadParameter(f"found {shown(text)}, expected {what}.")
        return values[0] if count == 1 else tuple(values)

    return parse


def _option(name: str, metavar: str, help: str, *, count: int = 1, what: str = "a number") -> Any:
    return typer.Option(name, help=help, metavar=metavar, parser=_numbers(count, what), show_default=False)


Load = Annotated[float | None, _option("--load", "KG", "Put a mass into the hand that the policy does not know.")]
MotorNoise = Annotated[
    float | None,
    _option("--motor-noise", "SHARE", "Add noise to the excitations: its standard deviation as a share of them."),
]
SensorDelay = Annotated[
    float | None, _option("--sensor-delay", "S", "Delay what the policy senses of its body by a time in seconds.")
]
Push = Annotated[
    tuple | None,
    _option(
        "--push",
        "NM,START,SECONDS",
        "Push all joints with a torque, from a time on the reference, for some seconds.",
        count=3,
        what="a torque, a start and a duration, such as 2,0.3,0.1",
    ),
]
Strength = Annotated[
    float | None, _option("--strength", "FACTOR", "Multiply the maximum isometric forces of all muscles.")
]
StartOffset = Annotated[float | None, _option("--start-offset", "DEG", "Start with all joints turned by an angle.")]


def chosen_perturbations(
    load: float | None,
    motor_noise: float | None,
    sensor_delay: float | None,
    push: tuple[float, float, float] | None,
    strength: float | None,
    start_offset: float | None,
) -> "list[Perturbation]":
    """The perturbations of the options that are given. Raises BadParameter, which names the option, if one is wrong."""
    given = {
        "--load": load is not None and {"type": "extra_load", "mass": load},
        "--motor-noise": motor_noise is not None and {"type": "motor_noise", "share": motor_noise},
        "--sensor-delay": sensor_delay is not None and {"type": "sensor_delay", "delay": sensor_delay},
        "--push": push and {"type": "push", "torque": push[0], "start": push[1], "duration": push[2]},
        "--strength": strength is not None and {"type": "strength", "factor": strength},
        "--start-offset": start_offset is not None and {"type": "start_offset", "angle_deg": start_offset},
    }
    chosen = {option: content for option, content in given.items() if content}
    if not chosen:
        return []
    from drakearm.diagrams import Perturbation

    perturbations = []
    for option, content in chosen.items():
        try:
            perturbations.append(Perturbation.read(content))
        except ValueError as error:
            raise typer.BadParameter(f"{error}.", param_hint=option) from error
    return perturbations
