"""Checks whether a kit is true to the robot that was simulated, measured on the finished files."""
