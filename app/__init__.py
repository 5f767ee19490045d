"""A camera, a clock and a person: the command line and the programs behind it."""
