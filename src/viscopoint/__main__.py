"""``python -m viscopoint``."""

from viscopoint.cli import main

main()
