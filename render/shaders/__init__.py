"""GLSL 3.30 sources, one file each, and their loader."""

from importlib.resources import files


def load(name: str, **constants: int | float) -> str:
    """The source ``name``.glsl with a #define for each constant.

    Raises:
        FileNotFoundError: where the package has no such file.
    """
    source = (files(__package__ or __name__) / f"{name}.glsl").read_text("utf-8")
    defines = "".join(f"#define {key} {value!r}\n" for key, value in constants.items())
    return f"#version 330 core\n{defines}{source}"
