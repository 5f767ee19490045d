"""Kernels are compiled for vectors of 512 bits where that pays, and nowhere else."""

import os
import subprocess
import sys

import pytest
from gemheads.render.vectors import has_fast_wide_vectors
from llvmlite import binding

ASK = (
    "import {first}; from numba.core.registry import cpu_target;"
    "print(cpu_target.target_context.codegen().magic_tuple()[2])"
)


def compiled_for(first: str, **environment: str) -> str:
    """The features that numba compiles for in a new process that imports ``first`` first."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_CPU")}
    asked = [sys.executable, "-c", ASK.format(first=first)]
    return subprocess.run(asked, env=kept | environment, capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize("first", ["gemheads.render", "gemheads.models", "numba, gemheads.render"])
def test_wide_vectors_are_used_where_they_are_fast(first: str) -> None:
    wanted = has_fast_wide_vectors(binding.get_host_cpu_features())
    assert ("-prefer-256-bit" in compiled_for(first)) == wanted


def test_first_processors_with_512_bits_and_those_without_are_left_alone() -> None:
    assert has_fast_wide_vectors({"avx512f": True, "avx512vbmi2": True})
    assert not has_fast_wide_vectors({"avx512f": True, "avx512vbmi2": False})
    assert not has_fast_wide_vectors({"neon": True})


def test_what_the_user_says_is_kept() -> None:
    assert compiled_for("gemheads.render", NUMBA_CPU_NAME="generic", NUMBA_CPU_FEATURES="").strip() == ""
