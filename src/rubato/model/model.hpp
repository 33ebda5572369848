#pragma once

#include <rubato/core/types.hpp>
#include <rubato/model/description.hpp>
#include <rubato/model/laws/block_law.hpp>
#include <rubato/model/laws/law.hpp>
#include <rubato/model/structure.hpp>
#include <rubato/model/time_law.hpp>
#include <rubato/numerics/formula.hpp>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace rubato::model {

/// Spring or dashpot between two coordinates (`ground` = -1 allowed for either).
struct LinearElement {
  Index first = ground, second = ground;
  double coefficient = 0.0;  ///< [N/m] or [N s/m], >= 0
};

/// Jenkins element on u = x_first - x_second:
///   fc = clamp(fc_old + stiffness (u - u_old), -limit, limit);  -fc acts on first, +fc on second.
struct Slider {
  std::string name;
  Index first = ground, second = ground;
  double stiffness = 0.0;  ///< kT [N/m], > 0
  double limit = 0.0;      ///< mu N [N], >= 0
};

/// One-sided stop on u = x_first - x_second; -force acts on first, +force on second.
struct Stop {
  std::string name;
  Index first = ground, second = ground;
  double gap = 0.0;        ///< [m]
  double stiffness = 0.0;  ///< k [N/m], > 0
  double damping = 0.0;    ///< c [N s/m], >= 0

  /// fs = max(0, k (u - gap) + c du/dt) while u > gap, else 0: it never pulls. With c > 0 it jumps when it closes.
  double force(double u, double rate) const {
    const double pushed = stiffness * (u - gap) + damping * rate;
    return u > gap && pushed > 0.0 ? pushed : 0.0;
  }
};

/// A coordinate times a weight, of which u is a sum.
struct Share {
  Index coordinate = 0;
  double weight = 0.0;  ///< [-]; [m/rad] of a rotation in a displacement
};

/// What presses the ends of a law together, across its u [N]: a number, a formula of t, or the force of a stop or of
/// another law. It is the normal force where it is positive; elsewhere the ends are apart.
struct NormalForce {
  double value = 0.0;
  std::shared_ptr<const numerics::Formula> formula = nullptr;  ///< of t, instead
  Index stop = -1, law = -1;  ///< place among the stops or the laws of the one whose force presses, instead

  bool depends_on_motion() const { return stop >= 0 || law >= 0; }
  /// Of a number or a formula.
  double at(double t, Side side) const {
    if (!formula) return value;
    if (!formula->has_switches()) return (*formula)(t);
    return side == Side::left ? formula->from_left(t) : formula->from_right(t);
  }
};

/// A law on u = x_first - x_second + the sum of its shares; -force du/dx acts on each coordinate.
struct LawBetween {
  std::string name;
  std::string kind;  ///< its table in the study file
  Index first = ground, second = ground;
  std::shared_ptr<const Law> law;
  std::vector<Share> shares = {};  ///< instead of the ends
  NormalForce normal = {};         ///< of a law that takes one
};

/// A law of several numbers, each of which is a sum of coordinates times weights; -force_i du_i/dx acts on each.
struct BlockBetween {
  std::string name;
  std::string kind;  ///< its table in the study file
  std::shared_ptr<const BlockLaw> law;
  std::array<std::vector<Share>, largest_block> columns = {};  ///< of its numbers
};

struct Force {
  Index coordinate = 0;
  TimeLaw law;  ///< [N]
};

/// A force per length along elements of the structure that follow one another.
struct DistributedForce {
  std::size_t first = 0, count = 0;  ///< elements
  Axis direction = Axis::Zero();     ///< [-]
  TimeLaw law;                       ///< [N/m]
};

struct BaseMotion {
  Vector direction;                 ///< of coordinates [n], dimensionless; 0 for those of nodes
  TimeLaw law;                      ///< acceleration of the ground [m/s2]
  Axis translation = Axis::Zero();  ///< share of the nodes' translations, of those that a support holds too [-]
};

struct FullMatrices {
  SparseMatrix mass, damping, stiffness;  ///< [n x n], symmetric; damping may hold no entries
  /// Forces that give all nodes the acceleration 1 along x, y and z [n x 3] [kg]; empty where there are no nodes.
  Eigen::Matrix<double, Eigen::Dynamic, 3> inertia = {};
};

struct ModalDampingRatios {
  std::vector<double> ratios;  ///< one for all modes, or one a mode [-]
  Index modes = -1;            ///< only the lowest so many; -1: all
};

struct RayleighCoefficients {
  double mass = 0.0;       ///< [1/s]
  double stiffness = 0.0;  ///< [s]
};

using Damping = std::variant<std::monostate, ModalDampingRatios, RayleighCoefficients>;

/// Held in the static start only.
struct Held {
  Index coordinate = 0;
  double value = 0.0;  ///< [N] or [m]; [N m] or [rad] of a rotation
};

/// A coordinate that moves as laws say, whatever that takes.
struct Prescribed {
  Index coordinate = 0;
  TimeLaw displacement, velocity, acceleration;  ///< [m] or [rad], and its derivatives
};

/// A structure of coordinates with values for everything: validated, immutable by convention once built.
struct Model {
  std::vector<std::string> coordinates;  ///< names, [n]
  std::vector<char> is_rotation;         ///< [n]; empty where there are no nodes: all are displacements
  Vector mass;                           ///< [n] [kg] or [kg m2], without elements; unused where `matrices` is set
  Vector position, velocity;             ///< at the start, [n] [m], [m/s]
  std::vector<LinearElement> springs, dashpots;
  Structure structure;                   ///< nodes and elements; may be empty
  std::optional<FullMatrices> matrices;  ///< instead of mass, springs and dashpots
  Damping damping;                       ///< in addition to dashpots
  std::vector<Slider> sliders;
  std::vector<Stop> stops;
  std::vector<LawBetween> laws;
  std::vector<BlockBetween> blocks;
  std::vector<Force> forces;
  std::vector<DistributedForce> distributed_forces;
  std::vector<Held> held_forces, held_displacements;
  std::vector<Prescribed> prescribed;  ///< in the order of the description
  Axis gravity = Axis::Zero();         ///< acts on the nodes [m/s2]
  std::optional<BaseMotion> base_motion;

  Index size() const { return static_cast<Index>(coordinates.size()); }
};

/// What becomes of a slider whose normal load is negative (a slider cannot be pulled).
enum class NegativeLoad { refuse, zero };

/// The model for given values of the parameters. Throws InvalidInput, at the place in the user's file, for an unknown
/// or duplicate name, a value out of its range (negative mass, zero mass where it makes M singular, negative stiffness,
/// ...) or a faulty formula.
Model build(const ModelDescription& description, const numerics::Parameters& parameters,
            NegativeLoad negative_load = NegativeLoad::refuse);

}  // namespace rubato::model
