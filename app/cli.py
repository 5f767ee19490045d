"""The ``gemheads`` command: its commands, and how what goes wrong in them is told."""

import io
import os
import sys
from itertools import pairwise

from cyclopts import App, CycloptsError

from .commands import avatars, driven, learning, live, machine, trust
from .errors import NO_ROOM, CommandError, ExitCode, lacks_memory, lacks_room, no_way_to

EXIT_CODES = """Exit codes: 0 done, 1 unexpected failure, 2 wrong usage, 3 an input cannot be used, 4 no face anywhere,
5 the output cannot be written, 6 and 7 verify found changes or no credentials, 130 stopped with Ctrl-C. Errors are one
line on stderr; --debug adds the traceback."""
MAY_BE_EMPTY = ("--author", "--licence", "--consent", "--no-badge")
"""Options that take any text."""
FULL = "the memory is full; close other programs, or ask for less (--size, --components)"

app = App(
    name="gemheads",
    help="A face video in, an acting 3D head out: offline, on an ordinary computer.",
    help_epilogue=EXIT_CODES,
    version_flags=["--version"],
    suppress_keyboard_interrupt=False,
)

for command in (
    *(live.live, driven.reenact, driven.demo, driven.track),
    *(avatars.info, avatars.modes, avatars.export, avatars.distill, avatars.fit, avatars.train_regressor),
    *(learning.capture, learning.train, learning.refine, learning.evaluate),
    *(machine.bench, machine.doctor, trust.verify),
):
    app.command(command)


def main(arguments: list[str] | None = None) -> int:
    """Run one command; returns the exit code of docs/commands.md. The entry point of ``gemheads``."""
    # Idle workers of BLAS (107 -> 87 ms a picture without) and of the kernels (beside a busy tracker, composing takes
    # 60 ms instead of 6) spin and starve the other stages. Both must be set before NumPy and numba come.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    if isinstance(sys.stdout, io.TextIOWrapper):  # a name that the terminal cannot write must not end what is done
        sys.stdout.reconfigure(errors="backslashreplace")
    arguments = sys.argv[1:] if arguments is None else arguments
    debug = "--debug" in arguments
    if empty := _empty(arguments):
        print(f"error: {empty}", file=sys.stderr)
        return ExitCode.USAGE
    try:
        result = app(
            [word for word in arguments if word != "--debug"],
            exit_on_error=False,
            print_error=False,
            result_action="return_value",
        )
        return int(result or ExitCode.OK)
    except CycloptsError as error:
        print(f"error: {error} See gemheads --help.", file=sys.stderr)
        return ExitCode.USAGE
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return ExitCode.INTERRUPTED
    except BrokenPipeError:
        return ExitCode.OUTPUT
    except CommandError as error:
        if debug:
            raise
        _say(str(error))
        return error.code
    except Exception as error:
        if debug:
            raise
        if lacks_room(error):
            _say(NO_ROOM)
            return ExitCode.OUTPUT
        if said := no_way_to(error):
            _say(said)
            return ExitCode.INPUT
        told = f"unexpected {type(error).__name__}: {error}; run again with --debug to see where"
        _say(FULL if lacks_memory(error) else told)
        return ExitCode.UNEXPECTED


def _say(error: str) -> None:
    """One line on stderr; what came out of a file steers no terminal."""
    shown = (char if char.isprintable() or "\ud800" <= char <= "\udfff" else " " for char in error)
    print(f"error: {''.join(shown)}", file=sys.stderr)  # half a pair of surrogates: a file name that is no Unicode


def _empty(arguments: list[str]) -> str:
    """What is wrong with an empty word, which a shell makes of a variable that is not set: as a path it would be the
    current folder."""
    for before, word in pairwise(["", *arguments]):
        if not word.strip() and before not in MAY_BE_EMPTY:
            return f"{before or 'the first argument'}: an empty word follows; give a name (is a variable not set?)"
    return ""


if __name__ == "__main__":
    sys.exit(main())
