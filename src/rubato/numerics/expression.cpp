#include <rubato/core/error.hpp>
#include <rubato/core/excerpt.hpp>
#include <rubato/numerics/expression.hpp>
#include <rubato/numerics/formula_spelling.hpp>
#include <rubato/numerics/mu_parser.hpp>
#include <rubato/numerics/time_formula.hpp>

#include <cctype>
#include <optional>
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
      throw InvalidInput("in the expression \"" + excerpt(text) + "\": \"=\" at character " + std::to_string(i + 1) +
                         " assigns, which a formula cannot; a comparison is written \"==\"");
  }
  if (parser.GetNumResults() > 1)
    throw InvalidInput("in the expression \"" + excerpt(text) + "\": " + std::to_string(parser.GetNumResults()) +
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

/// Throws InvalidInput where the text is no formula of the parameters and, unless it is null, of t.
void prepare(mu::Parser& parser, const std::string& text, const Parameters& parameters, double* t) {
  try {
    set_up(parser);
    for (const auto& [name, value] : parameters) parser.DefineConst(name, value);
    if (t) parser.DefineVar("t", t);
    parser.SetExpr(with_single_signs(text));
    (void)parser.Eval();
    require_one_value(text, parser);
  } catch (const mu::Parser::exception_type& fault) {
    const std::string message = "in the expression \"" + excerpt(text) + "\": ";
    const bool at_end = fault.GetPos() < 0 || static_cast<std::size_t>(fault.GetPos()) >= text.size();
    const std::size_t place = at_end ? text.size() : static_cast<std::size_t>(fault.GetPos());
    const std::string where = at_end ? " at its end" : " at character " + std::to_string(character_of(text, place));
    if (fault.GetCode() != mu::ecUNASSIGNABLE_TOKEN)
      throw InvalidInput(message + excerpt(without_position(fault.GetMsg())) + where + syntax_hint(text, place));
    if (const std::string symbol = symbol_at(text, place); !symbol.empty())
      throw InvalidInput(message + "unexpected \"" + symbol + "\"" + where + symbol_hint(symbol));
    std::vector<std::string> known{"pi"};
    if (t) known.push_back("t");
    for (const auto& parameter : parameters) known.push_back(parameter.first);
    const std::string& name = fault.GetToken();
    const std::size_t next = text.find_first_not_of(" \t", place + name.size());
    throw InvalidInput(message + "unknown name \"" + excerpt(name) + "\"" + where +
                       name_hint(text, place, name, next != std::string::npos && text[next] == '(', known));
  }
}

}  // namespace

void require_expression(const std::string& text, const Parameters& parameters, bool of_time) {
  mu::Parser parser;
  double t = 0.0;
  prepare(parser, text, parameters, of_time ? &t : nullptr);
}

bool is_function(const std::string& name) {
  const mu::Parser parser;
  return parser.GetFunDef().count(name) > 0;
}

struct Expression::Engine {
  mu::Parser parser;
  double t = 0.0;
  std::optional<TimeFormula> switching;  // where it branches
};

Expression::Expression(std::string text, const Parameters& parameters, bool of_time)
    : text_(std::move(text)), parameters_(parameters), of_time_(of_time), engine_(std::make_unique<Engine>()) {
  prepare(engine_->parser, text_, parameters_, of_time_ ? &engine_->t : nullptr);
  if (of_time_) engine_->switching = switching_formula(text_, parameters_);
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

double Expression::from_left(double t) const {
  return engine_->switching ? engine_->switching->from_left(t).value : (*this)(t);
}

double Expression::from_right(double t) const {
  return engine_->switching ? engine_->switching->from_right(t).value : (*this)(t);
}

std::vector<double> Expression::switches(double from, double to) const {
  return engine_->switching ? engine_->switching->switches(from, to) : std::vector<double>{};
}

}  // namespace rubato::numerics
