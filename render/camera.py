"""The pinhole camera: OpenCV axes (x right, y down, z forward), pixel centres at half integers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Camera:
    """Intrinsics in pixels, extrinsics in metres."""

    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int
    world_to_camera: NDArray[np.float64]
    """[4, 4] rigid transform from the world (y up) to the camera (y down, z forward)."""

    def __post_init__(self) -> None:
        matrix = np.asarray(self.world_to_camera, np.float64)
        if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
            raise ValueError(f"world_to_camera must be 4x4 and finite, got shape {matrix.shape}")
        if not (1 <= self.width <= 16384 and 1 <= self.height <= 16384):
            raise ValueError(f"a camera's size must be 1..16384 pixels a side, got {self.width}x{self.height}")
        if not (self.fx > 0 and self.fy > 0 and np.isfinite([self.fx, self.fy, self.cx, self.cy]).all()):
            raise ValueError(f"focal lengths must be finite and > 0, got {self.fx}, {self.fy}")
        object.__setattr__(self, "world_to_camera", matrix)

    @property
    def center(self) -> NDArray[np.float64]:
        """[3] position of the pinhole in the world, metres."""
        return -self.world_to_camera[:3, :3].T @ self.world_to_camera[:3, 3]

    def scaled(self, width: int, height: int) -> "Camera":
        """The same view in a picture of another size."""
        across, down = width / self.width, height / self.height
        return Camera(
            self.fx * across,
            self.fy * down,
            self.cx * across,
            self.cy * down,
            width,
            height,
            self.world_to_camera,
        )


def look_at(eye: ArrayLike, target: ArrayLike) -> NDArray[np.float64]:
    """world_to_camera [4, 4] of an upright camera at ``eye`` that looks at ``target``.

    Raises ValueError when the two coincide or the view is straight up or down.
    """
    eye = np.asarray(eye, np.float64)
    forward = np.asarray(target, np.float64) - eye
    right = np.cross(forward, [0, 1, 0])
    if np.linalg.norm(right) < 1e-9:
        raise ValueError(f"no upright camera at {eye} looks at {target}")
    forward = forward / np.linalg.norm(forward)
    right = right / np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack([right, np.cross(forward, right), forward])
    matrix[:3, 3] = -matrix[:3, :3] @ eye
    return matrix


def orbit(
    target: ArrayLike,
    distance: float,
    yaw_deg: float,
    pitch_deg: float,
    fov_deg: float,
    width: int,
    height: int,
) -> Camera:
    """A camera ``distance`` metres from ``target``: yaw 0 sees the face from +z, yaw > 0 moves the camera to +x,
    pitch > 0 moves it up. ``fov_deg`` is the vertical field of view."""
    yaw, pitch = np.radians([yaw_deg, pitch_deg])
    direction = np.array([np.sin(yaw) * np.cos(pitch), np.sin(pitch), np.cos(yaw) * np.cos(pitch)])
    focal = height / 2 / np.tan(np.radians(fov_deg) / 2)
    world_to_camera = look_at(np.asarray(target, np.float64) + distance * direction, target)
    return Camera(focal, focal, width / 2, height / 2, width, height, world_to_camera)
