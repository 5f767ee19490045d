"""Live sources: cameras, players of videos, pictures and tracks, and face data over the network."""

from .camera import CameraChoice, cameras, open_camera
from .opening import open_input

__all__ = ["CameraChoice", "cameras", "open_camera", "open_input"]
