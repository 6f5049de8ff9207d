"""`told_error`: an error as a person is told it."""


def told_error(error: float) -> str:
    """An error [m] as it is told; nobody builds a robot that is better than a tenth of a millimetre."""
    if error < 1e-4:
        return "below 0.1 mm"
    return f"{1e3 * error:.1f} mm" if error < 0.01 else f"{1e3 * error:.0f} mm"
