"""The key that signs on this computer: made at first use, self-signed, and never sent anywhere."""

import os
import stat
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from ...models.wholefile import open_ordinary
from ..errors import OutputError

NAME = "gemheads on one computer, self-signed"
"""What others read as the signer. It names no person and no machine; anyone can make a certificate that says the same,
so it proves that a file was not changed, and not who made it."""
MAX_BYTES = 64 * 1024
_VALID = datetime(2020, 1, 1, tzinfo=UTC), datetime(2120, 1, 1, tzinfo=UTC)
"""Without a time stamp from the network a certificate has to outlive the files; clocks that jump change nothing."""


@dataclass(frozen=True)
class LocalKey:
    """A private key with its certificates."""

    private_pem: bytes
    chain_pem: bytes
    """The signing certificate, then the root that issued it."""

    @property
    def root_pem(self) -> bytes:
        """The root alone: what it issued is this computer's."""
        return self.chain_pem[self.chain_pem.rindex(b"-----BEGIN CERTIFICATE") :]


def key_file() -> Path:
    """Where it is; it need not exist."""
    import platformdirs

    return Path(platformdirs.user_data_dir("gemheads", appauthor=False)) / "credentials" / "signing-key.pem"


def existing_key(path: Path) -> LocalKey | None:
    """The key that is there, None where none was made yet. Raises OutputError when it cannot be used."""
    try:
        with open_ordinary(path) as (file, _):
            mode = stat.S_IMODE(os.fstat(file.fileno()).st_mode)
            text = file.read(MAX_BYTES)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise OutputError(f"{path}: the signing key cannot be read ({error.strerror}); {_ANEW}") from error
    if os.name == "posix" and mode & 0o077:
        raise OutputError(f"{path}: others may read this signing key; {_ANEW}")
    private, mark, chain = text.partition(b"-----BEGIN CERTIFICATE")
    if b"PRIVATE KEY" not in private or not mark:
        raise OutputError(f"{path}: holds no signing key; {_ANEW}")
    key = LocalKey(private, mark + chain)
    if not _fits(key):
        raise OutputError(f"{path}: the signing key in it is damaged; {_ANEW}")
    return key


def local_key(path: Path) -> LocalKey:
    """The key of this computer, made now where there is none. Raises OutputError."""
    if (key := existing_key(path)) is not None:
        return key
    made = _made()
    aside = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        try:
            with os.fdopen(os.open(aside, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "wb") as file:
                file.write(made.private_pem + made.chain_pem)
                file.flush()
                os.fsync(file.fileno())
            _named(aside, path)
        finally:
            with suppress(OSError):
                aside.unlink()
    except OSError as error:
        raise OutputError(f"{path}: the signing key cannot be kept ({error.strerror}); check the folder") from error
    key = existing_key(path)  # of two programs that begin at once, both use the one that was first
    assert key is not None
    return key


_ANEW = "delete it, and the next result makes a new one"


def _fits(key: LocalKey) -> bool:
    """Whether all of it can be read, and the first certificate is of this key: c2pa finds out when a result is done."""
    from cryptography import x509
    from cryptography.exceptions import UnsupportedAlgorithm
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    try:
        leaf, *_ = x509.load_pem_x509_certificates(key.chain_pem)
        return load_pem_private_key(key.private_pem, None).public_key() == leaf.public_key()
    except (ValueError, TypeError, UnsupportedAlgorithm):  # TypeError: of a key behind a password
        return False


def _named(aside: Path, path: Path) -> None:
    try:
        os.link(aside, path)
    except FileExistsError:
        pass
    except OSError:  # a file system without links
        aside.replace(path)


def _made() -> LocalKey:
    """A P-256 key, and a root that exists for this one certificate: its own key is forgotten here."""
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes, serialization
    from cryptography.hazmat.primitives.asymmetric import ec
    from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

    def named(common: str) -> x509.Name:
        names = ((NameOID.COMMON_NAME, common), (NameOID.ORGANIZATION_NAME, NAME))
        return x509.Name([x509.NameAttribute(*pair) for pair in names])

    key, root = ec.generate_private_key(ec.SECP256R1()), ec.generate_private_key(ec.SECP256R1())

    issuer = named("gemheads root")

    def issued(subject: str, public: ec.EllipticCurvePublicKey, authority: bool) -> bytes:
        usage = {"digital_signature": not authority, "key_cert_sign": authority, "crl_sign": authority}
        rest = ("content_commitment", "key_encipherment", "data_encipherment", "key_agreement")
        certificate = (
            x509.CertificateBuilder(issuer, named(subject), public, x509.random_serial_number(), *_VALID)
            .add_extension(x509.BasicConstraints(authority, 0 if authority else None), True)
            .add_extension(
                x509.KeyUsage(**usage, **dict.fromkeys(rest, False), encipher_only=False, decipher_only=False), True
            )
            .add_extension(x509.SubjectKeyIdentifier.from_public_key(public), False)
            .add_extension(x509.AuthorityKeyIdentifier.from_issuer_public_key(root.public_key()), False)
        )
        if not authority:  # a certificate that may sign content has to say for what it is
            certificate = certificate.add_extension(
                x509.ExtendedKeyUsage([ExtendedKeyUsageOID.EMAIL_PROTECTION]), False
            )
        return certificate.sign(root, hashes.SHA256()).public_bytes(serialization.Encoding.PEM)

    private = key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )
    chain = issued("gemheads", key.public_key(), False) + issued("gemheads root", root.public_key(), True)
    return LocalKey(private, chain)
