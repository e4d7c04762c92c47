"""The packaged cases, as TOML files."""
