"""`calibration`: how stoppers are set, in steps."""

from hydrostat.fabrication.kit_options import Method
from hydrostat.fabrication.sheets.sheet_input import SheetInput


def calibration(given: SheetInput) -> tuple[str, ...]:
    """From winches at zero to stoppers that are tight; nothing without cables."""
    if not given.robot.cables:
        return ()
    cloth = "cloth" if given.method is Method.PLUSH else "skin"
    return (
        "Turn all winches to zero: the spool mark of each cable stands where the line meets the spool.",
        "Pull the first cable straight by its tail, not tight: the body must not move.",
        f"Slide its stopper along the line until it touches the {cloth} at the cable's last point; then back by the "
        "slack of the list, and clamp it there. Nothing else is measured.",
        "Do the next cable; then take in 10 mm with every winch, one after the other. Each limb must begin to move, "
        "and come back when you let out.",
        "Moves late: pull the line straighter and set the stopper again. Is bent at zero: shift the stopper outwards. "
        "Then trim the tail to 30 mm.",
    )
