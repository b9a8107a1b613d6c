"""The command line: ``python -m rodlab``."""

from . import main

main()
