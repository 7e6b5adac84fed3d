"""How far something is that takes long, on the terminal."""

import sys
import time


class Progress:
    """Called with what is done, 0 to 1, it says so once a second: on a terminal in one line that
    renews itself, elsewhere after ten seconds and then each tenth of the way."""

    def __init__(self, what):
        self.what, self.began, self.said, self.tenth = what, time.monotonic(), 0.0, 0

    def __call__(self, done):
        spent = time.monotonic() - self.began
        left = f"{self.what}: {100 * done:.0f} %" + (f", {spent / done - spent:.0f} s left" if done
                                                     > 0 and done < 1 else "")
        if sys.stderr.isatty():
            if spent - self.said > 1.0:
                self.said = spent
                print(f"\r\033[K{left}", end="", file=sys.stderr, flush=True)
            if done >= 1 and self.said:
                print("\r\033[K", end="", file=sys.stderr, flush=True)
        elif spent > 10.0 and int(10 * done) > self.tenth and done < 1:
            self.tenth = int(10 * done)
            print(left, file=sys.stderr, flush=True)
