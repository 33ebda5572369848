#pragma once

#include <rubato/model/laws/law.hpp>
#include <rubato/model/quantity.hpp>

#include <fmt/format.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rubato::model {

/// A key of the table of a law in the study file.
struct LawKey {
  enum class Type {
    number,  ///< or a formula of the parameters
    formula  ///< of u, rate, t and the parameters
  };
  const char* name;
  Type type = Type::number;
  const char* unit = "";              ///< of a displacement; "" where it has none
  std::optional<double> preset = {};  ///< what it is where it is left out; empty: it must be given
  const char* meaning = "";           ///< a sentence without its full stop
  std::string unless = preset ? fmt::format("{}", *preset) : "";  ///< what it is then, as text
};

/// What the user wrote of a law.
struct LawDescription {
  std::string kind;                    ///< the name of its table, "bouc_wen"
  std::string name;                    ///< for messages and results
  std::array<std::string, 2> between;  ///< the coordinates that it joins; empty where it acts on a joint
  std::array<Location, 2> between_where;
  std::string joint;  ///< on whose coordinate it acts; empty: `between` or `shares` count
  Location joint_where;
  std::vector<std::pair<std::string, Quantity>> shares;  ///< coordinates and their weights in u
  Location shares_where;
  std::vector<Quantity> values;  ///< by the keys of its kind; formulas are the expression
  Location where;
};

/// A law that studies may have: its table, with its keys, and how it is made of their values.
struct LawKind {
  const char* table;    ///< of the study file
  const char* title;    ///< for messages: "a Bouc-Wen element"
  const char* meaning;  ///< a sentence without its full stop
  std::vector<LawKey> keys;
  /// @param description  with values for all keys
  /// @param part         its name for messages: bouc_wen "foot"
  /// Throws InvalidInput, at the place of a value, where it is out of its range.
  std::function<std::shared_ptr<const Law>(const LawDescription& description, const numerics::Parameters& parameters,
                                           const std::string& part)>
      make;
  /// What is doubtful of values that make() takes; empty: nothing.
  std::function<std::string(const LawDescription& description, const numerics::Parameters& parameters)> doubt = {};
};

/// A description of a kind with what its keys are where they are left out.
LawDescription law_description(const LawKind& kind);

/// All of them, in the order of the documentation. A new law is entered here.
std::span<const LawKind> law_kinds();
/// That of a table. Throws std::logic_error where there is none.
const LawKind& law_kind(std::string_view table);

}  // namespace rubato::model
