"""`told_error`: text of an error."""


def told_error(error: float) -> str:
    """Text of an error [m]; nobody builds a robot that is better than a tenth of a millimetre."""
    if error < 1e-4:
        return "below 0.1 mm"
    return f"{1e3 * error:.1f} mm" if error < 0.01 else f"{1e3 * error:.0f} mm"
