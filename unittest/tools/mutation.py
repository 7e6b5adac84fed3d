#!/usr/bin/env python3
"""Do the tests notice wrong numerics? Flips operators and constants of src/FSI one by one and runs the tests on each.

usage: mutation.py [NUMBER ...]     (of the mutations to try; default: all; about ten seconds each)

Works on a copy of the project in a temporary folder; a mutation that no test fails for has survived. Status 1 if more than a
tenth do.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# file, what is there, what is put there instead, tests that look at it (pytest files, or a ctest name)
FLUID, SOLID, HUB = "pair_fsi_fluid.cpp", "pair_fsi_solid.cpp", "fix_fsi.cpp"
ROWS, BOND_ROWS = "fsi_fluid_rows.h", "fsi_bond_rows.h"
TL, BONDS = "pair_fsi_solid_tl.cpp", "fix_fsi_reference.cpp"
MUTATIONS = [
    (HUB, "const double dth = 0.5 * update->dt;\n  for", "const double dth = 0.51 * update->dt;\n  for", "integrator"),
    (HUB, "dt = update->dt, dtf = dt * force->ftm2v, dth = 0.5 * dt", "dt = update->dt, dtf = dt * force->ftm2v, dth = 0.49 * dt", "integrator"),
    (HUB, "v[i][d] += dtfm * f[i][d];", "v[i][d] -= dtfm * f[i][d];", "integrator"),
    (FLUID, "rho[i] + dt * rate[i]", "rho[i] + 0.99 * dt * rate[i]", "density integrator"),
    (SOLID, "rho[i] *= (1.0 - 0.5 * dt * div) / (1.0 + 0.5 * dt * div);", "rho[i] *= (1.0 + 0.5 * dt * div) / (1.0 - 0.5 * dt * div);", "solid integrator"),
    ("fsi_number_density.cpp", "rho[i] = rmass[i] * psi[i]", "rho[i] = rmass[i] * (psi[i] - 1.0)", "density"),
    ("fsi_number_density.cpp", "rho[i] = ratio[i] * psi[i]", "rho[i] = ratio[i] + psi[i]", "density"),
    (HUB, "rmass[i] = s.rho0 / resolution[atom->type[i]].psi_bulk", "rmass[i] = s.rho0 * dx * dx", "density"),
    ("fsi_scene.cpp", "psi[i] <= surface_ratio * psi_reference", "psi[i] > surface_ratio * psi_reference", "surface density"),
    ("fsi_body_forces.cpp", "of_type[t][d] += field.g[d]", "of_type[t][d] -= field.g[d]", "density energy gravity"),
    (SOLID, "L[k] = full[k] * inv;", "L[k] = full[k];", "solid"),
    (FLUID, "const double dth = 0.5 * dt;", "const double dth = 0.0;", "density integrator"),
    (ROWS, "rate_j = pj.rho * pj.vol * s;", "rate_j = -pj.rho * pj.vol * s;", "density"),
    (ROWS, "return pi.pv2 + pj.pv2;", "return pi.pv2 - pj.pv2;", "walls momentum density"),
    (ROWS, "fluid.c < other.c ? fluid.c : other.c;", "fluid.c > other.c ? fluid.c : other.c;", "interface momentum"),
    (ROWS, "return pi.pv2 + greater(p, T(floor)) * (back * pj.vol)", "return pi.pv2 - greater(p, T(floor)) * (back * pj.vol)", "interface"),
    (ROWS, "? greater(both, T(0.0)) : both;", "? both : both;", "interface"),
    (ROWS, "shear[d] * v2g;", "-shear[d] * v2g;", "interface"),
    (ROWS, "p += q;", "p -= q;", "viscosity"),
    ("fsi_viscosity_laminar.h", "f[d] += k * rsq * v_ij[d];", "f[d] -= k * rsq * v_ij[d];", "viscosity"),
    ("fsi_viscosity_laminar.h", "f[d] += (D + 2) * k * vx * x_ij[d];", "f[d] += 4 * k * vx * x_ij[d];", "walls"),
    ("fsi_shift.h", "sum[2 * D] -= vg * rsq;", "sum[2 * D] += vg * rsq;", "shift"),
    ("fsi_shift.h", "vg * (1.0 + 0.2 * (qq * qq))", "vg", "shift"),
    (ROWS, "-mirror.sign[d] * x[d] : -x[d];", "-x[d] : -x[d];", "shift"),
    ("fsi_fields.cpp", "for (int c = 0; c < m; c++) a[c] += *buf++;", "buf += m;", "parallel"),
    (ROWS, "if (newton) return T(1.0);", "return T(1.0);", "walls parallel"),
    (ROWS, "mirror.rubbing_sign[d] * u;", "mirror.sign[d] * u;", "walls"),
    (ROWS, "(KIND == WITH_FLUID ? other : fluid).viscosity", "other.viscosity", "wall_particles interface"),
    ("pair_fsi_fluid.cpp", "2.0 * v[d] - s[d] / s[dim]", "v[d]", "interface"),
    (ROWS, "rate_j -= k * pi.vol;", "rate_j += k * pi.vol;", "density parallel"),
    (ROWS, "-mirror.sign[d] * force[d] : -force[d];", "-force[d] : -force[d];", "walls parallel"),
    (ROWS, "f[i][d] += L::sum(sum[d]);", "f[i][d] += 0.999999 * L::sum(sum[d]);", "momentum"),
    (ROWS, "j[k] == row.i ? 0.5 : 1.0", "1.0", "walls parallel"),
    (ROWS, "-weight * rsq * kernel.gradient(r)", "weight * rsq * kernel.gradient(r)", "surface"),
    (SOLID, "const double t = -g * vij[a] * xij[b];", "const double t = g * vij[a] * xij[b];", "solid"),
    (SOLID, "xij[d] = x[i][d] - x[j][d] - dth * vij[d];", "xij[d] = x[i][d] - x[j][d];", "solid integrator"),
    (SOLID, "a.stress += Sym<D>::identity(-a.pv2);", "a.stress += Sym<D>::identity(a.pv2);", "solid integrator"),
    (SOLID, "push = contact(rsq", "push = -contact(rsq", "solid energy"),
    (SOLID, "hourglass_rate[j * D + d] -= rate[d];", "hourglass_rate[j * D + d] += rate[d];", "momentum solid"),
    (SOLID, "dt * Qh[a * D + b] * rate[b]", "dt * Q[b * D + a] * rate[b]", "solid energy"),
    ("fsi_plasticity.h", "(limit + hardening * d) * d", "(limit - hardening * d) * d", "plasticity"),
    ("fsi_plasticity.h", "3.0 * shear * d / trial", "2.0 * shear * d / trial", "plasticity"),
    ("fsi_material.h", "csq + 4.0 / 3.0 * shear / rho0", "csq + shear / rho0", "dt watch"),
    ("fsi_limits.h", "0.25, 0.25, 0.4, 0.125, 0.25", "0.25, 0.25, 0.4, 0.25, 0.25", "dt"),
    (FLUID, "const double dt = update->dt + fix_fsi->dt_offset;\n  for (int i = 0; i < atom->nlocal; i++)\n    if", "const double dt = update->dt;\n  for (int i = 0; i < atom->nlocal; i++)\n    if", "dt"),
    (SOLID, "R *= artificial.weight(kernel.W(r));", "", "solid"),
    (SOLID, "if (!all_bodies && molecule[i] != molecule[j]) continue;", "", "density"),
    (SOLID, "f[j][d] -= tx[d];", "f[j][d] += tx[d];", "momentum"),
    (SOLID, "for (int d = 0; d < D; d++) tx[d] -= q * xij[d];", "for (int d = 0; d < D; d++) tx[d] += q * xij[d];", "solid energy"),
    ("pair_fsi.cpp", "s.csq = (plane_stress ? m.plane_stress_modulus() : m.bulk_modulus()) / m.rho0;", "s.csq = m.bulk_modulus() / m.rho0;", "solid"),
    ("fix_fsi_wall_mirror.cpp", "x[i][w.axis] += w.side * 2.0 * (near - a);", "x[i][w.axis] += w.side * (near - a);", "walls"),
    ("fix_fsi_wall_mirror.cpp", "if (vn * w.side < 0.0) {", "if (vn * w.side > 0.0) {", "walls"),
    ("fix_fsi_wall_mirror.cpp", "fix_fsi->profile->reflected[w.axis] -= 2.0", "fix_fsi->profile->reflected[w.axis] -= 1.0", "report"),
    (TL, "    hold(dt);\n", "", "report"),
    ("fsi_profile.cpp", "  since = now;\n", "", "report"),
    ("fsi_profile.cpp", "back ? &Brick::recvnum : &Brick::sendnum", "&Brick::sendnum", "report"),
    ("fsi_set.cpp", "atom->rmass[i] *= rho / atom->rho[i];", "", "density"),
    ("fsi_set.cpp", "s.rho0 * size * (value - height) + s.p0", "s.rho0 * size * (value + height) + s.p0", "density"),
    ("compute_fsi_surface_atom.cpp", "limit = threshold * fix_fsi->dim;", "limit = threshold * 3;", "surface"),
    ("compute_fsi_energy.cpp", "mine[1] += m * g[d] * dth * v[i][d];", "", "energy"),
    ("fsi_kernel.h", "2.0 / 3.0 - q * q + 0.5", "2.0 / 3.0 - q * q + 0.6", "ctest"),
    ("fsi_kernel.h", "-120.0 + q * q * (120.0", "-120.0 + q * q * (121.0", "ctest"),
    ("fsi_lattice.h", "2.0 * j.g * (xsq + ysq)", "j.g * (xsq + ysq)", "ctest"),
    ("fsi_lattice.h", "std::min(softest, stiffness", "std::max(softest, stiffness", "ctest"),
    ("fsi_tensor.h", "const double angle = 0.5 * dt", "const double angle = -0.5 * dt", "ctest"),
    ("fsi_jaumann.h", "plane_stress ? 2.0 : 3.0", "plane_stress ? 3.0 : 2.0", "ctest"),
    ("fsi_walls.h", "rsq += 4.0 * ai[k] * aj[k];", "rsq += 2.0 * ai[k] * aj[k];", "ctest"),
    (BOND_ROWS, "t[a * D + c] -= stiffness * s;", "t[a * D + c] += stiffness * s;", "solid_tl"),
    (BOND_ROWS, "force[a] -= k * r;", "force[a] += k * r;", "solid_tl"),
    (BOND_ROWS, "force[a] -= t[a * D + c] * b.G[c];", "force[a] -= t[c * D + a] * b.G[c];", "solid_tl"),
    (TL, "reference->swaps.reverse(this);", "", "solid_tl"),
    (TL, "atom->rmass[i] / s.rho0 * reference->weight(i)", "atom->rmass[i] / s.rho0", "solid_tl"),
    (BOND_ROWS, "const T q = 0.5 * b.viscous", "const T q = b.viscous", "solid_tl"),
    (TL, "fsolid[i][d] += f * xij[d];", "fsolid[i][d] -= f * xij[d];", "solid_tl"),
    (TL, "if (molecule[i] == molecule[j]) continue;", "", "solid_tl"),
    (TL, "const bool both = newton || j < nlocal;", "const bool both = true;", "solid_tl"),
    (TL, "comm_forward = has_artificial() || law == HYPO ? 2 * dim : dim;", "comm_forward = dim;", "solid_tl parallel"),
    (TL, "atom->x[i][d] + shift[d];", "atom->x[i][d];", "solid_tl"),
    (TL, "if (fix_fsi->substeps > 1 && !update->setupflag) return;", "if (fix_fsi->substeps > 1) return;", "solid_tl"),
    (TL, "s.sigma[voigt[a][c]] = sum / s.J;", "s.sigma[voigt[a][c]] = sum;", "solid_tl"),
    ("pair_fsi.cpp", "  else list = nullptr;", "  //", "solid_tl"),
    (TL, "v[i][d] += dtfm * (f[i][d] + fs[i][d]);", "v[i][d] += dtfm * fs[i][d];", "solid_tl"),
    (TL, "back = -0.5 * update->dt;", "back = 0.0;", "solid_tl"),
    (TL, "if (atom->mask[i] & fix_fsi->groupbit) moving.push_back(i);", "moving.push_back(i);", "solid_tl"),
    (TL, "    forward_positions();\n    advance_stress(dt);", "    advance_stress(dt);", "solid_tl"),
    (TL, "std::fill_n(virial, 6, 0.0);", "", "solid_tl"),
    (TL, "fix_fsi->set_tally(dt);", "", "solid_tl"),
    (BONDS, "apart + std::sqrt(sum)", "apart + 0.1 * std::sqrt(sum)", "plasticity"),
    ("fsi_number_density.cpp", "if (advance) return update->ntimestep % scene.surface_every == 0;", "if (advance) return true;", "surface"),
    ("fsi_number_density.cpp", "!advance || neighbor->ago == 0);", "!advance);", "parallel"),
    ("fsi_fields.cpp", "      std::copy_n(buf, f.columns, f.at(i));\n      buf += f.columns;", "      buf += f.columns;", "parallel"),
    ("fsi_fields.cpp", "std::copy_n(values + f.in_file, f.columns, f.at(i));", "std::fill_n(f.at(i), f.columns, 0.0);", "restart"),
    ("fsi_check.cpp", "bool calm = all_below(3 * m, f + 3 * i, force);", "bool calm = true;", "stop"),
    ("fsi_check.cpp", "all_below(3 * m, v + 3 * i, calm_speed) && ", "", "stop"),
    ("fsi_check.cpp", "for (int k = i; k < i + m; k++) examine(k, kick);", "for (int k = i; k < i + m - 1; k++) examine(k, kick);", "stop"),
    (BONDS, "w.push_back(volume(j) * kernel.W(std::sqrt(rsq)));", "w.push_back(volume(j));", "solid_tl"),
    (BONDS, "if (molecule[j] != molecule[i] || !is_solid(j)) continue;", "if (!is_solid(j)) continue;", "solid_tl"),
    (BONDS, "{0.0, 1.0 / 12.0, -1.0 / 8.0, 1.0 / 24.0}", "{0.0, 1.0 / 12.0, -1.0 / 8.0, 1.0 / 12.0}", "solid_tl"),
    (BONDS, "    comm->forward_comm(this);\n", "", "solid_tl"),
    (BONDS, "if (delflag && slot[j] >= 0) unused.push_back(slot[j]);", "if (slot[j] >= 0) unused.push_back(slot[j]);", "solid_tl restart"),
    (BONDS, "quadrature[slot[i]] = buf[m++];", "m++;", "solid_tl restart"),
    (BONDS, "std::fabs(atom->x[j][a] - atom->x[i][a]) > 0.5 * domain->prd[a]", "false", "solid_tl"),
    ("compute_fsi_energy.cpp", "!(atom->mask[i] & fix_fsi->groupbit) ? 0.0 : ", "", "solid_tl"),
    ("fsi_gradient.h", "for (int b = k + 1; b < TERMS; b++) c[k] -= L[b][k] * c[b];", "", "ctest"),
    ("fsi_gradient.h", "TOLERANCE = 1.0e-4", "TOLERANCE = 1.0e-1", "ctest"),
    ("fsi_elastic.h", "r.energy = 0.5 * lambda * tr * tr + mu", "r.energy = lambda * tr * tr + mu", "ctest"),
    ("fsi_elastic.h", "C[1] = F[5] * F[6] - F[3] * F[8];", "C[1] = F[3] * F[8] - F[5] * F[6];", "ctest"),
    ("fsi_contact.h", "scale(dim == 3 ? dx : 1.0)", "scale(1.0)", "ctest"),
]


def run(command, folder, environment):
    return subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def main(arguments):
    numbers = [int(a) for a in arguments] or list(range(len(MUTATIONS)))
    with tempfile.TemporaryDirectory() as scratch:
        copy = Path(scratch) / "project"
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns("build*", "results", ".git"))
        environment = {**os.environ, "FSI_CMAKE_OPTIONS": "-DFSI_INSTRUMENT=-O0"}
        if run(["tools/setup", "--tests"], copy, environment).returncode:
            sys.exit("the unchanged copy does not build")
        survivors = []
        for number in numbers:
            name, old, new, tests = MUTATIONS[number]
            source = copy / "src" / "FSI" / name
            text = source.read_text()
            if text.count(old) < 1:
                sys.exit(f"mutation {number}: {name} has no '{old}'")
            source.write_text(text.replace(old, new, 1))
            built = run(["tools/setup", "--tests"], copy, environment)
            if built.returncode:
                verdict = "does not build"
            elif tests == "ctest":
                verdict = "caught" if run(["ctest", "--test-dir", "build"], copy, environment).returncode else "SURVIVED"
            else:
                files = [str(f) for t in tests.split() for f in copy.glob(f"unittest/*/test_{t}.py")]
                verdict = "caught" if run(["tools/pytest", "-x", "-q", *files], copy, environment).returncode else "SURVIVED"
            source.write_text(text)
            if verdict != "caught":
                survivors.append(number)
            print(f"{number:3d} {verdict:9s} {name}: {old.strip()[:60]!r} -> {new.strip()[:60]!r}", flush=True)
        total = len(numbers)
        print(f"{total - len(survivors)} of {total} caught")
        return 0 if len(survivors) <= 0.1 * total else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
