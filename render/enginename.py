"""What engines are called; by itself, for the command line, which must not wait for what they need."""

from typing import Literal

EngineName = Literal["auto", "quads", "software"]
