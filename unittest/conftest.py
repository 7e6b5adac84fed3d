"""Lies here so that pytest, and processes that tests start, find scenes.py from the folders below."""

import os

os.environ["PYTHONPATH"] = os.pathsep.join([os.path.dirname(__file__), *filter(None, [os.environ.get("PYTHONPATH")])])
