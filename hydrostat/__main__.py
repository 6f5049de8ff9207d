"""`python -m hydrostat`."""

from hydrostat.cli.start import start_program

start_program()
