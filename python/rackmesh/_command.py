"""The command ``rackmesh``."""

import signal
import sys

from ._rackmesh import main as run


def main() -> None:
    """Runs the command line; ends with its exit status."""
    # the program handles Ctrl-C itself, not Python
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(run(["rackmesh", *sys.argv[1:]]))
