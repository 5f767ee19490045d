"""A Python program in which the first socket of the network kills: native libraries too, which no patch would stop."""

import platform
import subprocess
import sys

import pytest

SOCKET_CALL = {"x86_64": 41, "aarch64": 198}
KILLED = -31
"""Exit code of a program that asked for a socket: minus SIGSYS."""
_SEAL = """
import ctypes, struct
libc = ctypes.CDLL(None, use_errno=True)
steps = [  # load the call's number; anything but socket() may pass; so may socket(AF_UNIX); the rest kills the process
    (0x20, 0, 0, 0), (0x15, 0, 3, {number}), (0x20, 0, 0, 16), (0x15, 1, 0, 1), (0x06, 0, 0, 0x80000000),
    (0x06, 0, 0, 0x7FFF0000),
]
code = ctypes.create_string_buffer(b"".join(struct.pack("=HBBI", *step) for step in steps))
program = struct.pack("@HxxxxxxP", len(steps), ctypes.addressof(code))
assert libc.prctl(38, 1, 0, 0, 0) == 0
if libc.prctl(22, 2, ctypes.c_char_p(program), 0, 0) != 0:
    raise SystemExit(77)
"""
REFUSED = 77


def can_seal() -> bool:
    """Whether a program can be sealed on this system."""
    return sys.platform.startswith("linux") and platform.machine() in SOCKET_CALL


def seal() -> str:
    """What such a program begins with; those that it starts inherit it. Skips where no system call can be forbidden."""
    if not can_seal():
        pytest.skip("no system call can be forbidden here (Linux on x86_64 or aarch64 only)")
    return _SEAL.format(number=SOCKET_CALL[platform.machine()])


def run_sealed(program: str, *words: str, timeout: float = 120) -> subprocess.CompletedProcess[str]:
    """Runs a program with these arguments; it ends with KILLED at the first socket. Skips where there is no seccomp."""
    done = subprocess.run(
        [sys.executable, "-c", seal() + program, *words], capture_output=True, text=True, timeout=timeout, check=False
    )
    skip_where_refused(done)
    return done


def skip_where_refused(done: subprocess.CompletedProcess[str]) -> None:
    """Skips the test where a program could not seal itself."""
    if done.returncode == REFUSED:
        pytest.skip("this system does not let a program forbid itself system calls")
