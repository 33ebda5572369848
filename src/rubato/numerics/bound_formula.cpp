#include <rubato/numerics/bound_formula.hpp>
#include <rubato/numerics/formula_spelling.hpp>
#include <rubato/numerics/mu_parser.hpp>

namespace rubato::numerics {

struct BoundFormula::Engine {
  mu::Parser parser;
};

BoundFormula::BoundFormula(const std::string& text, const Parameters& parameters, const double* values)
    : engine_(std::make_unique<Engine>()) {
  (void)Expression(text, parameters);  // says what is wrong in words of ours
  mu::Parser& parser = engine_->parser;
  set_up(parser);
  // muParser keeps variables by pointer to non-const; a formula that assigns was refused above.
  for (std::size_t i = 0; i < parameters.size(); ++i)
    parser.DefineVar(parameters[i].first, const_cast<double*>(values + i));
  parser.SetExpr(with_single_signs(text));
  (void)parser.Eval();
}

BoundFormula::BoundFormula(BoundFormula&&) noexcept = default;
BoundFormula& BoundFormula::operator=(BoundFormula&&) noexcept = default;
BoundFormula::~BoundFormula() = default;

double BoundFormula::operator()() const { return engine_->parser.Eval(); }

std::vector<std::size_t> parameters_used(const std::string& text, const Parameters& parameters, bool of_time) {
  (void)Expression(text, parameters, of_time);
  mu::Parser parser;
  set_up(parser);
  std::vector<double> values(parameters.size() + 1, 1.0);
  for (std::size_t i = 0; i < parameters.size(); ++i) parser.DefineVar(parameters[i].first, &values[i]);
  if (of_time) parser.DefineVar("t", &values.back());
  parser.SetExpr(with_single_signs(text));
  const auto& used = parser.GetUsedVar();
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (used.count(parameters[i].first) > 0) places.push_back(i);
  return places;
}

}  // namespace rubato::numerics
