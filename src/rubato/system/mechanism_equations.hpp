#pragma once

#include <rubato/numerics/kkt_factor.hpp>
#include <rubato/system/mechanism.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::system {

/// Evaluates the equations of a mechanism and solves with their matrix
///
///   [ mass M + damping C + stiffness (K + d(G^T multiplier)/dq)   G^T ]
///   [ G                                                           -E  ]    C = df/dv, K = df/dq
///
/// whose E, a share of 1e-10 of what each row sees through M, lets constraints repeat each other: of the multipliers
/// that make the same forces a solution has those of least norm, and iterations lose nothing else by it. A workspace:
/// one a thread; nothing is allocated after the construction.
class MechanismEquations {
 public:
  explicit MechanismEquations(const Mechanism& mechanism);

  const Mechanism& mechanism() const { return mechanism_; }

  /// Goes to a state; what follows is evaluated there. Reads t, q, v, the phases and the memory of the laws.
  /// @param side  which limit to take of a load that jumps at t
  void go_to(const State& state, model::Side side);
  /// The state from which go_to_end() and move_laws() lead.
  void begin_step(const State& from);
  /// Goes to a state that a step leads to from where it began: of laws with a memory the one at its start counts, from
  /// which they follow the motion without a turn. Otherwise as go_to().
  void go_to_end(const State& to, model::Side side);
  /// Writes the memory of the laws at a state to which the motion leads from where the step began.
  void move_laws(State& to);
  /// The same, from a state in which it begins.
  void move_laws(const State& from, State& to) {
    begin_step(from);
    move_laws(to);
  }

  /// Writes f [n] and g [c].
  void residual(Vector& force, Vector& constraint);
  /// residual(), G, which the next product with it uses, and the matrix above, ready to be factorised.
  struct Weights {
    double mass = 1.0, damping = 0.0, stiffness = 0.0;
    double constraint = 0.0;  ///< what E is a share of, over M; 0: the weight of mass
    bool friction = false;    ///< with the slopes of the friction that reactions make, beside G^T
    bool wary = false;  ///< with secants of slip velocities (Weiszfeld 1937), which never overshoot, for their slopes
  };
  void linearise(const Weights& weights, const Vector& multiplier, Vector& force, Vector& constraint);
  /// Makes what linearise() wrote that of all loads times a factor: forces, gravity, laws of joints.
  /// @param weights  those of linearise()
  void scale_loads(double factor, const Weights& weights, Vector& force);
  /// Evaluates G alone, with g.
  void constraints(Vector& constraint);
  /// out += factor (G^T multiplier + the friction that these multipliers make), with the G evaluated last.
  void add_constraint_force(const Vector& multiplier, double factor, Vector& out) const;
  /// The derivative of g(q(t), t) in time: G v + dg/dt [c], with the G evaluated last.
  void constraint_rate(const Vector& v, Vector& out);
  /// What must be added to G a to make the second derivative of g in time [c].
  void second_rate(Vector& out);

  bool factorise() { return factor_.factorise(); }
  /// Rows of constraints that repeat those before them, as the last factors found: what is left of them after the
  /// elimination of everything that they join is round-off.
  /// @param left  the share of a row that counts as nothing; E is 1e-10. Rows at an angle leave its square.
  std::vector<Index> redundant_rows(double left = 1e-8) const;
  /// The row that E lets stay apart most after a correction of the multipliers, and by how much [m], [rad].
  /// @param correction  as solve() wrote it [c]
  Index worst_leak(const Vector& correction, double& apart) const;
  /// How far constraints are apart, each in the motion that closes it alone, by the diagonal of M [m sqrt(kg)]; rows
  /// as the last matrix had them.
  /// @param constraint  g [c]
  double gap_norm(const Vector& constraint) const;
  /// How many rows leave so little that E weighs a tenth and more: redundant, or in a configuration where they are.
  int hardly_held_rows() const;
  /// Whether the matrix is symmetric whatever the state: in space it is not.
  bool is_symmetric() const { return factor_.is_symmetric(); }
  /// Whether the last matrix was positive definite on the motions that the constraints leave (where it is symmetric).
  bool is_positive() const { return factor_.negative_pivots() <= mechanism_.constraint_count(); }
  /// Solves with the factors; (x, y) is overwritten by the solution.
  void solve(Vector& x, Vector& y);
  int factorisations() const { return factorisations_; }

  /// The equations about the present configuration:  M a + C v + K q + G^T multiplier = 0,  G q = 0  for small motions.
  struct Linearised {
    SparseMatrix damping, stiffness;  ///< df/dv and d(f + G^T multiplier)/dq [n x n]
    SparseMatrix jacobian;            ///< G; rows of open locks are empty [c x n]
  };
  Linearised linearised(const Vector& multiplier);

  /// The user's name of the first law, load or element whose force is not finite where go_to() led; empty: none.
  std::string non_finite_part();

  double stored_energy() const;  ///< of all elements where go_to() led, without gravity [J]
  /// Forces of the elements of one role [n].
  void force_of(model::Element::Role role, Vector& out);
  /// Whether friction that follows a reaction slides: the multipliers then make forces that are not linear in them.
  bool has_sliding_reactions() const;
  /// From now on friction follows reactions that exceed the multipliers by a share of `lag`, which is those of a step
  /// that projects its velocities.
  /// @param lag  [c], or empty: nothing
  void exceed_multipliers(const Vector& lag, double share);
  /// The friction of a joint on its coordinate [N] or [N m].
  double friction_force(std::size_t friction, const Vector& multiplier) const;
  /// What friction can hold: mu N [N] or [N m].
  double friction_limit(std::size_t friction, const Vector& multiplier) const;
  /// Of a run of this length [s]: sets what negligible_friction() is.
  void set_duration(double duration);
  /// A friction that, alone on its coordinate, would move it by 1e-10 of the model's size (of a radian) in the run
  /// [N], [N m]: what joints that nothing presses hold is round-off.
  double negligible_friction(std::size_t friction) const { return negligible_.empty() ? 0.0 : negligible_[friction]; }
  /// The rate at which its coordinate would move by as little in the run: where nothing moves, velocities are round-off
  /// [rad/s], [m/s].
  double negligible_rate(std::size_t friction) const {
    return negligible_rate_.empty() ? 0.0 : negligible_rate_[friction];
  }
  /// What is to be compared with negligible_friction(): the size of friction_force(), of two that share a limit that of
  /// both [N], [N m].
  double friction_size(std::size_t friction, const Vector& multiplier) const;
  /// Whether another friction, which shares its limit, leads this one.
  bool is_led(std::size_t friction) const;
  /// Of two that share a limit, with the index of the one that leads: their slip velocity [m/s].
  Eigen::Vector2d slip_velocity(std::size_t friction) const;
  /// Its derivative in time for given accelerations [n].
  Eigen::Vector2d slip_acceleration(std::size_t friction, const Vector& acceleration);
  /// Sets the floors of slip velocities for a step of length h from a state; goes there.
  void set_slip_floors(const State& from, double h, State& to);
  double friction_rate(std::size_t friction) const;  ///< of its coordinate [rad/s] or [m/s]
  double friction_acceleration(std::size_t friction, const Vector& acceleration);  ///< [rad/s^2] or [m/s^2]
  /// What the laws store at a state, and what each of them dissipates from one state to another to which the motion
  /// leads without a turn [J].
  double stored_by_laws(const State& state);
  void dissipated_by_laws(const State& from, const State& to, Vector& dissipated);
  /// Force and displacement of a law where go_to() led [N] and [m], or [N m] and [rad].
  double law_force(std::size_t law) const;
  double law_displacement(std::size_t law) const;
  /// The share of all loads in f: of forces, gravity and laws of joints, and so of all that follows time itself [n].
  void force_of_loads(Vector& out);
  /// External forces by laws of t, and gravity [n].
  void external_force(Vector& out) const;

 private:
  struct Scatter {
    std::vector<int> local, slot;  // of entries that exist
  };
  struct ElementPlace {
    std::vector<int> local;    // of entries that move
    std::vector<Index> place;  // their rows
    Scatter matrix;
  };
  struct JointPlace : ElementPlace {
    Index first_row = 0;
    std::size_t jacobian_start = 0;  // among jacobian_
  };
  /// An entry of G that may differ from zero: jacobian_[local].
  struct Entry {
    int local, row, place;
    int slot, transposed;  // of it and of that of G^T, or the spare one
  };
  struct FrictionPlace {
    std::vector<int> slot;  // of the forces on the places of the joint against its pressing rows [places x rows]
  };
  struct Slip {
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();
    Eigen::Matrix2d slope = Eigen::Matrix2d::Zero();   // of it against the slip velocity [s/m]
    Eigen::Matrix2d secant = Eigen::Matrix2d::Zero();  // of the direction to zero, across the floor
  };
  Slip slip(std::size_t leader) const;
  /// The direction in which a friction slides, of two that share a limit its component.
  double direction(std::size_t friction) const;
  void linearise_slip(std::size_t leader, const Weights& weights, const Vector& multiplier);
  void add_preload_friction(Vector& force) const;
  void linearise_friction(const Weights& weights, const Vector& multiplier);
  double pressing(const model::JointFriction& friction, const Vector& multiplier) const;
  /// Of a pressing row.
  double reaction(Index row, const Vector& multiplier) const {
    return multiplier[row] + (excess_.size() > 0 ? excess_[row] : 0.0);
  }
  ElementPlace place_of(const std::vector<Index>& places) const;
  void list_entries();
  void analyse();
  void scatter(const ElementPlace& place, const double* matrix, double weight);
  void elements_and_loads(Vector& force);
  void add_force_of(model::Element::Role role, Vector& out);
  void add_force_of(std::size_t element, Vector& out);
  void add_laws_of_time(Vector& out);
  /// What law j sees at a state. Leaves the equations where they are.
  model::LawPoint law_point(std::size_t j, const State& state, model::Side side);

  const Mechanism& mechanism_;
  std::vector<std::unique_ptr<model::Element>> elements_;
  std::vector<std::unique_ptr<model::Joint>> joints_;
  std::vector<model::NodeForce> forces_;
  std::vector<ElementPlace> element_places_;
  std::vector<JointPlace> joint_places_;
  std::vector<model::JointPattern> patterns_;  // of the joints
  std::vector<Entry> entries_;                 // of G, joint by joint
  std::vector<FrictionPlace> friction_places_;
  std::vector<int> mass_slot_, row_slot_;
  std::vector<double> mass_value_, inverse_mass_;  // M by entry; of its diagonal [n]
  double share_of_rows_ = 0.0;                     // E over row_seen_
  std::vector<double> row_seen_;                   // G M^-1 G^T of a row by the diagonal of M; 0: it is open [c]
  std::vector<double> jacobian_;                   // of all joints
  std::vector<double> local_, matrix_, velocity_, acceleration_;
  std::vector<double> negligible_, negligible_rate_;  // of each friction
  Vector excess_;  // of the reactions that friction follows, over the multipliers [c]
  model::Motion motion_;
  std::vector<model::LawPoint> step_start_;  // of the laws
  std::vector<double> start_memory_;         // of all laws there
  std::vector<double> other_velocity_;       // after a zero, of a state to which the equations do not go
  numerics::KktFactor factor_;
  int factorisations_ = 0;
};

}  // namespace rubato::system
