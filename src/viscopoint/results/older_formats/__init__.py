"""Run folders of formats 5 to 7, which are read in today's words."""
