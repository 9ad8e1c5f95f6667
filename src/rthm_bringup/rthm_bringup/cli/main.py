"""Find the verbs, run one, and turn every failure into one line and an exit status."""

from __future__ import annotations

import gc
import os
import pkgutil
import signal
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Annotated, Any

import typer

from rthm_bringup.cli import verbs
from rthm_bringup.interruption import interrupted_by
from rthm_core.errors import InputError

UsageError = typer.BadParameter.__bases__[0]
ClickError: Any = UsageError.__bases__[0]

OVERFLOW = r"(overflow|invalid value|divide by zero) encountered"
"""Beginning of what numpy says of numbers that are not finite."""

BAD_INPUT, INTERRUPTED, FAULT = 2, 130, 1

OBJECTS_UNCHECKED = 50_000
"""New objects after which Python looks for garbage among them; what is imported is none."""


def application(asked: str | None = None) -> typer.Typer:
    """Command line with the verb that is `asked` for, or with every verb if there is none of that name."""
    app = typer.Typer(
        name="rthm",
        help="Real-time hybrid testing: run, simulate and understand a test.",
        no_args_is_help=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback()(_options)
    modules = _modules()
    for name in [asked] if asked in modules else modules:
        verb = import_module(f"{verbs.__name__}.{modules[name]}")
        listed = app.command(name, epilog=_examples(verb.EXAMPLES), short_help=_first(verb.verb))
        listed(verb.verb)
    return app


def _modules() -> dict[str, str]:
    """Module of every verb: ``import_`` of ``import``, ``check_driver`` of ``check-driver``."""
    names = [module.name for module in pkgutil.iter_modules(verbs.__path__)]
    return {name.rstrip("_").replace("_", "-"): name for name in names}


def _first(verb: Callable[..., int]) -> str:
    """First sentence of a verb's help, whole: the list of verbs cuts what it is not given."""
    return " ".join((verb.__doc__ or "").split("\n\n")[0].split())


def _examples(commands: tuple[str, ...]) -> str:
    """The last paragraph of a help, each command on a line of its own."""
    return "\b\n" + "\n".join(["Examples:", *(f"  {command}" for command in commands)])


def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=lambda asked: _version(asked),
            is_eager=True,
            help="Show the version and exit.",
        ),
    ] = False,
) -> None:
    pass


def _version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        print("rthm", version("rthm_bringup"))
        raise typer.Exit


def main() -> None:
    """Run the verb that the command line names; exit status 0, 1 (the work says no) or 2 (bad input)."""
    with _started_quickly(), interrupted_by(signal.SIGTERM), warnings.catch_warnings():
        # A motion without bounds is told in the words of each result.
        warnings.filterwarnings("ignore", OVERFLOW, RuntimeWarning)
        status = _status()
    sys.exit(status)


@contextmanager
def _started_quickly() -> Iterator[None]:
    """Look neither through what is imported for garbage, nor through what is installed for plugins of
    pydantic: each is a tenth of a start.
    """
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    gc.set_threshold(OBJECTS_UNCHECKED)
    try:
        yield
    finally:
        gc.freeze()  # else Python looks through all of it again when it ends


def _status() -> int:
    try:
        words = sys.argv[1:] or ["--help"]
        status = application(words[0])(words, standalone_mode=False, prog_name="rthm") or 0
        return _told("interrupted.", INTERRUPTED) if status == INTERRUPTED else status
    except InputError as error:
        return _told(str(error), BAD_INPUT)
    except ClickError as error:
        return _told(f"{error.format_message().rstrip('.')}; see {_path(error)} --help.", BAD_INPUT)
    except (KeyboardInterrupt, typer.Abort):
        return _told("interrupted.", INTERRUPTED)
    except BrokenPipeError:
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115 - whoever read the output has gone
        return FAULT
    except OSError as error:
        from rthm_core.files import ELSE, WAYS_OUT

        place = f"{error.filename}: " if error.filename else ""
        way_out = WAYS_OUT.get(error.errno or 0, ELSE)
        return _told(f"{place}{error.strerror or error}; {way_out}.", BAD_INPUT)
    except Exception as error:
        if os.environ.get("RTHM_TRACEBACK"):
            raise
        what = f"{type(error).__name__}: {error}".splitlines()[0]
        return _told(f"a fault in this program ({what}); RTHM_TRACEBACK=1 shows where.", FAULT)


def _told(sentence: str, status: int) -> int:
    print("rthm:", " ".join(sentence.split()), file=sys.stderr)
    return status


def _path(error: object) -> str:
    context = getattr(error, "ctx", None)
    return context.command_path if context else "rthm"
