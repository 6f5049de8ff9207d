"""Objectives of inverse kinematics, each in a file of its own."""
