"""Reads the credentials of a file and says what they are worth. Follows no address that is written in it."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from ..errors import InputError, OutputError
from .localkey import existing_key, key_file
from .origin import plain
from .signing import KINDS, OFFLINE, c2pa_module
from .statement import LABEL

UNTRUSTED = "signingCredential.untrusted"
"""Said of every signer that is on no list: ours too, and it does not mean that the file was changed."""
TRUSTED, VALIDATED = "signingCredential.trusted", "claimSignature.validated"
"""Said of a signer that is on the list, and of a signature that is this signer's, whatever became of the file since."""
_KINDS = ", ".join(KINDS)


@dataclass(frozen=True)
class Verdict:
    """What the credentials of one file say."""

    state: Literal["intact", "altered", "none"]
    signer: str = ""
    """Whose signature it is; empty where the signature itself was changed, and could be anybody's."""
    own: bool = False
    """Whether the key of this computer signed."""
    generator: str = ""
    """The program that made the file."""
    source_type: str = ""
    """IPTC's word for how it came to be."""
    ours: Mapping[str, Any] | None = None
    """The statement of ``statement.manifest``; None in what another program made."""
    problems: tuple[str, ...] = ()
    """What does not fit, in c2pa's words."""


def read_credentials(path: Path) -> Verdict:
    """The verdict on a file. Raises InputError when it is no file that could carry credentials; NoSignerError."""
    c2pa = c2pa_module()
    root = _own_root()
    settings = {"verify": {**OFFLINE, "verify_trust": True}, "trust": {"user_anchors": root} if root else {}}
    if not path.is_file():
        raise InputError(f"{path}: no such file; check the path")
    try:
        with c2pa.Context.from_dict(settings) as context, c2pa.Reader(str(path), context=context) as reader:
            state, active = reader.get_validation_state(), reader.get_active_manifest()
            checks = reader.get_validation_results()
    except c2pa.C2paError.ManifestNotFound:
        return Verdict("none")
    except (c2pa.C2paError.NotSupported, c2pa.C2paError.Io) as error:
        raise InputError(
            f"{path}: this kind of file cannot carry credentials ({plain(str(error))}); give a {_KINDS} file"
        ) from error
    except c2pa.C2paError as error:
        if str(error).startswith("Remote"):
            return Verdict("none", problems=(f"they lie elsewhere, and nothing is fetched ({plain(str(error))})",))
        return Verdict("altered", problems=(plain(str(error)),))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check its permissions") from error
    return _verdict(state, active or {}, checks or {})


def _own_root() -> str:
    """The root of this computer's key; empty where none was made, or it cannot be used."""
    try:
        key = existing_key(key_file())
    except OutputError:
        return ""
    return key.root_pem.decode("ascii") if key else ""


def _verdict(state: str | None, active: Mapping[str, Any], checks: Mapping[str, Any]) -> Verdict:
    told = _table(checks, "activeManifest")
    holds = {item.get("code") for item in told.get("success", [])}
    failures = [item for item in told.get("failure", []) if item.get("code") != UNTRUSTED]
    signs = VALIDATED in holds
    signature, generators = _table(active, "signature_info"), active.get("claim_generator_info") or [{}]
    assertions = {item.get("label"): item.get("data") for item in active.get("assertions", [])}
    actions = assertions.get("c2pa.actions.v2") or assertions.get("c2pa.actions") or {}
    types = [action.get("digitalSourceType", "") for action in actions.get("actions", [])]
    ours = assertions.get(LABEL)
    return Verdict(
        state="intact" if state in ("Valid", "Trusted") and not failures else "altered",
        signer=plain(str(signature.get("issuer") or signature.get("common_name") or "nobody")) if signs else "",
        own={TRUSTED, VALIDATED} <= holds,
        generator=plain(" ".join(str(generators[0].get(key, "")) for key in ("name", "version"))).strip(),
        source_type=plain(next((kind.rsplit("/", 1)[-1] for kind in types if kind), "")),
        ours=ours if isinstance(ours, dict) else None,
        problems=tuple(plain(f"{item.get('explanation')} ({item.get('code')})") for item in failures),
    )


def _table(tree: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    value = tree.get(key)
    return value if isinstance(value, dict) else {}
