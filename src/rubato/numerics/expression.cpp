#include <rubato/core/error.hpp>
#include <rubato/numerics/expression.hpp>

#include <muParser.h>

#include <numbers>

namespace rubato::numerics {

struct Expression::Engine {
  mu::Parser parser;
  double t = 0.0;
};

Expression::Expression(std::string text, const Parameters& parameters, bool of_time)
    : text_(std::move(text)), parameters_(parameters), of_time_(of_time), engine_(std::make_unique<Engine>()) {
  try {
    mu::Parser& parser = engine_->parser;
    parser.ClearConst();
    parser.DefineConst("pi", std::numbers::pi);
    for (const auto& [name, value] : parameters_) parser.DefineConst(name, value);
    if (of_time_) parser.DefineVar("t", &engine_->t);
    parser.SetExpr(text_);
    (void)parser.Eval();
  } catch (const mu::Parser::exception_type& fault) {
    std::string message = "in the expression \"" + text_ + "\": ";
    const std::string where = " at character " + std::to_string(fault.GetPos() + 1);
    if (fault.GetCode() == mu::ecUNASSIGNABLE_TOKEN) {
      std::vector<std::string> known{"pi"};
      if (of_time_) known.push_back("t");
      for (const auto& parameter : parameters_) known.push_back(parameter.first);
      message += "unknown name \"" + fault.GetToken() + "\"" + where + suggestion(fault.GetToken(), known);
    } else {
      std::string reason = fault.GetMsg();
      while (!reason.empty() && (reason.back() == '.' || reason.back() == '\n')) reason.pop_back();
      message += reason + where;
    }
    throw InvalidInput(message);
  }
}

Expression::Expression(const Expression& other) : Expression(other.text_, other.parameters_, other.of_time_) {}
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(const Expression& other) { return *this = Expression(other); }
Expression& Expression::operator=(Expression&&) noexcept = default;
Expression::~Expression() = default;

double Expression::operator()(double t) const {
  engine_->t = t;
  return engine_->parser.Eval();
}

}  // namespace rubato::numerics
