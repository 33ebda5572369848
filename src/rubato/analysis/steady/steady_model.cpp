#include <rubato/analysis/equilibrium_text.hpp>
#include <rubato/analysis/steady/parametric_excitation.hpp>
#include <rubato/analysis/steady/steady_model.hpp>
#include <rubato/core/error.hpp>
#include <rubato/model/build_mechanism.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

namespace rubato::analysis {
namespace {

/// Null: it does not swing. A frequency by a formula is one that the points of the response give.
const model::HarmonicDescription* swinging(const model::ForceDescription& force) {
  const auto* harmonic = std::get_if<model::HarmonicDescription>(&force.law);
  if (!harmonic) return nullptr;
  const model::Quantity& frequency = harmonic->angular_frequency;
  return frequency.value != 0.0 || !frequency.expression.empty() ? harmonic : nullptr;
}

model::HarmonicLaw law_of(const model::HarmonicDescription& harmonic, const numerics::Parameters& values,
                          const std::string& part) {
  const double factor = harmonic.frequency_in_hertz ? 2.0 * std::numbers::pi : 1.0;
  return {model::evaluate(harmonic.amplitude, values, part + ": amplitude"),
          factor * model::evaluate(harmonic.angular_frequency, values, part + ": angular_frequency"),
          model::evaluate(harmonic.phase, values, part + ": phase")};
}

std::string without_motion(const integrate::SmallMotions& motions) {
  const std::string stops =
      motions.rigid_stops.empty()
          ? ""
          : fmt::format(" (held by the rigid stop{} of \"{}\": give a stiffness to what is to give way)",
                        motions.rigid_stops.size() == 1 ? "" : "s", fmt::join(motions.rigid_stops, "\", \""));
  return fmt::format(
      "the joints and locks leave no motion in the equilibrium{}; leave a joint or a latch out, or run type = "
      "\"static\" to see what holds it there",
      stops);
}

/// The loads that swing, on the motions that the joints leave. Their places among the laws of all loads are those of
/// the forces: a mechanism has no others.
std::vector<system::ModelLoad> loads_on(const model::ModelDescription& model, const integrate::MotionsAboutRest& about,
                                        const numerics::Parameters& values) {
  std::vector<system::ModelLoad> loads;
  const auto& names = about.coordinates;
  for (std::size_t j = 0; j < model.forces.size(); ++j) {
    const model::ForceDescription& force = model.forces[j];
    const auto* harmonic = swinging(force);
    if (!harmonic) continue;
    const auto found = std::find(names.begin(), names.end(), force.on);
    if (found == names.end())
      throw InvalidInput(force.where, fmt::format("the force on \"{}\" acts on no coordinate that moves", force.on));
    system::ModelLoad load;
    const model::HarmonicLaw law = law_of(*harmonic, values, fmt::format("the force on \"{}\"", force.on));
    load.term.law = law;
    load.law = static_cast<int>(j);
    const auto row = about.motions.basis.row(found - names.begin());
    for (Index i = 0; i < row.size(); ++i) {
      if (row[i] == 0.0) continue;
      load.term.rows.push_back(i);
      load.term.weights.push_back(row[i]);
    }
    loads.push_back(std::move(load));
  }
  return loads;
}

std::vector<std::string> warnings_of(const integrate::MotionsAboutRest& about, const integrate::SmallMotions& motions) {
  std::vector<std::string> warnings = about.told;
  if (!motions.rigid_stops.empty())
    warnings.push_back(
        fmt::format("the rigid stop{} of \"{}\" hold{} in the equilibrium, and this response takes {} for joints: a "
                    "stop lets go where its reaction would pull, which only a transient follows; give it a stiffness, "
                    "which is followed",
                    motions.rigid_stops.size() == 1 ? "" : "s", fmt::join(motions.rigid_stops, "\", \""),
                    motions.rigid_stops.size() == 1 ? "s" : "", motions.rigid_stops.size() == 1 ? "it" : "them"));
  if (!about.starts_at_rest)
    warnings.push_back(
        "the velocities at the start take no part: small motions are those about a rest, without gyroscopic and "
        "centrifugal forces");
  return warnings;
}

SteadyModel about_rest(const model::StudyDescription& study, const numerics::Parameters& values) {
  auto about = integrate::motions_about_rest(without_harmonic_loads(study).model, values);
  if (const std::string failure = complaint(about.found); !failure.empty())
    throw InvalidInput(fmt::format("without its harmonic loads, {}", failure));
  if (!about.found.is_stable)
    throw InvalidInput(
        "the equilibrium without the harmonic loads is not stable: what begins beside it goes away from it, and no "
        "steady response stays near; begin beside it to be led to one that is (type = \"static\" shows where)");
  if (about.motions.basis.cols() == 0) throw InvalidInput(without_motion(about.motions));
  if (about.motions.skew > 0.0)
    throw InvalidInput(
        fmt::format("the stiffness about the equilibrium is not symmetric, by {:.2g} of its size: loads that follow "
                    "their body, or moments about axes of the world, have no potential, which the solvers of steady "
                    "responses need; run a transient, or modes, which tell of flutter",
                    about.motions.skew));
  auto loads = loads_on(study.model, about, values);
  auto assembled = integrate::under_loads(about.motions, std::move(loads));
  return {std::move(assembled), AboutRest(std::move(about))};
}

}  // namespace

AboutRest::AboutRest(integrate::MotionsAboutRest about)
    : motions_(std::move(about.motions)), names_(std::move(about.coordinates)) {
  about.motions.rigid_stops = motions_.rigid_stops;
  warnings_ = warnings_of(about, motions_);
  for (std::size_t i = 0; i < names_.size(); ++i)
    if (about.is_rotation[i] != 0) turning_.push_back(static_cast<Index>(i));
  turns_.resize(static_cast<Index>(turning_.size()), motions_.basis.cols());
  for (std::size_t k = 0; k < turning_.size(); ++k) turns_.row(static_cast<Index>(k)) = motions_.basis.row(turning_[k]);
}

steady::SteadyRequest::Observed AboutRest::observed(const Observed& one) const {
  Vector row = motions_.shares.row(one.first).transpose();
  if (one.second != ground) row -= motions_.shares.row(one.second).transpose();
  steady::SteadyRequest::Observed observed{ground, ground, {}};
  for (Index i = 0; i < row.size(); ++i)
    if (row[i] != 0.0) observed.shares.push_back({i, row[i]});
  return observed;
}

void AboutRest::place(const std::vector<Observed>& observed, steady::SteadyResponse& response) const {
  for (std::size_t o = 0; o < observed.size(); ++o) {
    const auto i = static_cast<Index>(o);
    const double at = observed[o].of(motions_.place), mean = response.mean[i];
    if (std::isfinite(response.rms[i]))
      response.rms[i] = std::sqrt(std::max(0.0, response.rms[i] * response.rms[i] + at * (2.0 * mean + at)));
    response.mean[i] = mean + at;
  }
}

void AboutRest::place(steady::Waveform& waveform) const {
  waveform.position = ((motions_.shares * waveform.position).colwise() + motions_.place).eval();
  waveform.velocity = (motions_.shares * waveform.velocity).eval();
}

AboutRest::Excursion AboutRest::excursion(const Matrix& position) const {
  Excursion result;
  if (!turning_.empty()) {
    Index row = 0, column = 0;
    result.turn = (turns_ * position).cwiseAbs().maxCoeff(&row, &column);
    result.coordinate = turning_[static_cast<std::size_t>(row)];
  }
  for (std::size_t i = 0; i < motions_.locks.size() && result.lock < 0; ++i) {
    const auto& lock = motions_.locks[i];
    if ((lock.sign * (lock.share.transpose() * position)).maxCoeff() > lock.room) result.lock = static_cast<int>(i);
  }
  return result;
}

std::string AboutRest::told(const Excursion& excursion) const {
  if (excursion.lock >= 0) {
    const auto& lock = motions_.locks[static_cast<std::size_t>(excursion.lock)];
    return fmt::format(
        "the motion {} the lock of \"{}\", {:.4g} {} from the equilibrium, and this response goes on as if it did not; "
        "{}run a transient there",
        lock.is_held ? "leaves" : "comes to", lock.name, lock.room, lock.is_angle ? "rad" : "m",
        lock.is_damped_spring ? "leave out its damping, and its stiffness is followed, or " : "");
  }
  if (!(excursion.turn > large_turn)) return {};
  return fmt::format(
      "\"{}\" turns by {:.3g} rad from the equilibrium: the joints are taken for linear there, which is off by about "
      "the square of that; compare with a transient",
      names_[static_cast<std::size_t>(excursion.coordinate)], excursion.turn);
}

steady::SteadyRequest SteadyModel::request(const std::vector<Observed>& observed, steady::SteadyRequest asked) const {
  asked.observed.clear();
  for (const Observed& one : observed)
    asked.observed.push_back(about ? about->observed(one) : steady::SteadyRequest::Observed{one.first, one.second, {}});
  return asked;
}

void require_swinging_loads(const model::ModelDescription& model, const numerics::Parameters& values) {
  for (const model::ForceDescription& force : model.forces) {
    const auto* harmonic = swinging(force);
    if (!harmonic) continue;
    const std::string part = fmt::format("the force on \"{}\"", force.on);
    if (law_of(*harmonic, values, part).angular_frequency != 0.0) continue;
    throw InvalidInput(force.where, fmt::format("{} has a frequency of zero here (\"{}\"), and would move the "
                                                "equilibrium; say what does not swing as an expression without t",
                                                part, harmonic->angular_frequency.expression));
  }
}

SteadyModel build_steady_model(const model::StudyDescription& study, const numerics::Parameters& values) {
  if (model::is_mechanism(study.model)) {
    require_swinging_loads(study.model, values);
    return about_rest(study, values);
  }
  return {build_structure(study, values), std::nullopt};
}

model::StudyDescription without_harmonic_loads(const model::StudyDescription& study) {
  model::StudyDescription still = study;
  auto& forces = still.model.forces;
  forces.erase(std::remove_if(forces.begin(), forces.end(),
                              [](const model::ForceDescription& force) { return swinging(force) != nullptr; }),
               forces.end());
  return still;
}

void refuse_beyond_small_motions(const StudyInput& input, const Location& where, const std::string& title) {
  const model::ModelDescription& model = input.study.model;
  const auto refuse = [&](const Location& at, const std::string& what, const std::string& instead) {
    throw InvalidInput(at.line > 0 ? at : where, fmt::format("{}{}; {}", title, what, instead));
  };
  for (const model::JointDescription& joint : model.joints) {
    if (joint.motion) {
      const auto* formula = std::get_if<model::TimeFormulaDescription>(&joint.motion->law);
      if (!formula || !model::is_constant(*formula, input.parameters))
        refuse(joint.motion->where,
               fmt::format("the drive of \"{}\" moves it, and small motions are about a rest", joint.name),
               "hold it with a drive that is constant and apply a harmonic [[force]], or run a transient");
    }
    const char* linear =
        "what follows the motion of a joint linearly is its stiffness and damping, and what does not is a "
        "[[nonlinear_spring]] on it, which this response carries";
    if (joint.drive_table) refuse(joint.where, fmt::format("the law of \"{}\" is a table", joint.name), linear);
    if (joint.drive && !joint.drive->expression.empty() &&
        !numerics::is_formula_of(input.parameters, joint.drive->expression))
      refuse(joint.drive->where, fmt::format("the law of \"{}\" is a formula of its motion or of t", joint.name),
             std::string(linear) + "; what swings is a harmonic [[force]]");
  }
  const auto& names = input.kind.system().coordinates();
  const bool in_space = std::any_of(names.begin(), names.end(), [](const auto& name) { return name.ends_with(".z"); });
  for (const model::ForceDescription& force : model.forces) {
    if (!swinging(force)) continue;
    const auto found = std::find(names.begin(), names.end(), force.on);
    const bool turns = found != names.end() && input.kind.system().is_rotation(found - names.begin());
    const bool stays = !force.follows && force.follows_where.line > 0;
    if (force.follows && !turns)
      refuse(force.where, fmt::format("the force on \"{}\" swings and turns with its body", force.on),
             "take a force along an axis of the world, or run a transient");
    if (turns && stays && in_space)
      refuse(force.where, fmt::format("the moment on \"{}\" swings about an axis of the world", force.on),
             "leave out what keeps its axis: small turns do not tell them apart; or run a transient");
  }
  using Family = integrate::NonlinearPart::Family;
  for (const integrate::NonlinearPart& part : input.kind.nonlinear_parts())
    if (part.family == Family::pressed_slider)
      refuse(where,
             fmt::format("the {} \"{}\" is not carried to small motions of a mechanism yet", part.kind, part.name),
             "give it a normal_load that is a number, or run a transient");
}

}  // namespace rubato::analysis
