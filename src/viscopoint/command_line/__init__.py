"""The ``viscopoint`` command."""
