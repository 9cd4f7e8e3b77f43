"""Exceptions, with the messages of the command line."""

from __future__ import annotations


class AmigoError(Exception):
    """Any error of this package."""


class InputError(AmigoError, ValueError):
    """Wrong arguments, files or data; the message gives the place, the problem and the remedy."""


class ColumnError(InputError):
    """A recording lacks a column that its column names require."""


class RunError(AmigoError, RuntimeError):
    """A computation has no result: no fit exists, or the model cannot be simulated."""
