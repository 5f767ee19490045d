"""docs/results.md: everything that was measured, printed of the reports that ``gemheads evaluate`` has written.

    python tests/bench/results.py REPORT... [--print]

Reports stand in the order that is given. What docs/peers.md, docs/gpu.md and docs/ablations.md hold (each says by which
command) is taken over. The page itself begins with the commands that make all of it anew (SEQUENCE).
"""

import argparse
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from gemheads.models.wholefile import write_whole
from results.sections import UnknownReport, section

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "results.md"
ELSEWHERE = {
    "peers.md": ("Beside other viewers", "python tests/bench/peers/compare.py --write"),
    "gpu.md": ("On a GPU", "python tests/bench/gpu_speed.py mara --docs docs/gpu.md"),
    "ablations.md": ("Open choices", "python tests/bench/ablations.py CAPTURE RUN --docs docs/ablations.md"),
}
"""Page in docs/ -> its heading here, and the command that prints it."""
SEQUENCE = """STEPS=1000 ITERATIONS=1200 examples/learn_an_avatar.sh learned capture mesh train distill refine
gemheads train learned/capture -o learned/rigged --model rigged --steps 1000
gemheads train learned/capture -o learned/blendshapes --model blendshapes --steps 1000
gemheads train learned/capture -o learned/run64 --maps 64 --steps 1000
gemheads distill learned/run64 -o learned/maps64.gem --components 30
gemheads evaluate learned/refined.gem learned/capture --shots 12 --components 5 10 20 30 -o build/results/learned \\
    --against learned/distilled.gem learned/maps64.gem learned/run learned/rigged learned/blendshapes
gemheads evaluate mara --against theo jonah --drivers CLIP... --every 6 --seconds 12 -o build/results/strangers
python tests/bench/peers/compare.py --write
python tests/bench/gpu_speed.py mara --docs docs/gpu.md
CAMERAS=10 SIZE=550x802 SPLIT=48+16 PRESET=full STEPS=2600 COMPONENTS=50 ITERATIONS=800 \\
    examples/learn_an_avatar.sh large capture train distill refine
gemheads evaluate large/refined.gem large/capture --shots 12 -o build/results/large
python tests/bench/ablations.py learned/capture learned/run --docs docs/ablations.md
python tests/bench/results.py build/results/learned build/results/large build/results/strangers"""
HEAD = f"""# Results

Printed by `python tests/bench/results.py REPORT...` of what `gemheads evaluate` wrote; each section says by which
command, when, and on which machine. *The paper's own figures stand in columns of their own: they are of another data
set (real people, 802x550) and another machine, and say what to expect, not who wins.* What the columns mean:
[commands.md](commands.md#evaluate). The way to these avatars, stage by stage: [learning.md](learning.md). Speed of
drawing: [speed.md](speed.md). People never seen, with film strips: [closed-loop.md](closed-loop.md).

All of it anew:

```
{SEQUENCE}
```
"""


def main() -> int:
    """The command; see ``--help``."""
    parser = argparse.ArgumentParser(description="Print docs/results.md from reports of gemheads evaluate.")
    parser.add_argument("reports", type=Path, nargs="+", help="folders with report.json")
    parser.add_argument("--print", action="store_true", help="only print, write nothing")
    options = parser.parse_args()
    try:
        text = results(options.reports)
    except (OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 3
    if options.print:
        print(text)
        return 0
    write_whole(PAGE, [text.encode()])
    print(PAGE.relative_to(ROOT))
    return 0


def results(reports: list[Path], docs: Path = PAGE.parent) -> str:
    """The page. Raises OSError, ValueError for what is no report, UnknownReport."""
    parts = [HEAD]
    for folder in reports:
        path = folder / "report.json"
        try:
            parts.append(section(json.loads(path.read_text("utf-8"))))
        except UnknownReport as error:
            raise UnknownReport(f"{path}: {error}") from error
    for name, (heading, command) in ELSEWHERE.items():
        tables = tables_of(docs / name)
        if tables:
            about = f"From [{name}]({name}), which says what was measured how."
            parts.append(f"## {heading}\n\n    {command}\n\n{about}\n\n{tables}\n")
    return "\n".join(parts)


def tables_of(page: Path) -> str:
    """The tables of a page, each with the paragraph or list right before it; empty where there is none."""
    if not page.is_file():
        return ""
    lines = [line for line in page.read_text("utf-8").splitlines() if not line.startswith(("#", "<!--"))]
    blocks = [block for block in map(str.strip, "\n".join(lines).split("\n\n")) if block]
    kept = [
        block
        for block, after in zip(blocks, [*blocks[1:], ""], strict=True)
        if block.startswith("|") or (after.startswith("|"))
    ]
    return "\n\n".join(kept)


if __name__ == "__main__":
    raise SystemExit(main())
