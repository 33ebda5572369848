#pragma once

#include <concepts>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

// What a key of the study file says of itself. The files beside this one declare every key once, as functions
//
//   void fields(auto& visit, Like<SpringDescription> auto& spring) {
//     visit.between("between", spring.between, spring.between_where, {.required = true});
//     visit.quantity("stiffness", spring.stiffness, {.required = true, .unit = "N/m"});
//   }
//
// that name the keys of a table in the order in which they are read. Visitors make of it the reader
// (io/reading_visitor.hpp), the JSON schema (io/schema_visitor.hpp) and the list of quantities of a description
// (quantity_visitor.hpp). docs/developers/how-to-add-a-key.md says what a visitor can be asked.
namespace rubato::model {

/// What a steady response has a quantity for: the matrices, the start, the stiffness of sliders, and where loads act
/// (directions, gravity); amplitude and phase of a load; its frequency; the limits of sliders; or nothing (what acts in
/// static states only).
enum class Role { structure, load, frequency, limit, none };

/// Which values a quantity may have. The builder of the model refuses others, with the place and the value.
enum class Range { any, positive, not_negative };

struct Key {
  bool required = false;
  const char* unit = "";    ///< "N/m"; "" where there is none to tell
  const char* says = "";    ///< what it is, in a few words
  const char* unless = "";  ///< what holds where it is left out
  Range range = Range::any;
  Role role = Role::structure;
};

/// A word of the file and what it stands for.
template <class Value>
struct Choice {
  const char* word;
  Value value;
};

/// How many entries a list has.
struct Size {
  int least = 1;
  int most = std::numeric_limits<int>::max();
};

/// Of a whole number, both ends included.
struct Bounds {
  long least = std::numeric_limits<long>::min();
  long most = std::numeric_limits<long>::max();
  const char* said = "";  ///< for the message: "from 1 to 10 million"
};

/// A description that is read, or one that is only looked at.
template <class T, class Description>
concept Like = std::same_as<std::remove_const_t<T>, Description>;

/// What the columns of a CSV file are, whose path the key `table` gives.
struct TableUse {
  std::vector<std::string> units;  ///< that the values may have
  std::string over = "time";       ///< what the first column is
  std::string over_unit = "s";     ///< its unit
  bool may_be_zero_beyond = true;  ///< whether `beyond = "zero"` makes sense
  const char* says = "a CSV file of time [s] and value, interpolated linearly; relative to the study";
};

}  // namespace rubato::model
