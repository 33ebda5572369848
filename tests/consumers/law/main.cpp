// A law of one's own: Dahl's friction, df/du = s (1 - sgn(du) f / F), marched by several methods. A Bouc-Wen element
// with alpha = gamma = 0, n = 1, k = s and beta = s / F is the same law in other words.
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/driver.hpp>
#include <rubato/integrate/stepper.hpp>
#include <rubato/model/laws/law_kind.hpp>

#include <cmath>
#include <cstdio>
#include <memory>

using namespace rubato;

class Dahl final : public model::Law {
 public:
  Dahl(double stiffness, double force) : stiffness_(stiffness), force_(force) {}

  Index memory_size() const override { return 1; }  // its force
  model::LawAnswer advance(const model::LawPoint& from, const double* memory, const model::LawPoint& to,
                           double* next) const override {
    const double travel = to.u - from.u, limit = std::copysign(force_, travel);
    next[0] = limit - (limit - memory[0]) * std::exp(-stiffness_ * std::abs(travel) / force_);
    return {next[0], stiffness_ * (1.0 - next[0] / limit), 0.0};
  }
  model::LawAnswer at(const model::LawPoint&, const double* memory) const override {
    return {memory[0], stiffness_, 0.0};
  }
  double stored_energy(double, const double* memory) const override { return 0.5 * memory[0] * memory[0] / stiffness_; }
  double dissipated(const model::LawPoint& from, const double* memory, const model::LawPoint& to,
                    const double* next) const override {
    const double travel = to.u - from.u, limit = std::copysign(force_, travel);
    const double work = limit * travel - limit / stiffness_ * (next[0] - memory[0]);
    return work - stored_energy(0.0, next) + stored_energy(0.0, memory);
  }
  bool is_exact_between_guards() const override { return true; }
  double guard(const model::LawPoint& from, const double*, const model::LawPoint& to, double) const override {
    return std::copysign(1.0, from.rate) * to.rate;  // the motion turns
  }

 private:
  double stiffness_, force_;
};

double end_of_march(std::shared_ptr<const model::Law> law, const char* method) {
  system::LocallyNonlinear::Parts parts;
  parts.mass.resize(1, 1);
  parts.mass.setIdentity();
  parts.stiffness = parts.mass;
  parts.damping = 0.01 * parts.mass;
  parts.laws = {{"friction", "dahl", 0, ground, std::move(law)}};
  parts.start.q = Vector::Constant(1, 1.0);
  parts.coordinates = {"mass"};
  const system::LocallyNonlinear system(std::move(parts));
  const auto stepper = integrate::make_stepper(integrate::make_method(method), system);
  auto state = integrate::consistent_start(system, system.start());
  const auto report = integrate::march(*stepper, state, 0.01, 8.0);
  return report.end == integrate::MarchEnd::reached ? state.q[0] : std::nan("");
}

int main() {
  const double stiffness = 5.0, force = 0.1;
  model::LawDescription same = model::law_description(model::law_kind("bouc_wen"));
  same.values = {stiffness, 0.0, 1.0, stiffness / force, 0.0, 1.0};
  const auto bouc_wen = model::law_kind("bouc_wen").make(same, {}, "the same law");
  bool is_right = true;
  for (const char* method : {"generalized_alpha", "average_acceleration", "rk4", "dormand_prince"}) {
    const double own = end_of_march(std::make_shared<Dahl>(stiffness, force), method);
    const double built_in = end_of_march(bouc_wen, method);
    std::printf("%s: x = %.12f m with a law of one's own, %.12f m with the Bouc-Wen element\n", method, own, built_in);
    is_right = is_right && std::abs(own - built_in) < 1e-10;
  }
  return is_right ? 0 : 1;
}
