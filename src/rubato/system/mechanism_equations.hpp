#pragma once

#include <rubato/system/constrained_equations.hpp>
#include <rubato/system/mechanism.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rubato::system {

/// Evaluates the equations of a mechanism: elements, joints, loads, friction that follows reactions, and laws.
class MechanismEquations final : public ConstrainedEquations {
 public:
  explicit MechanismEquations(const Mechanism& mechanism);

  const Mechanism& mechanism() const { return mechanism_; }
  const ConstrainedSystem& system() const override { return mechanism_; }

  void go_to(const State& state, model::Side side) override;
  void begin_step(const State& from) override;
  void go_to_end(const State& to, model::Side side) override;
  using ConstrainedEquations::move_laws;
  void move_laws(State& to) override;

  void residual(Vector& force, Vector& constraint) override;
  void linearise(const Weights& weights, const Vector& multiplier, Vector& force, Vector& constraint) override;
  /// Makes what linearise() wrote that of all loads times a factor: forces, gravity, laws of joints.
  /// @param weights  those of linearise()
  void scale_loads(double factor, const Weights& weights, Vector& force);
  void constraints(Vector& constraint) override;
  void add_constraint_force(const Vector& multiplier, double factor, Vector& out) const override;
  void constraint_rate(const Vector& v, Vector& out) override;
  void second_rate(Vector& out) override;

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
  bool has_sliding_reactions() const override;
  bool lets_go(const State& state) override;
  void set_reaction_lag(const Vector& lag, double share) override;
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
  void set_slip_floors(const State& from, double h, State& to) override;
  double friction_rate(std::size_t friction) const;  ///< of its coordinate [rad/s] or [m/s]
  double friction_acceleration(std::size_t friction, const Vector& acceleration);  ///< [rad/s^2] or [m/s^2]
  /// What the laws store at a state, and what each of them dissipates from one state to another to which the motion
  /// leads without a turn [J].
  double stored_by_laws(const State& state);
  void dissipated_by_laws(const State& from, const State& to, Vector& dissipated);
  /// What each of the contacts dissipates from one state to another, as dissipated_by_laws() [J].
  void dissipated_by_contacts(const State& from, const State& to, Vector& dissipated);
  /// Where a contact is, its forces with their slopes, and what it does, where go_to() led.
  model::BlockPoint contact_point(std::size_t contact) const;
  model::BlockAnswer contact_answer(std::size_t contact) const;
  model::Law::Contact contact_branch(std::size_t contact) const;
  /// Force and displacement of a law where go_to() led [N] and [m], or [N m] and [rad].
  double law_force(std::size_t law) const;
  double law_displacement(std::size_t law) const;
  model::LawAnswer law_answer(std::size_t law) const;      ///< with its slopes
  model::Law::Contact law_contact(std::size_t law) const;  ///< what one that sticks does there
  double law_normal(std::size_t law) const;                ///< what presses on it there, 0 where it is open [N]
  /// Of forces, gravity and laws of joints [n].
  void force_of_loads(Vector& out) override;
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
  /// A law on which the reaction of a joint presses.
  struct PressedByReaction {
    std::size_t law = 0;
    ElementPlace u;         // of its u
    std::vector<int> slot;  // of the forces on the places of u against the rows that press [places x rows]
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
  /// Points a motion to the reactions of a state that press on laws.
  void take_reactions(const State& state, model::Motion& motion, Vector& reactions) const;
  /// out += factor times what multipliers make of the forces of laws on which reactions press, which are linear in them
  /// about the reactions where go_to() led.
  void add_pressed_by_reactions(const Vector& multiplier, double factor, Vector& out) const;
  void linearise_pressed_by_reactions();
  ElementPlace place_of(const std::vector<Index>& places) const;
  void list_entries();
  void analyse();
  void scatter(const ElementPlace& place, const double* matrix, double weight);
  void elements_and_loads(Vector& force);
  void add_force_of(model::Element::Role role, Vector& out);
  void add_force_of(std::size_t element, Vector& out);
  void add_laws_of_time(Vector& out);
  /// A state, for laws and contacts; its velocities are overwritten by the next one. Leaves the equations where they
  /// are.
  model::Motion motion_at(const State& state, model::Side side);
  /// What law j sees at a state. Leaves the equations where they are.
  model::LawPoint law_point(std::size_t j, const State& state, model::Side side);
  model::BlockPoint contact_point(std::size_t j, const State& state, model::Side side);

  const Mechanism& mechanism_;
  std::vector<std::unique_ptr<model::Element>> elements_;
  std::vector<std::unique_ptr<model::Joint>> joints_;
  std::vector<model::NodeForce> forces_;
  std::vector<ElementPlace> element_places_;
  std::vector<JointPlace> joint_places_;
  std::vector<model::JointPattern> patterns_;  // of the joints
  std::vector<Entry> entries_;                 // of G, joint by joint
  std::vector<FrictionPlace> friction_places_;
  std::vector<PressedByReaction> pressed_by_reactions_;
  Vector reactions_, other_reactions_;  // where go_to() led, and of a state to which the equations do not go [c]
  Vector guess_;                        // multipliers where go_to() led, about which laws are linear in them [c]
  std::vector<double> jacobian_;        // of all joints
  std::vector<double> local_, matrix_, velocity_, acceleration_;
  std::vector<double> negligible_, negligible_rate_;  // of each friction
  Vector excess_;  // of the reactions that friction follows, over the multipliers [c]
  model::Motion motion_;
  std::vector<model::LawPoint> step_start_;       // of the laws
  std::vector<model::BlockPoint> contact_start_;  // of the contacts
  std::vector<double> start_memory_;              // of all laws and contacts there
  std::vector<double> tried_memory_;              // of all of them where the step is tried to end
  std::vector<double> other_velocity_;            // after a zero, of a state to which the equations do not go
};

}  // namespace rubato::system
