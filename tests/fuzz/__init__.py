"""Files damaged at random, well-formed and not: each may only open, or be refused with the one error of its reader.

``python -m fuzz.worker`` reads them in a process of its own; ``tests/bench/fuzz.py`` is the nightly command.
"""
