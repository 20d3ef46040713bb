"""`python -m drakearm.cli` is the command `drakearm`."""

from drakearm.cli import main

main()
