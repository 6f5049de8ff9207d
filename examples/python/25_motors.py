"""
Drive motors
============

At the end, simulated motors have played a trajectory within the speed limits of the winches.
"""

# %%
# Contractions over time: take in 8 mm in half a second, which is 16 mm/s. The clock of this example skips waiting.
import numpy as np
from matplotlib.figure import Figure

import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
profile = hs.ContractionProfile.ramp(np.array([0.0, 0.008, 0.0]), 0.5)


class Clock:
    """Clock that only waiting moves on."""

    time = 0.0

    def __call__(self):
        """Return the time [s]."""
        return self.time

    def wait(self, seconds):
        """Wait [s]."""
        self.time += seconds


# %%
# Real motors: ``motors = hs.control.arm_motors(folder, robot, "dynamixel:/dev/ttyUSB0", tensions)``, where ``tensions``
# is ``hs.control.tensions_along(robot, profile)``, and ``player.run(motors, profile)`` in real time.
clock = Clock()
motors = hs.control.Motors(robot.winches, hs.control.SimulatedLink(np.zeros(3)), fastest=0.03)
player = hs.control.Player()
player.rounds = 1
times, places = [], []


def record():
    """Keep what is commanded and where the motors are."""
    times.append(player.time)
    places.append(motors.places.copy())


player.run(motors, profile, clock=clock, wait=clock.wait, tell=record)

# %%
# Measured contractions follow the commands.
measured, commanded = np.array(places)[:, 1], np.array([profile.at(time)[1] for time in times])
error = float(np.abs(measured - commanded).max())
print(f"{len(times)} commands, at most {1e3 * error:.2f} mm off")
figure = Figure(figsize=(6, 3.5), layout="constrained")
axes = figure.add_subplot(xlabel="time [s]", ylabel="contraction of winch left [mm]")
axes.plot(times, 1e3 * commanded, color="gray", label="command")
axes.plot(times, 1e3 * measured, label="motor")
axes.legend()
