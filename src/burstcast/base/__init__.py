"""Arrays, files, random streams, names and units of time: nothing about flows."""
