#include <rubato/core/error.hpp>
#include <rubato/numerics/expression.hpp>

#include <muParser.h>

#include <cctype>
#include <numbers>
#include <regex>

namespace rubato::numerics {

namespace {

// muParser would assign to t, and take the last value of a list: a decimal comma would give "1,5" the value 5.
void require_one_value(const std::string& text, const mu::Parser& parser) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    const bool compares = (i + 1 < text.size() && text[i + 1] == '=') ||
                          (i > 0 && std::string("=<>!").find(text[i - 1]) != std::string::npos);
    if (!compares)
      throw InvalidInput("in the expression \"" + text + "\": \"=\" at character " + std::to_string(i + 1) +
                         " assigns, which a formula cannot; a comparison is written \"==\"");
  }
  if (parser.GetNumResults() > 1)
    throw InvalidInput("in the expression \"" + text + "\": " + std::to_string(parser.GetNumResults()) +
                       " values with commas between them; give one, with a point for its decimals");
}

// muParser counts from 0 in its text; what it says of the place is said once, from 1.
std::string without_position(const std::string& message) {
  static const std::regex position("( found)?( at)?( expression)? position [0-9]+");
  std::string text = std::regex_replace(message, position, "");
  while (!text.empty() &&
         (text.back() == '.' || text.back() == '!' || std::isspace(static_cast<unsigned char>(text.back()))))
    text.pop_back();
  if (!text.empty()) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

}  // namespace

bool is_function(const std::string& name) {
  const mu::Parser parser;
  return parser.GetFunDef().count(name) > 0;
}

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
    require_one_value(text_, parser);
  } catch (const mu::Parser::exception_type& fault) {
    std::string message = "in the expression \"" + text_ + "\": ";
    const bool at_end = fault.GetPos() < 0 || static_cast<std::size_t>(fault.GetPos()) >= text_.size();
    const std::string where = at_end ? " at its end" : " at character " + std::to_string(fault.GetPos() + 1);
    if (fault.GetCode() == mu::ecUNASSIGNABLE_TOKEN) {
      std::vector<std::string> known{"pi"};
      if (of_time_) known.push_back("t");
      for (const auto& parameter : parameters_) known.push_back(parameter.first);
      message += "unknown name \"" + fault.GetToken() + "\"" + where + suggestion(fault.GetToken(), known);
    } else {
      message += without_position(fault.GetMsg()) + where;
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
