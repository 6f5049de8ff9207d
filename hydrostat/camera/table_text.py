"""`table_text`: measured photographs as the table that `hydrostat identify` reads."""

import numpy as np

from hydrostat.camera.measure_photos import PhotoMeasurements
from hydrostat.files import csv_text
from hydrostat.robot import Robot


def table_text(robot: Robot, found: PhotoMeasurements) -> bytes:
    """CSV with the columns pose, left_mm per winch, tip_x_mm ... per marker, tip_load_g per marker with a mass."""
    measured = found.measurements
    axes = "xyz"[: measured.places.shape[2]]
    hung = np.asarray(measured.hung_masses.any(axis=0))
    loaded = [name for name, has_mass in zip(measured.markers, hung.tolist(), strict=True) if has_mass]
    head = ["pose", *(f"{winch.name}_mm" for winch in robot.winches)]
    head += [f"{name}_{axis}_mm" for name in measured.markers for axis in axes]
    head += [f"{name}_load_g" for name in loaded]
    rows = []
    for members, command, places, masses in zip(
        found.rows, measured.commands, measured.places, measured.hung_masses, strict=True
    ):
        numbers = [f"{1e3 * value:.6g}" for value in command]
        numbers += ["" if np.isnan(value) else f"{1e3 * value:.3f}" for value in places.ravel()]
        rows.append([found.photos[members[0]].photo.name, *numbers, *(f"{1e3 * mass:.6g}" for mass in masses[hung])])
    return csv_text(head, rows)
