"""What keeps the comparison from running, as one plain sentence with its cure."""


class Trouble(Exception):
    """Printed without a traceback."""
