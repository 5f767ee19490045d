"""The base installation goes with Apache-2.0, the lock covers what `make test` asks for, and the bill lists it all."""

import os
import re
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.version import Version

from .installed import Package, canonical, closure
from .licences import KNOWN, complaints
from .sbom import bill, locked

ROOT = Path(__file__).resolve().parents[2]
LOCK = (ROOT / ".ci" / "requirements.txt").read_text("utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
BY_BUILD = "torch"
"""Every index has another build of it: constraints.txt fixes its version, nothing its hash."""
PACKAGE = Package("thing", "1.0", "MIT", (), ())


def asked() -> list[Requirement]:
    """What `make test` installs, as pyproject.toml asks for it."""
    extras = PROJECT["project"]["optional-dependencies"]
    lines = [
        *PROJECT["project"]["dependencies"],
        *extras["train"],
        *extras["dev"],
        *PROJECT["build-system"]["requires"],
    ]
    return [Requirement(line) for line in lines]


def test_the_base_installation_holds_nothing_that_binds_its_users() -> None:
    base = closure()
    assert {"numpy", "av", "onnxruntime", "llvmlite"} <= set(base)  # what is needed by what is needed, too
    assert complaints(base) == []


@pytest.mark.parametrize(
    ("licence", "libraries", "fits"),
    [
        ("MIT", (), True),
        ("BSD-3-Clause AND MIT AND CC0-1.0", (), True),
        ("Apache Software License", ("libz",), True),
        ("GPL-2.0-or-later OR MIT", (), True),
        ("GPL-3.0-or-later", (), False),
        ("GNU General Public License v3 (GPLv3)", (), False),
        ("GNU Affero General Public License v3", (), False),
        ("LGPL-2.1", (), False),
        ("CC-BY-NC-4.0", (), False),
        ("Free for non-commercial use", (), False),
        ("Some Licence Of Our Own", (), False),
        ("", (), False),
        ("MIT", ("libx264",), False),
    ],
)
def test_a_licence_that_does_not_fit_is_found(licence: str, libraries: tuple[str, ...], fits: bool) -> None:
    found = complaints({"thing": replace(PACKAGE, licence=licence, libraries=libraries)})
    assert (found == []) is fits
    assert all(sentence.startswith("thing 1.0 ") for sentence in found)


def test_what_wheels_bring_under_the_gpl_is_told() -> None:
    told = (ROOT / "SECURITY.md").read_text("utf-8")
    for package, library in KNOWN:
        assert package in told
        assert library in told


def test_the_lock_covers_all_that_is_asked_for_with_hashes() -> None:
    versions = dict(locked(LOCK).keys())
    for wanted in asked():
        if wanted.name == BY_BUILD:
            assert wanted.name not in versions
            continue
        assert canonical(wanted.name) in versions, f"run .ci/lock: {wanted.name} is not in the lock"
        assert wanted.specifier.contains(Version(versions[canonical(wanted.name)]), prereleases=True), wanted
    lines = [line for line in LOCK.splitlines() if re.match(r"\w", line)]
    assert len(lines) == len(versions) == len(locked(LOCK))
    assert all(locked(LOCK).values())
    assert "://" not in LOCK


def test_the_lock_agrees_with_the_constraints() -> None:
    versions = dict(locked(LOCK).keys())
    for line in (ROOT / "constraints.txt").read_text("utf-8").splitlines():
        if line and not line.startswith(("#", BY_BUILD)):
            wanted = Requirement(line)
            assert wanted.specifier.contains(Version(versions[canonical(wanted.name)])), line


def test_the_lock_is_used_only_where_it_was_made_for() -> None:
    here = subprocess.run([sys.executable, str(ROOT / ".ci" / "lock"), "--here"], capture_output=True, text=True)
    assert re.fullmatch(r"# for: CPython 3\.\d+, \w+, \w+\n", here.stdout)
    assert re.fullmatch(r"# for: CPython 3\.\d+, \w+, \w+", LOCK.splitlines()[0])


def test_the_bill_lists_everything_once_and_nothing_that_changes() -> None:
    packages = closure(frozenset({"credentials"}))
    document = bill(packages, locked(LOCK))
    assert document == bill(packages, locked(LOCK))
    assert document["bomFormat"] == "CycloneDX"
    refs = [component["bom-ref"] for component in document["components"]]
    assert len(refs) == len(set(refs)) == len(packages)
    ours = document["metadata"]["component"]["bom-ref"]
    assert {edge["ref"] for edge in document["dependencies"]} == {*refs, ours}
    assert {each for edge in document["dependencies"] for each in edge["dependsOn"]} <= set(refs)
    assert all(component["licenses"][0]["license"]["name"] != "not stated" for component in document["components"])
    (av,) = [component for component in document["components"] if component["name"] == "av"]
    assert av["purl"].startswith("pkg:pypi/av@")


def test_ci_checks_the_hashes_before_anything_else_is_installed(tmp_path: Path) -> None:
    """.ci/run with a make that says what it was given, .ci/install with a pip that says what it is asked for."""
    bin_folder, log = tmp_path / "bin", tmp_path / "log"
    bin_folder.mkdir()
    stands_in(bin_folder / "make", 'echo "CI=$CI"')
    stands_in(bin_folder / "pip", f'echo "$@" >> {log}')
    stands_in(bin_folder / "python", f"echo '{LOCK.splitlines()[0]}'")
    path = f"{bin_folder}:{os.environ['PATH']}"
    plain = {name: value for name, value in os.environ.items() if name != "CI"} | {"PATH": path}
    run = subprocess.run([str(ROOT / ".ci" / "run")], env=plain, capture_output=True, text=True, check=True)
    assert run.stdout == "CI=true\n"

    install = [str(ROOT / ".ci" / "install"), str(bin_folder), "[train,dev]"]
    subprocess.run(install, env=plain | {"CI": "true"}, check=True)
    first, second = log.read_text().splitlines()
    assert first == "install --quiet --require-hashes --requirement .ci/requirements.txt"
    assert second.startswith("install --quiet --constraint constraints.txt")
    log.unlink()
    subprocess.run(install, env=plain, check=True)  # on anybody's computer the constraints are enough
    assert "--require-hashes" not in log.read_text()


def stands_in(path: Path, line: str) -> None:
    """A program that does nothing but this."""
    path.write_text(f"#!/bin/sh\n{line}\n")
    path.chmod(0o755)
