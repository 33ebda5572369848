#include <rubato/analysis/method_study_comparison.hpp>
#include <rubato/integrate/catalogue.hpp>
#include <rubato/integrate/exact/first_exit.hpp>

#include <algorithm>
#include <array>
#include <span>

namespace rubato::analysis {
namespace {

class Sampler final : public integrate::ExactVisitor {
 public:
  Sampler(const Observed& observed, ExactResponse& response) : observed_(observed), response_(response) {}

  bool sample(const system::State& state, const integrate::ExactWork&) override {
    response_.values.push_back(observed_.of(state.q));
    return true;
  }
  bool transition(const system::State&, const integrate::Transition&, const integrate::ExactWork&) override {
    return true;
  }
  bool piece(const integrate::TaylorPiece& piece, double, double length,
             const std::vector<integrate::SliderState>&) override {
    const Matrix& q = piece.displacements();
    const Index first = observed_.first, second = observed_.second;
    std::array<double, integrate::TaylorPiece::degree + 1> coefficients;
    for (Index k = 0; k < piece.terms(); ++k)
      coefficients[static_cast<std::size_t>(k)] = q(first, k) - (second == ground ? 0.0 : q(second, k));
    integrate::ValueRange range;
    integrate::include_ranges(std::span(coefficients).first(static_cast<std::size_t>(piece.terms())), length,
                              {&range, 1});
    response_.largest = std::max({response_.largest, -range.low, range.high});
    return true;
  }

 private:
  const Observed& observed_;
  ExactResponse& response_;
};

}  // namespace

ExactResponse exact_response(const MethodStudyPlan& plan, const integrate::SystemKind& kind, double step) {
  const integrate::MarchPlan exact = march_plan_of(integrate::make_method("exact"), kind, 0.0, plan.duration);
  const integrate::StepCount count = integrate::count_steps(plan.duration, step);
  std::vector<double> times;
  for (long i = 0; i <= count.full; ++i) times.push_back(std::min(static_cast<double>(i) * step, plan.duration));
  ExactResponse response;
  Sampler sampler(plan.observed, response);
  (void)kind.marches().flow(exact)->go_to(plan.duration, times, sampler, false);
  return response;
}

}  // namespace rubato::analysis
