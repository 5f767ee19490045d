"""Neither signing nor reading opens a socket, whatever a file asks for."""

from pathlib import Path

import pytest
from sealed import KILLED, run_sealed

from .conftest import write_file

SIGN_AND_READ = """
import sys
from pathlib import Path
from gemheads.app.credentials.localkey import local_key
from gemheads.app.credentials.reading import read_credentials
from gemheads.app.credentials.signing import Signer
from gemheads.app.credentials.statement import Driver, Statement

Signer(local_key(Path(sys.argv[1]))).sign(Path(sys.argv[2]), Statement((), Driver("live")))
print(read_credentials(Path(sys.argv[2])).state)
"""
READ = """
import sys
from pathlib import Path
from gemheads.app.credentials.reading import read_credentials

print(read_credentials(Path(sys.argv[1])).state)
"""
CAREFREE = """
import sys
import c2pa

c2pa.Reader(sys.argv[1])
"""


@pytest.fixture(autouse=True)
def _installed() -> None:
    pytest.importorskip("c2pa", reason="the extra gemheads[credentials] is not installed")


def test_the_seal_holds() -> None:
    assert run_sealed("import socket; socket.socket()").returncode == KILLED
    assert run_sealed("print('still here')").stdout == "still here\n"


@pytest.mark.parametrize("name", ["a.png", "a.mp4"])
def test_signing_and_reading_open_no_socket(name: str, tmp_path: Path) -> None:
    done = run_sealed(SIGN_AND_READ, str(tmp_path / "key.pem"), str(write_file(tmp_path / name)))
    assert (done.returncode, done.stdout) == (0, "intact\n"), done.stderr


def test_an_address_in_a_file_is_not_followed(tmp_path: Path) -> None:
    """A file whose credentials lie elsewhere; c2pa left to itself would go and fetch them."""
    import c2pa
    from gemheads.app.credentials.localkey import local_key
    from gemheads.app.credentials.statement import Driver, Statement, manifest

    key = local_key(tmp_path / "key.pem")
    info = c2pa.C2paSignerInfo(b"es256", key.chain_pem, key.private_pem, None)
    source, path = write_file(tmp_path / "a.jpg"), tmp_path / "b.jpg"
    with c2pa.Signer.from_info(info) as signer, c2pa.Builder(manifest(Statement((), Driver("live")))) as builder:
        builder.set_no_embed()
        builder.set_remote_url("http://127.0.0.1:9/credentials")
        builder.sign_file(str(source), str(path), signer)
    assert b"127.0.0.1:9" in path.read_bytes()
    assert run_sealed(CAREFREE, str(path)).returncode == KILLED
    done = run_sealed(READ, str(path))
    assert (done.returncode, done.stdout) == (0, "none\n"), done.stderr
