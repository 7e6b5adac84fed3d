"""What the tools' command lines have in common."""

import sys


class Refusal(Exception):
    """Something to tell the user, without a traceback."""


def split(arguments, names, form="NAME=VALUE", more=True):
    """NAME=VALUE arguments as ({those of `names`}, {any others}). form: what is expected, in words;
    more: whether there may be others."""
    found = {}, {}
    for argument in arguments:
        name, _, value = argument.partition("=")
        if not name or not value or not (more or name in names):
            raise Refusal(f"'{argument}' is not of the form {form}")
        found[name not in names][name] = value
    return found


def whole(name, value):
    """An option's value as a number of things, of which there is one at least."""
    if not value.isdecimal() or int(value) < 1:
        raise Refusal(f"{name}={value}: a whole number is needed, 1 or more")
    return int(value)


def number(name, value, kind=float):
    """An option's value as a number."""
    try:
        return kind(value)
    except ValueError:
        raise Refusal(f"{name}={value}: a number is needed") from None


def start(name, main):
    """Ends the process with the status of main(arguments); a refusal is told in one line."""
    try:
        sys.exit(main(sys.argv[1:]))
    except Refusal as refusal:
        sys.exit(f"{name}: {refusal}")
    except KeyboardInterrupt:
        sys.exit(130)
