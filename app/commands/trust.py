"""The command about where a file comes from: verify."""

from pathlib import Path


def verify(file: Path, /) -> int:
    """Say what a picture's or a video's content credentials tell: who signed it, whether it was changed, whose face.

    Exit code 0: signed and intact. 6: changed since it was signed. 7: no credentials. Needs the extra
    (pip install 'gemheads[credentials]'); follows no address that is written in the file.

    Args:
        file: A .mp4, .mov, .png or .jpg file, by whatever program.
    """
    from ..credentials.verify import run_verify

    return run_verify(file)
