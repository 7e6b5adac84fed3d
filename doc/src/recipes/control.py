"""Holds the mean velocity of the channel of in.python with a PI controller: reads a variable of
LAMMPS and sets another, every 20 steps."""

from lammps import lammps

WANTED = 0.1  # [m/s]
lmp = lammps(cmdargs=["-screen", "none"])
lmp.file("in.python")
lmp.command("run 0 post no")
total = 0.0
for k in range(100):
    error = WANTED - lmp.extract_variable("speed")
    total += error
    lmp.set_internal_variable("push", 10.0 * error + 0.1 * total)
    lmp.command("run 20 pre no post no")
    if k % 10 == 0:
        print(f"{lmp.extract_variable('speed'):.4f} m/s with {lmp.extract_variable('push'):.4f} "
              "m/s^2", flush=True)
