#include <rubato/numerics/formula_faults.hpp>
#include <rubato/numerics/formula_tree.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string_view>

namespace rubato::numerics {
namespace {

using Kind = FormulaTree::Kind;

std::vector<std::string> known_names(const Parameters& parameters, bool of_time,
                                     const std::vector<std::string>& others) {
  std::vector<std::string> known{"pi"};
  if (of_time) known.push_back("t");
  known.insert(known.end(), others.begin(), others.end());
  for (const auto& parameter : parameters) known.push_back(parameter.first);
  return known;
}

class Parser {
 public:
  Parser(const std::string& text, const Parameters& parameters, bool of_time, const std::vector<std::string>& others)
      : text_(text),
        parameters_(parameters),
        of_time_(of_time),
        others_(others),
        faults_(text, known_names(parameters, of_time, others)) {}

  FormulaTree parse() {
    (void)choice();
    std::size_t values = 1;
    for (; takes(","); ++values) (void)choice();
    if (!is_at_end()) refuse_next();
    if (values > 1) faults_.list(values);
    return std::move(tree_);
  }

 private:
  /// What is read within brackets, signs and powers: of the recursion and of the stack.
  class Nesting {
   public:
    explicit Nesting(Parser& parser) : parser_(parser) {
      if (++parser_.nesting_ > FormulaTree::deepest) parser_.refuse_nesting();
    }
    ~Nesting() { --parser_.nesting_; }
    Nesting(const Nesting&) = delete;
    Nesting& operator=(const Nesting&) = delete;

   private:
    Parser& parser_;
  };

  // The program. The stack is as deep as what has been put on it and not taken.
  int place() const { return static_cast<int>(tree_.program.size()); }
  int instruct(FormulaTree::Instruction instruction, int change) {
    stack_ += change;
    tree_.depth = std::max(tree_.depth, stack_);
    if (stack_ > FormulaTree::deepest) refuse_nesting();
    tree_.program.push_back(instruction);
    return place() - 1;
  }
  FormulaTree::Node& node_at(int index) { return tree_.nodes[static_cast<std::size_t>(index)]; }
  FormulaTree::Instruction& instruction_at(int index) { return tree_.program[static_cast<std::size_t>(index)]; }
  int add_node(FormulaTree::Node node) {
    node.end = place();
    tree_.nodes.push_back(node);
    return static_cast<int>(tree_.nodes.size()) - 1;
  }

  int add_leaf(Kind kind, double constant = 0.0, int target = 0) {
    const int begin = instruct({kind, target, constant, nullptr}, 1);
    FormulaTree::Node node;
    node.kind = kind;
    node.constant = kind == Kind::other ? target : constant;
    node.begin = begin;
    return add_node(node);
  }
  int add(Kind kind, int first, int second = -1, const FormulaFunction* function = nullptr) {
    instruct({kind, 0, 0.0, function}, second < 0 ? 0 : -1);
    FormulaTree::Node node;
    node.kind = kind;
    node.function = function;
    node.first = first;
    node.second = second;
    node.begin = node_at(first).begin;
    return add_node(node);
  }

  // The text.
  void skip_blanks() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  bool is_at_end() {
    skip_blanks();
    return at_ == text_.size();
  }
  bool takes(std::string_view token) {
    skip_blanks();
    if (text_.compare(at_, token.size(), token) != 0) return false;
    at_ += token.size();
    return true;
  }
  void require(std::string_view token, const std::string& what) {
    if (takes(token)) return;
    if (is_at_end()) faults_.fail("missing " + what, at_);
    refuse_next();
  }
  static bool is_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
  std::string name_here() const {
    std::size_t end = at_;
    while (end < text_.size() && is_of_name(text_[end])) ++end;
    return text_.substr(at_, end - at_);
  }
  bool is_known(const std::string& name) const {
    return name == "pi" || (of_time_ && name == "t") ||
           std::any_of(parameters_.begin(), parameters_.end(), [&](const auto& one) { return one.first == name; }) ||
           std::find(others_.begin(), others_.end(), name) != others_.end();
  }

  [[noreturn]] void refuse_nesting() const {
    faults_.fail("more than " + std::to_string(FormulaTree::deepest) + " levels of brackets or unfinished operations",
                 at_);
  }
  /// Of what stands next, where it cannot.
  [[noreturn]] void refuse_next() {
    if (is_at_end()) faults_.fail("unexpected end of expression", at_);
    const char c = text_[at_];
    const std::string quoted = std::string("\"") + c + "\"";
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') {
      const std::size_t end = text_.find_first_not_of("0123456789.", at_);
      faults_.unexpected("value \"" + text_.substr(at_, std::min(end, text_.size()) - at_) + "\"", at_);
    }
    if (is_of_name(c)) {
      const std::string name = name_here();
      if (is_known(name)) faults_.unexpected((name == "t" && of_time_ ? "variable \"" : "value \"") + name + "\"", at_);
      if (numerics::is_function(name)) faults_.unexpected("function \"" + name + "\"", at_);
      faults_.unknown_name(name, at_);
    }
    const char next = at_ + 1 < text_.size() ? text_[at_ + 1] : '\0';
    if (c == '=' && (next == '<' || next == '>')) faults_.unexpected(std::string("operator \"") + next + "\"", at_ + 1);
    if (c == '=' && next != '=') faults_.assignment(at_);
    if (std::string_view("+-*/^<>=").find(c) != std::string_view::npos) faults_.unexpected("operator " + quoted, at_);
    if (c == '(' || c == ')') faults_.unexpected("parenthesis " + quoted, at_);
    if (c == ',') faults_.unexpected("comma", at_);
    if (c == '?' || c == ':') faults_.unexpected(quoted, at_);
    faults_.unexpected_symbol(at_);
  }

  // The grammar. Each returns the node of what it has read.
  int choice() {
    const Nesting nesting(*this);
    // A chain of choices, a ? b : c ? d : e, is read in turn and put together from its end.
    struct Link {
      int condition, yes, leap;
    };
    std::vector<Link> links;
    int last = either();
    while (takes("?")) {
      const int condition = last;
      const int otherwise = instruct({Kind::otherwise, 0, 0.0, nullptr}, -1);
      const int yes = choice();
      require(":", "\":\" of a choice \"a ? b : c\"");
      const int leap = instruct({Kind::leap, 0, 0.0, nullptr}, -1);
      instruction_at(otherwise).target = place();
      links.push_back({condition, yes, leap});
      last = either();
    }
    for (auto link = links.rbegin(); link != links.rend(); ++link) {
      instruction_at(link->leap).target = place();
      FormulaTree::Node node;
      node.kind = Kind::choice;
      node.first = link->condition;
      node.second = link->yes;
      node.third = last;
      node.begin = node_at(link->condition).begin;
      last = add_node(node);
    }
    return last;
  }
  int either() {
    int node = both();
    while (takes("||")) node = add(Kind::either, node, both());
    return node;
  }
  int both() {
    int node = comparison();
    while (takes("&&")) node = add(Kind::both, node, comparison());
    return node;
  }
  int comparison() {
    static constexpr std::array<std::pair<std::string_view, Kind>, 6> kinds{{{"<=", Kind::less_or_equal},
                                                                             {">=", Kind::greater_or_equal},
                                                                             {"==", Kind::equal},
                                                                             {"!=", Kind::unequal},
                                                                             {"<", Kind::less},
                                                                             {">", Kind::greater}}};
    int node = sum();
    for (;;) {
      const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& one) { return takes(one.first); });
      if (kind == kinds.end()) return node;
      node = add(kind->second, node, sum());
    }
  }
  int sum() {
    int node = term();
    for (;;) {
      const bool is_plus = takes("+");
      if (!is_plus && !takes("-")) return node;
      node = add(is_plus ? Kind::sum : Kind::difference, node, term());
    }
  }
  int term() {
    int node = with_sign();
    for (;;) {
      const bool is_times = takes("*");
      if (!is_times && !takes("/")) return node;
      node = add(is_times ? Kind::product : Kind::quotient, node, with_sign());
    }
  }
  int with_sign() {
    int signs = 0;
    for (bool is_minus = false; (is_minus = takes("-")) || takes("+");) signs += is_minus ? 1 : 0;
    int node = primary();
    if (takes("^")) {
      const Nesting nesting(*this);
      node = add(Kind::power, node, with_sign());
    }
    for (; signs > 0; --signs) node = add(Kind::negative, node);
    return node;
  }
  int primary() {
    if (is_at_end())
      faults_.fail(text_.find_first_not_of(" \t\r\n") == std::string::npos ? "nothing to compute"
                                                                           : "unexpected end of expression",
                   at_);
    if (takes("(")) {
      const int node = choice();
      require(")", "parenthesis");
      return node;
    }
    const char c = text_[at_];
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') return number();
    if (!is_of_name(c)) refuse_next();
    const std::size_t start = at_;
    const std::string name = name_here();
    at_ += name.size();
    if (numerics::is_function(name)) return call(name, start);
    const auto parameter =
        std::find_if(parameters_.begin(), parameters_.end(), [&](const auto& one) { return one.first == name; });
    const auto other = std::find(others_.begin(), others_.end(), name);
    if (name == "pi") return add_leaf(Kind::constant, std::numbers::pi);
    if (name == "t" && of_time_) return add_leaf(Kind::time);
    if (parameter != parameters_.end()) return add_leaf(Kind::constant, parameter->second);
    if (other != others_.end()) return add_leaf(Kind::other, 0.0, static_cast<int>(other - others_.begin()));
    faults_.unknown_name(name, start);
  }
  int number() {
    double value = 0.0;
    const char* const begin = text_.c_str() + at_;
    const auto [end, fault] = std::from_chars(begin, text_.c_str() + text_.size(), value);
    if (fault == std::errc::invalid_argument) refuse_next();
    const std::string digits(begin, end);
    if (fault == std::errc::result_out_of_range) {
      value = std::strtod(digits.c_str(), nullptr);  // beyond the largest, or below the smallest
      if (!std::isfinite(value)) faults_.unknown_name(digits, at_);
    }
    at_ += digits.size();
    return add_leaf(Kind::constant, value);
  }

  /// Functions that are nodes of their own.
  static const FormulaFunction* function_of(const std::string& name) {
    const auto& functions = formula_functions();
    const auto found =
        std::find_if(functions.begin(), functions.end(), [&](const auto& one) { return name == one.name; });
    return found == functions.end() ? nullptr : &*found;
  }
  int call(const std::string& name, std::size_t start) {
    if (!takes("(")) faults_.unknown_name(name, start);
    int arguments = 0, node = -1, before = -1;
    const bool is_mean = name == "avg";
    const Kind fold = name == "min" ? Kind::least : name == "max" ? Kind::greatest : Kind::sum;
    const bool is_fold = is_mean || name == "min" || name == "max" || name == "sum";
    do {
      before = node;
      node = choice();
      ++arguments;
      if (is_fold && before >= 0) node = add(fold, before, node);
    } while (takes(","));
    require(")", "parenthesis");
    if (is_fold && !is_mean) return node;
    if (is_mean) {
      const int count = add_leaf(Kind::constant, arguments);
      return add(Kind::quotient, node, count);
    }
    const int takes_so_many = name == "atan2" ? 2 : 1;
    if (arguments != takes_so_many)
      faults_.fail("the function \"" + name + "\" takes " + (takes_so_many == 2 ? "two arguments" : "one argument") +
                       " and is given " + std::to_string(arguments),
                   start);
    if (name == "atan2") return add(Kind::angle, before, node);
    if (name == "abs") return add(Kind::magnitude, node);
    if (name == "sign") return add(Kind::direction, node);
    if (name == "rint") return add(Kind::rounded, node);
    return add(Kind::function, node, -1, function_of(name));
  }

  const std::string& text_;
  const Parameters& parameters_;
  bool of_time_;
  const std::vector<std::string>& others_;
  FormulaFaults faults_;
  FormulaTree tree_;
  std::size_t at_ = 0;
  int nesting_ = 0, stack_ = 0;
};

}  // namespace

FormulaTree parse_formula(const std::string& text, const Parameters& parameters, bool of_time,
                          const std::vector<std::string>& others) {
  return Parser(text, parameters, of_time, others).parse();
}

}  // namespace rubato::numerics
