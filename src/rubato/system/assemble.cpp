#include <rubato/core/error.hpp>
#include <rubato/numerics/eigen_symmetric.hpp>
#include <rubato/numerics/ordered_factor.hpp>
#include <rubato/system/assemble.hpp>
#include <rubato/system/assembled_model.hpp>
#include <rubato/system/eliminate_supports.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace rubato::system {
namespace {

constexpr Index largest_modal_size = 2000;  // all modes of a dense eigenproblem; minutes beyond

using Triplets = std::vector<Eigen::Triplet<double>>;

SparseMatrix from_elements(Index n, const std::vector<model::LinearElement>& elements, Triplets entries = {}) {
  for (const auto& element : elements) {
    if (element.first != ground) entries.emplace_back(element.first, element.first, element.coefficient);
    if (element.second != ground) entries.emplace_back(element.second, element.second, element.coefficient);
    if (element.first == ground || element.second == ground) continue;
    entries.emplace_back(element.first, element.second, -element.coefficient);
    entries.emplace_back(element.second, element.first, -element.coefficient);
  }
  SparseMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Adds the matrices of beams and trusses, row by row; rows of what is fixed fall away.
void add_structure(const model::Structure& structure, Triplets& mass, Triplets& damping, Triplets& stiffness) {
  model::ElementEquations equations;
  for (const auto& element : structure.elements) {
    model::equations_of(structure, element, equations);
    const double retardation = structure.properties[static_cast<std::size_t>(element.properties)].retardation_time;
    for (int j = 0; j < equations.size; ++j) {
      const Index column = equations.place[static_cast<std::size_t>(j)];
      if (column == ground) continue;
      for (int i = 0; i < equations.size; ++i) {
        const Index row = equations.place[static_cast<std::size_t>(i)];
        if (row == ground) continue;
        if (equations.stiffness(i, j) != 0.0) stiffness.emplace_back(row, column, equations.stiffness(i, j));
        if (retardation * equations.stiffness(i, j) != 0.0)
          damping.emplace_back(row, column, retardation * equations.stiffness(i, j));
        if (equations.mass(i, j) != 0.0) mass.emplace_back(row, column, equations.mass(i, j));
      }
    }
  }
}

SparseMatrix from_triplets(Index n, const Triplets& entries) {
  SparseMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// @param is_sum  of masses and elements: then every motion of a node has inertia once a model is built, so has every
///                motion of all, and a factorisation would find nothing
void require_positive_definite(const SparseMatrix& mass, const std::vector<std::string>& names, bool is_sum) {
  // The diagonal first: it names the coordinate.
  const Vector entries = mass.diagonal();
  for (Index i = 0; i < entries.size(); ++i)
    if (!(entries[i] > 0.0))
      throw InvalidInput(
          fmt::format("the mass matrix is singular: coordinate \"{}\" has the mass {}; give it one, or "
                      "remove it",
                      names[static_cast<std::size_t>(i)], entries[i]));
  if (is_sum) return;
  numerics::OrderedFactor factor;
  factor.analyse(mass);
  if (!factor.factorise(mass))
    throw InvalidInput("the mass matrix is not positive definite: some motion of the coordinates has no mass");
  // A matrix that is singular but for round-off passes: inverse iteration, in coordinates that all have the mass 1,
  // finds the motion with the least mass.
  constexpr double round_off = 64.0 * std::numeric_limits<double>::epsilon();
  const Vector root = entries.cwiseSqrt();
  Vector motion = Vector::LinSpaced(entries.size(), 1.0, 2.0).normalized(), force;
  double least = 1.0;
  for (int i = 0; i < 3 && least > round_off; ++i) {
    force = root.cwiseProduct(motion);
    factor.solve(force, motion);
    motion = root.cwiseProduct(motion).eval();
    least = 1.0 / motion.norm();
    motion *= least;
  }
  if (least > round_off) return;
  Index largest = 0;
  motion.cwiseAbs().maxCoeff(&largest);
  throw InvalidInput(
      fmt::format("the mass matrix is singular: a motion of \"{}\" together with other coordinates has no mass but "
                  "round-off; give it one, or remove the coordinate",
                  names[static_cast<std::size_t>(largest)]));
}

// M Phi diag(2 zeta omega) Phi^T M with Phi^T M Phi = 1.
SparseMatrix modal_damping(const model::ModalDampingRatios& damping, const SparseMatrix& mass,
                           const SparseMatrix& stiffness) {
  const Index n = mass.rows();
  if (n > largest_modal_size)
    throw InvalidInput(
        fmt::format("damping by modes is for up to {} coordinates, the model has {}; take "
                    "damping = {{ rayleigh = {{ mass = ..., stiffness = ... }} }}",
                    largest_modal_size, n));
  const Index damped = damping.modes < 0 ? n : damping.modes;
  if (damped > n) throw InvalidInput(fmt::format("damping: modes = {}, but the model has {} coordinates", damped, n));
  const auto given = static_cast<Index>(damping.ratios.size());
  if (given != 1 && given != damped)
    throw InvalidInput(
        fmt::format("damping: modal_ratio lists {} ratios for {} damped modes; give one for all, or one "
                    "a mode",
                    given, damped));
  const numerics::SymmetricModes modes = numerics::all_modes(stiffness, mass);
  if (!modes.has_converged)
    throw InvalidInput(
        "damping by modes: the modes of the model without sliders were not found to more than a few digits: "
        "stiffnesses "
        "and masses are too far apart; bring them closer together, or take damping = { rayleigh = { mass = ..., "
        "stiffness = ... } }");
  Vector weight = Vector::Zero(n);
  for (Index i = 0; i < damped; ++i) {
    const double ratio = damping.ratios[static_cast<std::size_t>(given == 1 ? 0 : i)];
    weight[i] = 2.0 * ratio * std::sqrt(std::max(modes.eigenvalues[i], 0.0));
  }
  const Matrix shapes = mass * modes.shapes;
  Matrix product = shapes * weight.asDiagonal() * shapes.transpose();
  product = 0.5 * (product + product.transpose()).eval();
  // Modes of parts that are not joined cancel but for round-off; zeros keep the pattern of the structure.
  return product.sparseView(product.cwiseAbs().maxCoeff(), 1e-14);
}

SparseMatrix damping_matrix(const model::Model& model, const SparseMatrix& mass, const SparseMatrix& stiffness) {
  const model::Damping& damping = model.damping;
  if (const auto* modal = std::get_if<model::ModalDampingRatios>(&damping)) {
    if (model.prescribed.empty()) return modal_damping(*modal, mass, stiffness);
    return relative_damping(
        modal_damping(*modal, free_part(mass, model.prescribed), free_part(stiffness, model.prescribed)), stiffness,
        model.prescribed);
  }
  if (const auto* rayleigh = std::get_if<model::RayleighCoefficients>(&damping))
    return rayleigh->mass * mass + rayleigh->stiffness * stiffness;
  return SparseMatrix(mass.rows(), mass.cols());
}

/// The forces that give every node the same acceleration, M times that motion, what supports hold included [n] [N].
Vector inertia_of_nodes(const model::Model& model, const model::Axis& acceleration) {
  if (model.matrices) return model.matrices->inertia * acceleration;
  Vector force = Vector::Zero(model.size());
  model::ElementEquations equations;
  const auto of_axis = [&](std::size_t axis) {
    return model::is_rotation(axis) ? 0.0 : acceleration[static_cast<Index>(axis)];
  };
  for (const auto& element : model.structure.elements) {
    model::equations_of(model.structure, element, equations);
    for (int i = 0; i < equations.size; ++i) {
      const Index row = equations.place[static_cast<std::size_t>(i)];
      if (row == ground) continue;
      for (int j = 0; j < equations.size; ++j)
        force[row] += equations.mass(i, j) * of_axis(equations.axis[static_cast<std::size_t>(j)]);
    }
  }
  for (const auto& places : model.structure.places)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (places[axis] != ground) force[places[axis]] += model.mass[places[axis]] * of_axis(axis);
  return force;
}

LoadTerm term_of(const Vector& weights, model::TimeLaw law) {
  LoadTerm term{{}, {}, std::move(law)};
  for (Index i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0.0) continue;
    term.rows.push_back(i);
    term.weights.push_back(weights[i]);
  }
  return term;
}

Vector even_load(const model::Model& model, const model::DistributedForce& force) {
  Vector load = Vector::Zero(model.size());
  model::ElementEquations equations;
  for (std::size_t e = force.first; e < force.first + force.count; ++e) {
    const auto share = model::even_load_of(model.structure, model.structure.elements[e], force.direction, equations);
    for (int i = 0; i < equations.size; ++i) {
      const Index row = equations.place[static_cast<std::size_t>(i)];
      if (row != ground) load[row] += share[i];
    }
  }
  return load;
}

/// What loads a model, but for the pull of supports that move. Laws are numbered as model::load_laws has them.
std::vector<ModelLoad> loads_of(const model::Model& model, const SparseMatrix& mass) {
  std::vector<ModelLoad> loads;
  int law = 0;
  for (const auto& force : model.forces) loads.push_back({{{force.coordinate}, {1.0}, force.law}, law++});
  for (const auto& force : model.distributed_forces)
    loads.push_back({term_of(even_load(model, force), force.law), law++});
  if (model.base_motion) {
    Vector inertia = mass * model.base_motion->direction;
    if (!model.structure.is_empty()) inertia += inertia_of_nodes(model, model.base_motion->translation);
    loads.push_back({term_of(-inertia, model.base_motion->law), law++});
  }
  if (!model.gravity.isZero(0.0))
    loads.push_back({term_of(inertia_of_nodes(model, model.gravity), model::HarmonicLaw{1.0, 0.0, 0.0})});
  return loads;
}

int laws_before_supports(const model::Model& model) {
  return static_cast<int>(model.forces.size() + model.distributed_forces.size()) + (model.base_motion ? 1 : 0);
}

Loads joined(const std::vector<ModelLoad>& loads) {
  std::vector<LoadTerm> terms;
  for (const ModelLoad& load : loads) terms.push_back(load.term);
  return Loads(std::move(terms));
}

}  // namespace

LocallyNonlinear assemble(const model::Model& model) { return assemble_with_loads(model).system; }

AssembledModel assemble_with_loads(const model::Model& model) {
  const Index n = model.size();
  LocallyNonlinear::Parts parts;
  Triplets damping;
  if (model.matrices) {
    parts.mass = model.matrices->mass;
    parts.stiffness = model.matrices->stiffness;
    if (!model.springs.empty()) parts.stiffness = SparseMatrix(parts.stiffness + from_elements(n, model.springs));
  } else {
    Triplets mass, stiffness;
    add_structure(model.structure, mass, damping, stiffness);
    for (Index i = 0; i < n; ++i)
      if (model.mass[i] != 0.0 || model.structure.is_empty()) mass.emplace_back(i, i, model.mass[i]);
    parts.mass = from_triplets(n, mass);
    parts.stiffness = from_elements(n, model.springs, std::move(stiffness));
  }
  require_positive_definite(parts.mass, model.coordinates, !model.matrices.has_value());
  parts.damping =
      damping_matrix(model, parts.mass, parts.stiffness) + from_elements(n, model.dashpots, std::move(damping));
  if (model.matrices && model.matrices->damping.nonZeros() > 0)
    parts.damping = SparseMatrix(parts.damping + model.matrices->damping);
  parts.sliders = model.sliders;
  parts.stops = model.stops;
  parts.laws = model.laws;
  parts.blocks = model.blocks;
  std::vector<ModelLoad> loads = loads_of(model, parts.mass);
  parts.start.q = model.position;
  parts.start.v = model.velocity;
  parts.coordinates = model.coordinates;
  parts.is_rotation = model.is_rotation;
  parts.reference = model::reference_value(model.structure, model.mass);
  parts.held_forces = model.held_forces;
  parts.held_displacements = model.held_displacements;
  if (!model.prescribed.empty()) eliminate_supports(parts, model.prescribed, laws_before_supports(model), loads);
  parts.loads = joined(loads);
  return {LocallyNonlinear(std::move(parts)), std::move(loads)};
}

}  // namespace rubato::system
