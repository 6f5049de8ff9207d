"""
Design cables for a pose
========================

At the end, you have two winches and a few cables that bring a bare starfish into a pose, and the
expected as-built error.
"""

# %%
# The search ends after five seconds, or when it finds nothing better.
import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
network = hs.design_cables(robot, [robot.poses["wave"]], winches=2, cables=3, seconds=5)
built = network.expected_error
print(f"{1e3 * network.rms_error:.1f} mm in the model, {1e3 * built:.1f} mm expected as built")

# %%
# Colors are winches.
figure = hs.draw_network(network.robot)
