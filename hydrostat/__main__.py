"""`python -m hydrostat`."""

from hydrostat.cli.main import main

main()
