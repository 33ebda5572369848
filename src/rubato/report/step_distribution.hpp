#pragma once

#include <rubato/report/table_source.hpp>

#include <string>

namespace rubato::report {

/// How often the march took a step of which length, counted over all rows of a table of steps:
/// {"edges": [bins + 1], "counts": [bins]}, the edges [s] at equal ratios; "null" for any other table, and where no
/// step was accepted.
std::string step_distribution_json(const TableSource& table);

}  // namespace rubato::report
