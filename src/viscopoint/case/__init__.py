"""Case files: tables, units, validation, and the cases that come with the package."""
