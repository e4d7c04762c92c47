"""``python -m viscopoint``."""

from viscopoint.command_line.cli import main

main()
