"""The live loop for a long time, with faults at random: ``tests/bench/soak.py`` is the command of half an hour."""
