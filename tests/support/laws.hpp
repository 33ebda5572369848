#pragma once

#include <rubato/model/laws/law_kind.hpp>

#include "support/models.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

// Structures with other laws than sliders and stops, and laws that only tests have.
namespace rubato::testing {

/// A spring kT behind a slip joint that yields at a limit: what a slider is, by the general route. Its memory is where
/// the joint stands [m].
class JenkinsLaw final : public model::Law {
 public:
  JenkinsLaw(double stiffness, double limit) : stiffness_(stiffness), limit_(limit) {}
  Index memory_size() const override { return 1; }
  model::LawAnswer advance(const model::LawPoint&, const double* memory, const model::LawPoint& to,
                           double* next) const override {
    const double trial = stiffness_ * (to.u - memory[0]), force = std::clamp(trial, -limit_, limit_);
    next[0] = to.u - force / stiffness_;
    return {force, force == trial ? stiffness_ : 0.0, 0.0};
  }
  model::LawAnswer at(const model::LawPoint& point, const double* memory) const override {
    return {std::clamp(stiffness_ * (point.u - memory[0]), -limit_, limit_), stiffness_, 0.0};
  }
  double stored_energy(double u, const double* memory) const override {
    return 0.5 * stiffness_ * (u - memory[0]) * (u - memory[0]);
  }
  double dissipated(const model::LawPoint&, const double* memory, const model::LawPoint&,
                    const double* next) const override {
    return limit_ * std::abs(next[0] - memory[0]);
  }
  double largest_stiffness() const override { return stiffness_; }
  bool is_odd() const override { return true; }
  bool is_exact_between_guards() const override { return true; }
  double guard(const model::LawPoint& from, const double* memory, const model::LawPoint& to,
               double near) const override {
    const double force = stiffness_ * (from.u - memory[0]), side = force > 0.0 ? 1.0 : -1.0;
    const bool is_at_limit = limit_ - std::abs(force) <= 1e-14 * limit_ + near * stiffness_ * std::abs(from.rate);
    if (is_at_limit && side * from.rate > 0.0) return side * to.rate;
    return limit_ - std::abs(force + stiffness_ * (to.u - from.u));
  }

 private:
  double stiffness_, limit_;
};

/// A spring k whose end follows it at a rate r of the distance: it relaxes as exp(-r t) (a Maxwell element).
class CreepLaw final : public model::Law {
 public:
  CreepLaw(double stiffness, double rate) : stiffness_(stiffness), rate_(rate) {}
  Index memory_size() const override { return 1; }
  model::LawAnswer advance(const model::LawPoint& from, const double* memory, const model::LawPoint& to,
                           double* next) const override {
    // u in a straight line: exact.
    const double x = rate_ * (to.t - from.t), kept = std::exp(-x), share = x > 0.0 ? -std::expm1(-x) / x : 1.0;
    next[0] = to.u - kept * (from.u - memory[0]) - share * (to.u - from.u);
    return {stiffness_ * (to.u - next[0]), stiffness_ * share, 0.0};
  }
  model::LawAnswer at(const model::LawPoint& point, const double* memory) const override {
    return {stiffness_ * (point.u - memory[0]), stiffness_, 0.0};
  }
  double stored_energy(double u, const double* memory) const override {
    return 0.5 * stiffness_ * (u - memory[0]) * (u - memory[0]);
  }
  double dissipated(const model::LawPoint& from, const double* memory, const model::LawPoint& to,
                    const double* next) const override {
    const double before = stiffness_ * (from.u - memory[0]), after = stiffness_ * (to.u - next[0]);
    return 0.5 * (before + after) * (next[0] - memory[0]);
  }
  double largest_stiffness() const override { return stiffness_; }
  bool is_odd() const override { return true; }

 private:
  double stiffness_, rate_;
};

/// A law of the study file by its keys, in their order.
inline std::shared_ptr<const model::Law> made(const std::string& table, const std::vector<double>& values) {
  model::LawDescription description;
  description.kind = table;
  for (const double value : values) description.values.emplace_back(value);
  return model::law_kind(table).make(description, {}, table);
}

inline std::shared_ptr<const model::Law> spring(const std::string& formula) {
  model::LawDescription description;
  description.kind = "nonlinear_spring";
  model::Quantity force;
  force.expression = formula;
  description.values.push_back(force);
  return model::law_kind("nonlinear_spring").make(description, {}, "nonlinear_spring");
}

/// A mass on a spring, a damper and a law to the ground, under amplitude cos(w t) and a static load.
inline system::LocallyNonlinear mass_on(std::shared_ptr<const model::Law> law, double damping, double stiffness,
                                        double amplitude, double angular_frequency, double static_load = 0.0) {
  system::LocallyNonlinear::Parts parts;
  parts.mass = sparse(Matrix::Identity(1, 1));
  parts.damping = sparse(damping * Matrix::Identity(1, 1));
  parts.stiffness = sparse(stiffness * Matrix::Identity(1, 1));
  std::vector<system::LoadTerm> loads{harmonic(0, amplitude, angular_frequency)};
  if (static_load != 0.0) loads.push_back(harmonic(0, static_load, 0.0));
  parts.loads = system::Loads(std::move(loads));
  parts.laws.push_back({"law", "law", 0, ground, std::move(law)});
  parts.coordinates = {"mass"};
  return system::LocallyNonlinear(std::move(parts));
}

/// single_mass() with a law in the place of its slider.
inline system::LocallyNonlinear single_mass_on(std::shared_ptr<const model::Law> law, double angular_frequency = 2.0) {
  return mass_on(std::move(law), 1.0, 1.0, 1.0, angular_frequency);
}

/// x'' + .05 x' + x + .1 x^3 = .18 cos(w t) (friction-family reference, section 6).
inline system::LocallyNonlinear duffing(double angular_frequency) {
  return mass_on(spring("0.1*u^3"), 0.05, 1.0, 0.18, angular_frequency);
}

/// Steady motions of a mass on a Bouc-Wen element alone, m = 1, c = .02, k = 1, alpha = .1, A = 1, beta = gamma = .5,
/// F = .3 (section 9).
struct BoucWenPoint {
  double n, angular_frequency, amplitude, work;
};
inline constexpr BoucWenPoint bouc_wen_points[] = {
    {1, 0.7, 0.847936441856, 0.33720943227},  {1, 0.85, 1.3257405138, 1.12861316178},
    {1, 1.0, 0.991463047334, 0.521487967447}, {2, 0.7, 0.642662212912, 0.0758199955675},
    {2, 0.85, 1.34836949001, 1.16555726886},  {2, 1.0, 1.15416536236, 0.69696710315}};
inline system::LocallyNonlinear bouc_wen_mass(double n, double angular_frequency) {
  return mass_on(made("bouc_wen", {1.0, 0.1, 1.0, 0.5, 0.5, n}), 0.02, 0.0, 0.3, angular_frequency);
}

}  // namespace rubato::testing
