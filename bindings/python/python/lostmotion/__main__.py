"""`python -m lostmotion` is the command `joint`."""

from ._command import main

main()
