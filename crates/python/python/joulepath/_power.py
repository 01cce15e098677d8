"""Power of many moments at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _native
from ._answers import Columns
from ._robot import RobotLike, robot_of
from .errors import InvalidRequestError, MaskedArrayError, ShapeError

if TYPE_CHECKING:
    import numpy.typing


def power(
    robot: RobotLike,
    speed_mps: numpy.typing.ArrayLike,
    yaw_rate_radps: numpy.typing.ArrayLike = 0.0,
    pitch_rad: numpy.typing.ArrayLike = 0.0,
    roll_rad: numpy.typing.ArrayLike = 0.0,
    *,
    surface: str | None = None,
    motor_temp_left_c: numpy.typing.ArrayLike | None = None,
    motor_temp_right_c: numpy.typing.ArrayLike | None = None,
    power_model: str = "force-balance",
) -> Columns:
    """Power of a robot in steady motion, moment by moment: the function that planning and diagnosis call.

    Arrays are broadcast against one another, and the columns of the answer have the common shape. ``speed_mps``: forward [m/s].
    ``yaw_rate_radps``: positive turning left [rad/s]. ``pitch_rad``: positive climbing. ``roll_rad``: positive left side up, both within
    π/2 [rad]. ``surface``: one of the robot's, its default if left out. ``motor_temp_left_c``, ``motor_temp_right_c``: by default the
    temperature that the motors' constants are of [°C].

    Columns: ``power_w`` drawn from the battery, ``power_left_w`` and ``power_right_w`` at the motor drivers, ``force_left_n`` and
    ``force_right_n`` of the wheels.

    Raises ``NotANumberError`` (NaN or an infinity, with its place), ``UnitError`` (an angle beyond π/2), ``MaskedArrayError``,
    ``ShapeError``, ``UnknownSurfaceError``.

    >>> import joulepath, numpy
    >>> found = joulepath.power("husky-a200", 0.5, pitch_rad=numpy.array([0.0, 0.1, -0.1]))
    >>> found["power_w"].shape, bool(found["power_w"][1] > found["power_w"][0] > found["power_w"][2])
    ((3,), True)
    >>> joulepath.power("husky-a200", 0.5, pitch_rad=20.0)
    Traceback (most recent call last):
        ...
    joulepath.errors.UnitError: pitch_rad is 20: it must lie in -1.571 to 1.571; give radians, numpy.radians(x) of degrees
    """
    import numpy

    robot = robot_of(robot)
    reference_c = robot.motors["reference_temperature_c"]
    named: dict[str, Any] = {
        "speed_mps": speed_mps,
        "yaw_rate_radps": yaw_rate_radps,
        "pitch_rad": pitch_rad,
        "roll_rad": roll_rad,
        "motor_temp_left_c": reference_c if motor_temp_left_c is None else motor_temp_left_c,
        "motor_temp_right_c": reference_c if motor_temp_right_c is None else motor_temp_right_c,
    }
    arrays = [_array(name, values) for name, values in named.items()]
    try:
        shape = numpy.broadcast_shapes(*(array.shape for array in arrays))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in zip(named, arrays) if array.ndim)
        raise ShapeError(f"the arrays have shapes that do not go together: {shapes}", pointer="/speed_mps") from None
    flat = [array.reshape(1) if array.size == 1 else numpy.broadcast_to(array, shape).ravel() for array in arrays]
    found = _native.power(robot._native, [numpy.ascontiguousarray(array) for array in flat], surface, power_model)
    return Columns({name: column.reshape(shape) for name, column in found.items()})


def _array(name: str, values: Any) -> Any:
    import numpy

    if isinstance(values, numpy.ma.MaskedArray):
        detail = f"{name} is a masked array: leave out what it masks, {name}.compressed(), or fill it, {name}.filled(0.0)"
        raise MaskedArrayError(detail, pointer=f"/{name}")
    array = numpy.asarray(values)
    if array.dtype.kind not in "fiub":
        raise InvalidRequestError(f"{name} holds {array.dtype}: give numbers, {name}.astype(float)", pointer=f"/{name}")
    return array.astype(numpy.float64, copy=False)
