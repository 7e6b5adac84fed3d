"""The largest run that this machine's memory holds: still water in 3D, with its restart file
written and read. tools/cost largest"""

import shutil
import tempfile
from pathlib import Path

import measure
from scaling import STILL, seconds_of_files
from tool import Job

from fsi import log
from fsi.command import split, start, whole


def measured(edge, kept_log):
    """{what: (value, unit)} of a cube of edge^3 particles; its log is kept. Times of a step and of
    files are by the clock."""
    with tempfile.TemporaryDirectory(prefix="fsi_cost_") as name:
        folder = Path(name)
        whole_run, peak = measure.seconds(folder,
                                          STILL.replace("N", str(edge), 1)), measure.peak(folder)
        shutil.copyfile(folder / "log.lammps", kept_log)
        file = (folder / "still.restart").stat().st_size
    steps, files = log.read(kept_log).finished[-1], seconds_of_files(kept_log.read_text())
    return {"particles": (edge**3, ""), "peak of the memory": (peak / 2**30, "GB"),
            "whole run": (whole_run, "s"), "a step": (steps.loop_seconds / steps.steps, "s"),
            "restart file": (file / 2**30, "GB"), "write_restart": (files["write"], "s"),
            "read_restart": (files["read"], "s")}


def main(arguments):
    """tools/cost largest [edge=311]"""
    options, _ = split(arguments, ("edge", "out"), "edge=N or out=FOLDER", more=False)
    edge = whole("edge", options.pop("edge", "311"))
    job = Job("largest", [f"{name}={value}" for name, value in options.items()])
    found = measured(edge, job.folder / "largest.log")
    rows = [{"what": what, "value": value, "unit": unit} for what, (value, unit) in found.items()]
    job.write(("what", "value", "unit"), rows, 4, line(rows) + "\n")
    return 0


def line(rows):
    """In one sentence."""
    of = {row["what"]: row["value"] for row in rows}
    return (f"- The largest run: {of['particles'] / 1e6:.0f} million particles on one rank, "
            f"{of['peak of the memory']:.1f} GB "
            f"(`tools/cost largest`, [log](largest.log)).")


if __name__ == "__main__":
    start("cost", main)
