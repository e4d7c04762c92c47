"""Run folders: how they are written, resumed, read and verified."""
