#include <rubato/io/csv_rows.hpp>
#include <rubato/io/read_parts.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

namespace rubato::io {
namespace {

constexpr std::uintmax_t largest_list = 512u << 20;

void take_header(const std::vector<std::string_view>& fields, const Location& here,
                 model::CaseSweepDescription& cases) {
  for (const std::string_view field : fields) {
    double number = 0.0;
    const bool is_number =
        std::from_chars(field.data(), field.data() + field.size(), number).ptr == field.data() + field.size();
    if (field.empty() || is_number)
      throw InvalidInput(here, fmt::format("the first row must name the parameters of the columns, got \"{}\"", field));
    const std::string name(field);
    if (std::find(cases.names.begin(), cases.names.end(), name) != cases.names.end())
      throw InvalidInput(here, fmt::format("two columns are called \"{}\"", name));
    cases.names.push_back(name);
  }
}

}  // namespace

model::CaseSweepDescription read_cases(const std::string& file, const StudyFolder& folder, const Location& where) {
  const std::string text = folder.read(file, where, largest_list, "the list of cases");
  const std::string place = folder.place_of(file);
  refuse_binary(text, place, "a list of cases is a text: a header with names of parameters, and rows of numbers");
  model::CaseSweepDescription cases;
  cases.file = file;
  cases.where = where;
  for_each_csv_row(text, place, [&](const std::vector<std::string_view>& fields, const Location& here) {
    if (cases.names.empty()) return take_header(fields, here, cases);
    if (fields.size() != cases.names.size())
      throw InvalidInput(here, fmt::format("{} numbers for {} parameters; each row gives all of them", fields.size(),
                                           cases.names.size()));
    for (std::size_t i = 0; i < fields.size(); ++i) cases.values.push_back(csv_number(fields[i], cases.names[i], here));
  });
  if (cases.values.empty())
    throw InvalidInput({place, 0, 0}, "the list of cases has no rows; it needs a header and a row a case");
  return cases;
}

}  // namespace rubato::io
