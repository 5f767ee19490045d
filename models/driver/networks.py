"""Opening the shipped networks: known bytes only, one quiet thread each."""

import hashlib
from pathlib import Path

import numpy as np
import onnxruntime as ort
from numpy.typing import NDArray

from ..brevity import brief

FOLDER = Path(__file__).resolve().parents[2] / "assets" / "networks"
"""Where the networks ship."""
DETECTOR_FILE = "face_detector.onnx"
LANDMARKS_FILE = "face_landmarks_detector.onnx"
SCORES_FILE = "face_blendshapes.onnx"
GEOMETRY_FILE = "geometry_pipeline_metadata_landmarks.binarypb"
SHA256 = {
    DETECTOR_FILE: "b8297c5c3262345bdea2e460774afc0137c0b726988406648270dd9fc20e8711",
    LANDMARKS_FILE: "3d08f3e2d427af5235043922a222b7c38f308c29d14ceaedb88bea34ee5ccb31",
    SCORES_FILE: "2ba0b6f07979551a55287719ba39a0119fa1d760f01822854ab4b1556ee5430e",
    GEOMETRY_FILE: "bdbcda96dfcb7da883da124aaa2c55dee49770d934f0fcc71747f8c21bdc75b4",
}
"""What each file must hash to: features, neutrals and regressors are only valid with exactly these networks."""

PROVIDERS = ("CPUExecutionProvider",)
"""What onnxruntime is asked to run the networks on, the first choice first."""


class NetworkError(RuntimeError):
    """A network is missing, is not the one this version was made with, or cannot be run."""


def read_checked(folder: Path, name: str) -> bytes:
    """The bytes of a shipped file. Raises NetworkError when it is missing, unreadable or not the expected one."""
    path = folder / name
    try:
        content = path.read_bytes()
    except OSError as error:
        raise NetworkError(
            f"cannot read the face network {path}: {error.strerror}. Reinstall gemheads, or rebuild the networks with"
            " `python -m gemheads.models.driver.build.convert`."
        ) from error
    if hashlib.sha256(content).hexdigest() != SHA256[name]:
        raise NetworkError(
            f"{path} ({len(content)} bytes) is not the face network this version was made with: its hash differs."
            " Reinstall gemheads, or rebuild the networks with `python -m gemheads.models.driver.build.convert`."
        )
    return content


def open_session(model: bytes, what: str) -> ort.InferenceSession:
    """A session on the CPU with one thread that never spins: a spinning pool starves the rasteriser on small machines.

    Raises NetworkError, naming ``what``, when onnxruntime refuses the model.
    """
    options = ort.SessionOptions()
    options.intra_op_num_threads = 1
    options.inter_op_num_threads = 1
    options.log_severity_level = 4
    options.add_session_config_entry("session.load_model_format", "ONNX")  # else bytes may say that they are another
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    options.add_session_config_entry("session.inter_op.allow_spinning", "0")
    try:
        return ort.InferenceSession(model, options, providers=list(PROVIDERS))
    except Exception as error:  # onnxruntime raises a dozen unrelated classes
        raise NetworkError(f"onnxruntime {ort.__version__} cannot open {what}: {brief(error, 300)}") from error


class Network:
    """One network with one input called ``input``."""

    def __init__(self, folder: Path, name: str, outputs: tuple[str, ...]) -> None:
        """Opens ``folder/name``; calling it returns ``outputs`` in this order. Raises NetworkError."""
        self._session = open_session(read_checked(folder, name), str(folder / name))
        self._outputs = list(outputs)
        self.providers: tuple[str, ...] = tuple(self._session.get_providers())
        """What it does run on, the first choice first."""

    def __call__(self, values: NDArray[np.float32]) -> list[NDArray[np.float32]]:
        """The outputs asked for at opening."""
        return [np.asarray(output) for output in self._session.run(self._outputs, {"input": values})]
