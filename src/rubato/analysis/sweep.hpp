#pragma once

#include <rubato/analysis/study_input.hpp>
#include <rubato/core/types.hpp>

#include <span>
#include <string>
#include <vector>

namespace rubato::analysis {

/// The values of a list or of a range. Throws InvalidInput, with `what` in the message, for a range that is reversed or
/// empty, for fewer than one point, and for a logarithmic range that is not positive.
/// @param otherwise  the place where a value has none
std::vector<double> values_of(const model::ValuesDescription& description, const numerics::Parameters& parameters,
                              const std::string& what, const Location& otherwise);

/// The lines of a sweep: combinations of the values of some parameters. Grids are counted, never listed.
class Sweep {
 public:
  enum class Kind { none, grid, cases, random };

  /// Throws InvalidInput for an unknown parameter, an impossible range or distribution, a parameter named twice, and
  /// for more lines than can be counted.
  /// @param title  of the analysis, heads the messages
  Sweep(const model::SweepDescription& description, const Location& where, const StudyInput& input,
        const std::string& title);

  Kind kind() const { return kind_; }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<std::size_t>& places() const { return places_; }  ///< of the parameters among those of the study
  const std::vector<Location>& where() const { return where_; }       ///< each parameter is named
  long lines() const { return lines_; }
  /// Writes the values of a line [parameters], in the order of names().
  void values(long line, std::span<double> out) const;
  /// Whether a line is the first of those that differ in nothing but the parameters marked.
  bool is_first_but_for(long line, const std::vector<bool>& marked) const;

 private:
  void take(const model::GridSweepDescription& grid, const StudyInput& input, const std::string& title,
            const Location& where);
  void take(const model::CaseSweepDescription& cases, const StudyInput& input, const std::string& title);
  void take(const model::RandomSweepDescription& random, const StudyInput& input, const std::string& title);
  void add_parameter(const std::string& name, const Location& where, const StudyInput& input, const std::string& title);

  Kind kind_ = Kind::none;
  std::vector<std::string> names_;
  std::vector<std::size_t> places_;
  std::vector<Location> where_;
  std::vector<std::vector<double>> grid_;
  Matrix table_;  ///< of cases and samples [parameters x lines]
  long lines_ = 1;
};

}  // namespace rubato::analysis
