"""Output files and folders of a command line: checked before the work, not after it."""

from __future__ import annotations

import os
from argparse import ArgumentTypeError
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

#: Endings of the pictures that can be written.
PICTURE_ENDINGS = (".png", ".svg", ".pdf")

_ELSEWHERE = "name a folder where you may write, or change its permissions"


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Give the path to write a file to, which gets its name `path` at the end of a ``with`` block.

    A file that an error or a signal leaves half-written never has the name of a result. Devices,
    and files of a folder that takes no others, are written in place.

    Parameters
    ----------
    path
        The file.

    Yields
    ------
    pathlib.Path
        A file beside it with the same ending.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    target = path.resolve()
    if target.exists() and not (target.is_file() and os.access(target.parent, os.W_OK)):
        yield path
        return
    partial = target.with_name(f".{target.stem}.partial{target.suffix}")
    try:
        yield partial
        partial.replace(target)
    except OSError as error:
        if error.filename == str(partial):
            error.filename = str(path)
        raise
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)


def output_file(text: str) -> Path:
    """Return the path of a file to write: the `type` of an argument of `argparse`.

    Raises
    ------
    argparse.ArgumentTypeError
        If no file can be written there; it says what to do.
    """
    path = Path(text)
    if path.is_dir():
        raise ArgumentTypeError(f"cannot write {text}: it is a folder; name a file in it")
    if not path.parent.is_dir():
        raise ArgumentTypeError(
            f"cannot write {text}: there is no folder {path.parent}; make it first, or name a file "
            "elsewhere"
        )
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise ArgumentTypeError(f"cannot write {text}: not permitted; name a file elsewhere")
    return path


def output_picture(text: str) -> Path:
    """Return the path of a picture to write, as `output_file`."""
    path = output_file(text)
    if path.suffix.lower() not in PICTURE_ENDINGS:
        raise ArgumentTypeError(f"cannot write {text}: a picture ends with .png, .svg or .pdf")
    return path


def output_folder(text: str) -> Path:
    """Return the path of a folder to write to: the `type` of an argument of `argparse`.

    Raises
    ------
    argparse.ArgumentTypeError
        If the name is empty, which as a path would be the folder that one is in.
    """
    if not text.strip():
        raise ArgumentTypeError("the name of the folder is empty; the folder you are in is .")
    return Path(text)


def folder_path(name: str, given: object) -> Path:
    """Return the path of a folder that a program gives.

    Parameters
    ----------
    name
        The name of the argument, for messages.
    given
        The value of the argument.

    Raises
    ------
    TypeError
        If it is no path.
    """
    if isinstance(given, (str, os.PathLike)):
        return Path(given)
    raise TypeError(f"{name} must be the path of a folder, got {given!r}")


def make_folder(folder: Path) -> None:
    """Make a folder for results, unless it is there.

    Raises
    ------
    OSError
        If that cannot be done, or nothing can be written there; it says what to do.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OSError(f"cannot make the folder {folder}: {error.strerror}; {_ELSEWHERE}") from error
    if not os.access(folder, os.W_OK):
        raise PermissionError(f"cannot write to {folder}: {_ELSEWHERE}")


def check_output_folder(out: Path) -> None:
    """Check that the folder that `--out` names is there or can be made, and written to.

    Raises
    ------
    ValueError
        If a file is in the way.
    PermissionError
        If it cannot be written to.
    """
    for path in (out, *out.parents):
        if path.is_dir():
            if not os.access(path, os.W_OK):
                raise PermissionError(f"--out: cannot write to '{path}': {_ELSEWHERE}")
            return
        if path.exists():
            raise ValueError(
                f"--out: '{path}' is a file, and results go to a folder: choose another name, or "
                "move the file away"
            )
