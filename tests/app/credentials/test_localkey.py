"""The key of this computer: made once, for its owner alone, and never in the way."""

import os
import stat
from pathlib import Path

import pytest
from gemheads.app.credentials.localkey import NAME, existing_key, local_key
from gemheads.app.credentials.signing import open_signer
from gemheads.app.errors import OutputError

pytest.importorskip("cryptography", reason="the extra gemheads[credentials] is not installed")


def test_it_is_made_once(tmp_path: Path) -> None:
    path = tmp_path / "new" / "key.pem"
    assert existing_key(path) is None
    first = local_key(path)
    assert local_key(path) == first == existing_key(path)
    assert [file.name for file in path.parent.iterdir()] == ["key.pem"]
    assert local_key(tmp_path / "other.pem").private_pem != first.private_pem


@pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX")
def test_it_is_for_its_owner_alone(tmp_path: Path) -> None:
    path = tmp_path / "folder" / "key.pem"
    local_key(path)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
    path.chmod(0o644)
    with pytest.raises(OutputError, match="others may read this signing key; delete it"):
        local_key(path)


def test_its_certificates_name_nobody_and_outlive_the_files(tmp_path: Path) -> None:
    from cryptography import x509

    leaf, root = x509.load_pem_x509_certificates(local_key(tmp_path / "key.pem").chain_pem)
    assert {name.value for name in (*leaf.subject, *root.subject)} == {"gemheads", "gemheads root", NAME}
    assert leaf.not_valid_before_utc.year == 2020
    assert leaf.not_valid_after_utc.year == 2120
    leaf.verify_directly_issued_by(root)
    assert x509.load_pem_x509_certificate(local_key(tmp_path / "key.pem").root_pem) == root


@pytest.mark.parametrize("content", [b"", b"no key", b"\xff" * 100000, b"-----BEGIN CERTIFICATE-----"])
def test_what_is_no_key_is_refused_with_the_cure(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "key.pem"
    path.write_bytes(content)
    path.chmod(0o600)
    with pytest.raises(OutputError, match="delete it, and the next result makes a new one"):
        local_key(path)


@pytest.mark.parametrize("part", [b"PRIVATE KEY-----\n", b"CERTIFICATE-----\n"])
def test_a_key_that_is_garbled_inside_is_found_before_anything_is_signed(part: bytes, tmp_path: Path) -> None:
    path = tmp_path / "key.pem"
    local_key(path)
    content = path.read_bytes()
    assert content.count(part) > 1
    path.write_bytes(content.replace(part, part + b"AAAA", 1))
    with pytest.raises(OutputError, match=r"the signing key in it is damaged; delete it"):
        existing_key(path)


def test_a_key_with_the_certificates_of_another_is_found(tmp_path: Path) -> None:
    keys = [local_key(tmp_path / name) for name in ("a.pem", "b.pem")]
    (tmp_path / "a.pem").write_bytes(keys[0].private_pem + keys[1].chain_pem)
    with pytest.raises(OutputError, match="damaged"):
        existing_key(tmp_path / "a.pem")


def test_a_folder_that_takes_no_key_is_told_and_stops_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setattr("gemheads.app.credentials.signing.key_file", lambda: tmp_path / "file" / "key.pem")
    signer, trouble = open_signer()
    assert signer is None
    assert "results carry no credentials" in trouble
