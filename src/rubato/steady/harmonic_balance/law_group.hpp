#pragma once

#include <rubato/system/locally_nonlinear.hpp>

#include <memory>
#include <vector>

namespace rubato::steady {

/// Where the numbers of a group are [d each].
struct GroupPoint {
  const double* u = nullptr;     ///< [m]
  const double* rate = nullptr;  ///< [m/s]
};

/// Laws that see each other's displacements, as one law of d numbers with one memory: a law of several numbers, or laws
/// and stops of which some press on others. It does not depend on time. Immutable.
class LawGroup {
 public:
  virtual ~LawGroup() = default;

  virtual Index size() const = 0;
  virtual Index memory_size() const = 0;
  virtual bool depends_on_rate() const = 0;
  /// A displacement at which something happens; of laws that are alike at all scales any [m].
  virtual double length() const = 0;
  /// The forces at the end of a step in which all numbers go straight [d] [N].
  /// @param next    the memory at `to`; must not be `memory`
  /// @param slopes  null, or where the slopes of force i by the displacements and by the rates at `to` are put
  ///                [d x 2d]
  virtual void advance(const GroupPoint& from, const double* memory, const GroupPoint& to, double* next, double* force,
                       Matrix* slopes) const = 0;
  /// The slopes of a step, where they are known in closed form; else differences take their place.
  /// @param slopes  rows by the displacements and rates at `to`, at `from`, by the memory; columns of the forces and of
  ///                the memory at `to` [4 d + m x d + m], all zero at first
  /// @return whether they are known
  virtual bool slopes(const GroupPoint&, const double*, const GroupPoint&, Matrix&) const { return false; }
  /// Adds what each law of the group dissipates in the step [J]; `next` as advance() wrote it.
  /// @param work  by the laws of the system, the blocks behind the scalar ones
  virtual void add_dissipated(const GroupPoint& from, const double* memory, const GroupPoint& to, const double* next,
                              Vector& work) const = 0;
};

/// The laws of a structure by the groups in which they act, with the contacts that they join.
struct GroupedLaws {
  struct Group {
    std::shared_ptr<const LawGroup> law;
    std::vector<Index> contacts;  ///< by its numbers
  };
  std::vector<Index> single;  ///< laws that see only their own number
  std::vector<Group> groups;
};
/// All laws, stops and blocks of a structure, which must outlive them.
GroupedLaws group_laws(const system::LocallyNonlinear& system);

}  // namespace rubato::steady
