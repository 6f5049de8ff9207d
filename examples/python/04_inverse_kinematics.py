"""
Inverse kinematics within limits
================================

At the end, you have the contractions that bring one arm to a target, without and with a limit on tension.
"""

# %%
# A target for one marker [m].
import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
simulation = hs.Simulation(robot)
target = {"left": (-0.103, 0.052)}
free = hs.solve_ik(simulation, target)
print(free.status, f"{1e3 * free.rms_error:.2f} mm, at most {free.pose.tensions.max():.1f} N")

# %%
# The same with at most 2 N in every cable. `active_limits` lists the limits that hold it back.
limited = hs.solve_ik(simulation, target, limits=hs.Limits(tension=2.0))
error = limited.rms_error
print(limited.status, f"{1e3 * error:.2f} mm:", *limited.active_limits)

# %%
# Crosses are targets.
figure = hs.draw_reached(simulation.robot, limited)
