"""Puts credentials into files: beside them first, so that a file is whole at every moment, signed or not yet."""

import io
import os
from contextlib import suppress
from pathlib import Path
from typing import Any

from ...models.wholefile import behind_links, marked
from ..errors import OutputError
from .localkey import LocalKey, key_file, local_key
from .statement import Statement, manifest

KINDS = {
    ".mp4": "video/mp4",
    ".mov": "video/quicktime",
    ".png": "image/png",
    ".jpg": "image/jpeg",
    ".jpeg": "image/jpeg",
}
"""Suffixes of files that can carry credentials, and what c2pa calls their kind."""
MISSING = "no credentials: the extra that signs is not installed; run pip install 'gemheads[credentials]'"
SPILLS_MB = 64
"""c2pa holds files up to this size in memory while it signs; larger ones go through a temporary file."""
OFFLINE = {"remote_manifest_fetch": False, "ocsp_fetch": False}
"""c2pa would otherwise follow addresses that are written in a file."""


class NoSignerError(OutputError):
    """The extra that signs is not installed."""


class Signer:
    """Signs with the key of this computer; from any thread."""

    def __init__(self, key: LocalKey | None = None) -> None:
        """``key``: the one of ``localkey``, made at first use, unless given. Raises NoSignerError, OutputError."""
        self._c2pa = c2pa_module()
        self._key = key or local_key(key_file())

    def sign(self, path: Path, statement: Statement) -> None:
        """Put credentials into a finished file. Raises OutputError; the file is then as it was."""
        kind = KINDS.get(path.suffix.lower())
        if kind is None:
            raise OutputError(f"{path}: no credentials, {path.suffix} files cannot carry any")
        path = behind_links(path)
        aside = path.with_name(f".{marked(path, 'signing').name}")
        try:
            with path.open("rb") as source, aside.open("w+b") as signed:
                self._signed(kind, source, signed, statement)
                signed.flush()
                os.fsync(signed.fileno())
            aside.replace(path)
        except (OSError, self._c2pa.C2paError) as error:
            raise OutputError(f"{path}: is whole, but carries no credentials ({error})") from error
        finally:
            with suppress(OSError):
                aside.unlink()

    def signed(self, picture: bytes, suffix: str, statement: Statement) -> bytes:
        """The bytes of a picture file with credentials in them. Raises OutputError."""
        result = io.BytesIO()
        try:
            self._signed(KINDS[suffix], io.BytesIO(picture), result, statement)
        except self._c2pa.C2paError as error:
            raise OutputError(f"the picture cannot be signed ({error})") from error
        return result.getvalue()

    def _signed(self, kind: str, source: Any, result: Any, statement: Statement) -> None:
        c2pa = self._c2pa
        info = c2pa.C2paSignerInfo(b"es256", self._key.chain_pem, self._key.private_pem, None)  # no time stamp
        settings = {
            "verify": OFFLINE,
            "builder": {"thumbnail": {"enabled": False}},
            "core": {"backing_store_memory_threshold_in_mb": SPILLS_MB},
        }
        with (
            c2pa.Context.from_dict(settings) as context,
            c2pa.Signer.from_info(info) as signer,
            c2pa.Builder(manifest(statement), context) as builder,
        ):
            builder.sign(signer, kind, source, result)


def open_signer() -> tuple[Signer | None, str]:
    """The signer of this computer; or None, and one sentence why, empty where the extra is simply not installed."""
    try:
        return Signer(), ""
    except NoSignerError:
        return None, ""
    except OutputError as error:
        return None, f"results carry no credentials: {error}"


def c2pa_module() -> Any:
    """The module c2pa. Raises NoSignerError where it is missing or does not load."""
    try:
        import c2pa  # pyright: ignore[reportMissingImports]
    except (ImportError, OSError, RuntimeError) as error:
        raise NoSignerError(MISSING) from error
    return c2pa
