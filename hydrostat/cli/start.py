"""Start of the `hydrostat` program: Ctrl-C while its commands are still read ends it without a traceback."""

import sys


def start_program() -> None:
    """Read the commands, then run one."""
    try:
        from hydrostat.cli.main import main
    except KeyboardInterrupt:
        print("hydrostat: interrupted; nothing was begun", file=sys.stderr)
        raise SystemExit(130) from None
    main()
