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

// Per-atom arrays, each described once: memory, migration, restart files and messages to ghosts
// follow from that.

#ifndef LMP_FSI_FIELDS_H
#define LMP_FSI_FIELDS_H

#include "fix.h"
#include "fsi_keywords.h"
#include "fsi_lammps_access.h"
#include "fsi_material.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS::FSI {

class Profile;
class Record;

class Fields : protected Pointers {
 public:
  // how long its numbers last: until the next step finds them anew, for local and ghost atoms; or
  // as long as the (local) atom, with which they go from rank to rank; or that and in restart
  // files
  enum Life { STEP, ATOM, RESTART };

  Fields(LAMMPS *lmp) : Pointers(lmp) {}
  Fields(const Fields &) = delete;
  ~Fields();

  // The array is there while it is wanted, else null. One that lasts begins with 0 for every
  // atom. May be said again at any time.
  void set(const std::string &name, Life, bool wanted, double *&array);
  void set(const std::string &name, Life, bool wanted, double **&array, int columns);
  void set(const std::string &name, Life, bool wanted, int *&array);

  bool any(Life) const;    // that last as long or longer
  void grow();             // those of a step, to atom->nmax
  double memory_usage() const;

  // for LAMMPS' callbacks: those that last
  void grow_lasting(int nmax);
  void copy(int i, int j);
  void begin(int i);
  int pack(int i, double *buf) const;
  int unpack(int i, const double *buf);

  // Restart files. The record says which numbers of an atom are whose; those that it does not
  // know begin anew, as do the ones to forget.
  void write(Record &) const;
  void read(const Record &, const std::vector<std::string> &forget = {});
  int restart_size() const;
  int pack_restart(int i, double *buf) const;
  void unpack_restart(int i, int nth);
  // the same from one fix to the next in its place: rows, each with the atom's ID behind it, of
  // all atoms that have other numbers than 0
  std::vector<double> pack_all() const;
  void unpack_all(const std::vector<double> &);

 private:
  struct Field {
    std::string name;
    Life life = STEP;
    int columns = 0, rows = 0;
    double *one = nullptr, **many = nullptr;    // one column, more
    int *integers = nullptr;
    double **one_of = nullptr, ***many_of = nullptr;    // where its owner has it
    int **integers_of = nullptr;
    int in_file = -1;    // where its numbers begin in those of a restart file

    template <class Use> void with(Use use)    // its array, and where its owner has that
    {
      if (one_of) use(one, *one_of);
      if (many_of) use(many, *many_of);
      if (integers_of) use(integers, *integers_of);
    }
    double *at(int i) const { return one ? one + i : many[i]; }
  };
  std::vector<Field> fields;
  bool has_record = false;

  Field *find(const std::string &name);
  void set(Field, bool wanted);
  void resize(Field &, int rows);
  void take(int i, const double *values);
  void free(Field &);
};

// What a message between ranks carries of an atom: columns of arrays, of atoms of some species.
class Message : protected Pointers {
 public:
  Message(LAMMPS *lmp, const std::vector<State> &state) : Pointers(lmp), state(state) {}
  Message(const Message &) = delete;    // holds addresses of its owner
  void clear() { columns.clear(); }
  int group = 0;    // bit of the group whose particles it is about; 0: all
  // n: numbers of an atom, side by side; when: null, or whether it is carried now
  void add(double *&array, std::initializer_list<int> species, int n = 1);
  void add(double **&array, int first, int n, std::initializer_list<int> species,
           const bool *when = nullptr);
  int size() const;    // at most, of an atom

  // of those listed, or null: of n from the first one on
  int pack(int n, const int *list, int first, double *buf) const;
  void unpack(int n, int first, const double *buf) const;
  // back to their owners, who add them up
  void add_up(int n, const int *list, const double *buf) const;

 private:
  struct Column {
    double **one = nullptr, ***many = nullptr;
    int first = 0, n = 0, species = 0;
    const bool *when = nullptr;
    double *at(int i) const { return one ? *one + i * n : (*many)[i] + first; }
  };
  std::vector<Column> columns;
  const std::vector<State> &state;
  template <class Visit> void visit(int i, Visit) const;
};

// A fix with fields, which may send messages. A restart file has its keywords, if there are any,
// and says what of each atom is whose.
class FixFields : public Fix {
 public:
  // command: as a user writes it, fix fsi/stress
  FixFields(LAMMPS *, int narg, char **arg, const std::string &command);
  ~FixFields() override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  void grow_arrays(int nmax) override { fields.grow_lasting(nmax); }
  void copy_arrays(int i, int j, int) override { fields.copy(i, j); }
  void set_arrays(int i) override { fields.begin(i); }
  int pack_exchange(int i, double *buf) override { return fields.pack(i, buf); }
  int unpack_exchange(int i, double *buf) override { return fields.unpack(i, buf); }
  int pack_restart(int i, double *buf) override { return fields.pack_restart(i, buf); }
  void unpack_restart(int i, int nth) override { fields.unpack_restart(i, nth); }
  int size_restart(int) override { return fields.restart_size(); }
  int maxsize_restart() override { return fields.restart_size(); }
  int pack_forward_comm(int n, int *list, double *buf, int, int *) override
  {
    return sent->pack(n, list, 0, buf);
  }
  void unpack_forward_comm(int n, int first, double *buf) override { sent->unpack(n, first, buf); }
  int pack_reverse_comm(int n, int first, double *buf) override
  {
    return sent->pack(n, nullptr, first, buf);
  }
  void unpack_reverse_comm(int n, int *list, double *buf) override { sent->add_up(n, list, buf); }
  double memory_usage() override { return fields.memory_usage(); }

 protected:
  const std::string command;
  Keywords keywords;
  Fields fields;
  const Message *sent = nullptr;    // of the exchange that goes on, by LAMMPS
  // when those that last are set: in the constructor, and again whenever they may have changed
  void register_fields();
  // for another fix of that name, until the next run: the record and all fields. To be called in
  // the destructor; and in the constructor, when fields are registered: null if there is none
  void hand_on(const std::string &name, Record);
  std::shared_ptr<const Record> take_over(const std::string &name);

 private:
  friend class Ghosts;
  bool grows = false, restarts = false;    // with LAMMPS' own arrays
  void add_callback(int kind, int *&booked, int &n);
};

// Messages between particles and their ghosts, for who is no style of LAMMPS: a fix packs them
class Ghosts : protected Pointers {
 public:
  Ghosts(LAMMPS *lmp, FixFields &carrier, const std::vector<State> &state,
         Profile *const &profile) :
      Pointers(lmp),
      carrier(carrier), profile(profile), one_array(lmp, state)
  {
  }
  void send(const Message &, int columns = 0);    // to ghosts
  void add(const Message &, int columns = 0);     // what pairs left on ghosts, to local atoms
  // the same of an array with rows of so many numbers
  static constexpr int MOST_COLUMNS = 16;
  void send(double *rows, int columns = 1) { send(message_of(rows, columns), columns); }
  void add(double *rows, int columns = 1) { add(message_of(rows, columns), columns); }
  void send(std::vector<tagint> &numbers);    // one per particle

 private:
  FixFields &carrier;
  Profile *const &profile;
  Message one_array;
  double *carried = nullptr;    // that array
  const Message &message_of(double *rows, int columns);
};

// LAMMPS' exchanges with ghosts, without those that carry none of the chosen particles: both ends
// of an exchange see whether it does, so no rank waits for an empty message. With comm_style
// tiled they are LAMMPS' own.
class Swaps : protected Pointers {
 public:
  explicit Swaps(LAMMPS *lmp) : Pointers(lmp), chosen(false) {}
  void find(const std::function<bool(int)> &is_chosen);    // whenever ghosts are new
  // for a pair style or a fix, which packs and unpacks the chosen particles only; size: numbers
  // of each, 0: comm_forward, comm_reverse
  template <class Owner> void forward(Profile *, Owner *, int size = 0);
  template <class Owner> void reverse(Profile *, Owner *, int size = 0);

 private:
  struct Swap : Exchange {
    std::vector<int> sent;    // chosen atoms of the list
    int arriving = 0;         // chosen ones of the ghosts
  };
  bool chosen;
  std::vector<Swap> swaps;
  std::vector<double> out, in;
  double *pass(int to, int n, int from, int most);
};

// The numbers of atom i that the nth fix of a restart file left there; all begin with their
// length.
const double *restart_values(const double *extra, int nth);

}    // namespace LAMMPS_NS::FSI

#endif
