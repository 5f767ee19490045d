"""Choices that the paper leaves open, tried the other way: ``tests/bench/ablations.py`` is the command."""
