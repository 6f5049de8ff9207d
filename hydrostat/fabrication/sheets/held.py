"""`held_text`: where a robot is held, as it was simulated."""

from hydrostat.robot import Pin, Robot


def held_text(robot: Robot) -> str:
    """Where to clamp or strap it, a sentence; empty if it is held nowhere."""
    if not robot.pins:
        return ""
    places = "; ".join(_place(pin) for pin in robot.pins)
    return f"It was simulated as held {places}, in the coordinates of the robot file: clamp or strap it there."


def _place(pin: Pin) -> str:
    if pin.box is not None:
        axes = zip("xyz", *pin.box, strict=False)
        spans = ", ".join(f"{axis} {_mm(min(one, two))} to {_mm(max(one, two))}" for axis, one, two in axes)
        return f"within {spans} mm"
    at = ", ".join(f"{axis} {_mm(value)}" for axis, value in zip("xyz", pin.at or (), strict=False))
    return f"round {at} mm" + (f", up to {_mm(pin.radius)} mm from there" if pin.radius else "")


def _mm(value: float) -> str:
    return f"{1e3 * value + 0.0:.0f}".replace("-", "−")
