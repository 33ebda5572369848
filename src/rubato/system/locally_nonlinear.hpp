#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/model.hpp>
#include <rubato/system/loads.hpp>
#include <rubato/system/moving_supports.hpp>
#include <rubato/system/state.hpp>
#include <rubato/system/system.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rubato::system {

/// A linear structure with sliders and one-sided stops:
///
///   M a + C v + K q + B fc = f(t),   u = B^T q
///   sliders  fc = clamp(fc_old + kT (u - u_old), -limit, limit)
///   stops    fc = max(0, k (u - gap) + c du/dt) while u > gap, else 0
///   others   fc = a law of u, du/dt and t with a memory of its own (model::Law)
///   blocks   a few fc at a time = a law of as many u with a memory of its own (model::BlockLaw)
///
/// with constant symmetric M (positive definite), C and K [n x n] and the columns of B [n x m], e_first - e_second of
/// each slider and stop, a few shares of coordinates of each other law: the sliders, then the stops, then the laws,
/// then the rows of the blocks. Immutable; integrators keep what moves in a State and in their workspace.
class LocallyNonlinear final : public System {
 public:
  struct Parts {
    SparseMatrix mass, damping, stiffness;  ///< [n x n]
    std::vector<model::Slider> sliders;
    std::vector<model::Stop> stops;
    std::vector<model::LawBetween> laws;
    std::vector<model::BlockBetween> blocks;
    Loads loads;
    State start;  ///< t = 0; q, v of the model; sliders without force; stops and laws as q and v have them
    std::vector<std::string> coordinates;  ///< names for messages and results, [n]
    std::vector<char> is_rotation;         ///< [n]: in [rad] instead of [m]; may be empty: none is
    /// Characteristic size of the model for error measures (model::reference_value) [m sqrt(kg)]; 0: it has none.
    double reference = 0.0;
    std::vector<model::Held> held_forces, held_displacements;  ///< in the static start only
    std::optional<MovingSupports> supports;                    ///< whose pull is among the loads
  };

  explicit LocallyNonlinear(Parts parts);

  Index size() const override { return parts_.mass.rows(); }
  Index slider_count() const { return static_cast<Index>(parts_.sliders.size()); }
  Index stop_count() const { return static_cast<Index>(parts_.stops.size()); }
  Index law_count() const { return static_cast<Index>(parts_.laws.size()); }
  Index block_count() const { return static_cast<Index>(parts_.blocks.size()); }
  /// Whether anything acts beside sliders and stops.
  bool has_laws() const { return law_count() > 0 || block_count() > 0; }
  Index contact_count() const { return static_cast<Index>(contacts_.size()); }
  const SparseMatrix& mass() const { return parts_.mass; }
  const SparseMatrix& damping() const { return parts_.damping; }
  const SparseMatrix& stiffness() const { return parts_.stiffness; }
  const std::vector<model::Slider>& sliders() const { return parts_.sliders; }
  const std::vector<model::Stop>& stops() const { return parts_.stops; }
  const std::vector<model::LawBetween>& laws() const { return parts_.laws; }
  const std::vector<model::BlockBetween>& blocks() const { return parts_.blocks; }
  /// The first row of block b among the contacts, and where its memory begins in that of a state.
  Index row_of_block(Index b) const { return block_row_[static_cast<std::size_t>(b)]; }
  Index memory_of_block(Index b) const { return block_memory_[static_cast<std::size_t>(b)]; }
  /// The block to which a contact belongs; -1: none.
  Index block_at(Index contact) const;
  /// Where the memory of law j begins in that of a state.
  Index memory_of(Index j) const { return memory_start_[static_cast<std::size_t>(j)]; }
  Index memory_size() const { return memory_size_; }
  /// The first of the laws among the contacts.
  Index first_law() const { return slider_count() + stop_count(); }
  /// The first row of the blocks.
  Index first_block() const { return first_law() + law_count(); }
  /// What a contact joins: that of a slider, of a stop or of another law.
  struct Ends {
    Index first = ground, second = ground;
  };
  const std::vector<Ends>& contacts() const { return contacts_; }
  /// What laws add to the difference of their ends: a coordinate times a weight. By contacts, rising.
  struct ContactShare {
    Index contact = 0, coordinate = 0;
    double weight = 0.0;
  };
  const std::vector<ContactShare>& shares() const { return shares_; }
  /// The column of B of a contact: its coordinates with their weights, without the ground.
  std::vector<model::Share> column(Index contact) const;
  /// Whether u of a contact is in [rad]: all that it joins are rotations.
  bool is_of_rotations(Index contact) const;
  /// Whether u of a law is in [rad]: all that it joins are rotations.
  bool is_law_of_rotations(Index law) const { return is_of_rotations(first_law() + law); }
  const Loads& loads() const { return parts_.loads; }
  const State& start() const { return parts_.start; }
  const std::vector<std::string>& coordinates() const override { return parts_.coordinates; }
  const std::vector<model::Held>& held_forces() const { return parts_.held_forces; }
  const std::vector<model::Held>& held_displacements() const { return parts_.held_displacements; }
  bool is_rotation(Index i) const override {
    return !parts_.is_rotation.empty() && parts_.is_rotation[static_cast<std::size_t>(i)] != 0;
  }
  bool is_flat() const override { return true; }
  void retract(const Vector& q, const Vector& dq, Vector& out) const override { out = q + dq; }
  void difference(const Vector& q, const Vector& to, Vector& dq) const override { dq = to - q; }
  double reference() const { return parts_.reference; }
  /// Null where none moves.
  const MovingSupports* supports() const { return parts_.supports ? &*parts_.supports : nullptr; }
  bool has_diagonal_mass() const { return has_diagonal_mass_; }

  /// u of contact i [m]: x_first - x_second, and the shares of a law; of velocities, its rate
  double relative_displacement(Index i, const Vector& q) const {
    const Ends& s = contacts_[static_cast<std::size_t>(i)];
    double u = (s.first == ground ? 0.0 : q[s.first]) - (s.second == ground ? 0.0 : q[s.second]);
    if (shares_.empty()) return u;
    const auto contact = static_cast<std::size_t>(i);
    for (std::size_t k = first_share_[contact]; k < first_share_[contact + 1]; ++k)
      u += shares_[k].weight * q[shares_[k].coordinate];
    return u;
  }
  /// fs of stop j at given displacements and velocities [N]
  double stop_force(Index j, const Vector& q, const Vector& v) const {
    const Index i = slider_count() + j;
    return parts_.stops[static_cast<std::size_t>(j)].force(relative_displacement(i, q), relative_displacement(i, v));
  }
  /// Sets the forces of all stops to what displacements and velocities of the state make them.
  void set_stop_forces(State& state) const;
  /// What law j sees at a state.
  model::LawPoint law_point(Index j, const State& state, model::Side side) const {
    const Index i = first_law() + j;
    return {relative_displacement(i, state.q), relative_displacement(i, state.v), state.t, side,
            has_normals_ ? normal_force(j, state, state.slider_force, side) : 0.0};
  }
  /// What block b sees at a state.
  model::BlockPoint block_point(Index b, const State& state) const;
  /// Whether a law takes a normal force.
  bool has_normals() const { return has_normals_; }
  /// The contact whose force presses on law j; -1 where a number or a formula of t does, or nothing.
  Index normal_contact(Index j) const { return normal_contact_[static_cast<std::size_t>(j)]; }
  /// What presses on law j at a state with given forces of the contacts [N]. That of an open stop is what its spring
  /// would pull, so that the instant at which it closed within a step shows.
  double normal_force(Index j, const State& state, const Vector& contact_force, model::Side side) const;
  /// The laws, each behind those that press on it.
  const std::vector<Index>& law_order() const { return law_order_; }
  /// Whether anything sticks and slips: sliders, or laws that do.
  bool has_friction() const;
  /// Sets the forces of all laws at a state, by the memory that it has.
  void set_law_forces(State& state, model::Side side) const { find_law_forces(state, side, state.slider_force); }
  /// Writes them behind those of sliders and stops.
  void find_law_forces(const State& state, model::Side side, Vector& contact_force) const;
  /// Adds the times in (from, to) at which laws are not smooth to those of loads; rising.
  void add_law_breakpoints(double from, double to, std::vector<double>& times) const;
  /// Whether a law depends on time, so that its force at a state has a left and a right limit.
  bool has_laws_of_time() const { return has_laws_of_time_; }
  /// Sets forces and memory of all laws at a state that the motion from `before` reaches without turning back.
  void move_laws(const State& before, State& state) const;
  /// out += factor * B fc, of all contacts
  void add_slider_forces(const Vector& slider_force, double factor, Vector& out) const;

  /// That K plus kT of all sliders, and of laws that stick: the stiffness with the sliders stuck and the stops open.
  SparseMatrix stuck_stiffness() const;
  /// K and C with the slopes of the laws where nothing has moved yet and nothing presses, without sliders and stops.
  SparseMatrix free_stiffness() const;
  SparseMatrix free_damping() const;
  /// The same beside stuck_stiffness(): with the dashpots of all contacts.
  SparseMatrix stuck_damping() const;
  /// C and that K with all stops closed besides: what bounds the step of explicit methods.
  SparseMatrix closed_damping() const;
  SparseMatrix closed_stiffness() const;

 private:
  void order_laws();
  void place_blocks();
  /// The slopes of the laws where nothing has moved yet and nothing presses, as coefficients of all contacts; others
  /// are zero.
  std::vector<double> law_slopes(double model::LawAnswer::*slope) const;
  /// Sets the coefficients of the rows of the blocks to their stiffness in a limit of small motions.
  void set_block_limits(bool is_stuck, std::vector<double>& coefficients) const;
  /// The damping in such a limit.
  SparseMatrix limit_damping(bool is_stuck) const;
  SparseMatrix with_contacts(const SparseMatrix& matrix, const std::vector<double>& coefficients) const;

  Parts parts_;
  std::vector<Ends> contacts_;
  std::vector<ContactShare> shares_;
  std::vector<std::size_t> first_share_;  // of each contact, and the count
  std::vector<Index> memory_start_, block_row_, block_memory_;
  Index memory_size_ = 0;
  std::vector<Index> normal_contact_, law_order_;  // of each law; laws behind those that press on them
  bool has_normals_ = false;
  bool has_laws_of_time_ = false;
  bool has_diagonal_mass_ = false;
};

/// The acceleration of equilibrium at a state, M a = f(t) - C v - K q - B fc: what is reported. A workspace: one a
/// thread.
class EquilibriumAcceleration {
 public:
  explicit EquilibriumAcceleration(const LocallyNonlinear& system);
  ~EquilibriumAcceleration();
  EquilibriumAcceleration(EquilibriumAcceleration&&) noexcept;
  /// @param side  which limit to take of a load that jumps at state.t
  void operator()(const State& state, Vector& acceleration, model::Side side = model::Side::right);
  /// M^-1 force
  void of_force(const Vector& force, Vector& acceleration);

 private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace rubato::system
