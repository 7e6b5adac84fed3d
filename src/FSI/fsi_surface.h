/* -*- c++ -*- ----------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

// Signed distance from a surface, negative inside: of a region of LAMMPS, of triangles (STL), of
// closed outlines in the plane (CSV).

#ifndef LMP_FSI_SURFACE_H
#define LMP_FSI_SURFACE_H

#include <memory>
#include <string>

namespace LAMMPS_NS {
class LAMMPS;

namespace FSI {

  class Surface {
   public:
    virtual ~Surface() = default;
    // of a place, and, if it is less than the band, the unit vector away from the nearest point of
    // the surface, out of it; +-band: no point is as near
    virtual double distance(const double *x, double band, double *outward) const = 0;
    // of what it holds, from its faces; < 0: it has none
    virtual double volume() const { return -1.0; }
    virtual std::string name() const = 0;
  };

  std::unique_ptr<Surface> surface_of_region(LAMMPS *, const std::string &id);
  // errors: what cannot be read, a surface that is not closed
  std::unique_ptr<Surface> surface_of_stl(LAMMPS *, const std::string &file);
  std::unique_ptr<Surface> surface_of_outline(LAMMPS *, const std::string &file);

}    // namespace FSI
}    // namespace LAMMPS_NS

#endif
