"""`python3 -m fsi`, and the command `fsi` where it is installed. What it does is in fsi/cli.py.

The first python on the PATH may lack numpy and matplotlib where another has them: then that one
goes on.
"""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

NEEDED = ("numpy", "matplotlib")


def able_python():
    """Path of a python that has what is needed; None if there is none."""
    check = ("import sys, importlib.util as u; sys.exit(not all(u.find_spec(m) for m in "
             "sys.argv[1:]))")
    for candidate in ("python3", "/usr/bin/python3", "/usr/local/bin/python3"):
        try:
            if subprocess.run([candidate, "-c", check, *NEEDED], stderr=subprocess.DEVNULL,
                              check=False).returncode == 0:
                return candidate
        except OSError:
            pass
    return None


def main(arguments=None):
    """Hands on to the command line's own main."""
    missing = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if missing:
        other = able_python()
        if other is None:
            sys.exit(f"fsi: {sys.executable} has no {' and no '.join(missing)}, nor has another "
                     "python here: install them "
                     f"(Debian: apt-get install {' '.join(f'python3-{name}' for name in NEEDED)}; "
                     "then /usr/bin/python3 -m fsi)")
        places = [str(Path(__file__).resolve().parents[1]),
                  *filter(None, [os.environ.get("PYTHONPATH")])]
        os.environ["PYTHONPATH"] = os.pathsep.join(places)
        os.execvp(other, [other, "-m", "fsi", *sys.argv[1:]])
    from .cli import main as run  # needs them
    return run(arguments)


if __name__ == "__main__":
    main()
