"""The command ``rackmesh``."""

import signal
import sys

from ._rackmesh import main as run


def main() -> None:
    """Runs the command line; ends with its exit status."""
    # Ctrl-C ends the program at once, or is the program's own to handle
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(run(["rackmesh", *sys.argv[1:]]))
