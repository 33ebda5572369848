#include <rubato/core/error.hpp>
#include <rubato/io/folder_lock.hpp>
#include <rubato/io/result_table.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

namespace rubato::io {
namespace {

namespace fs = std::filesystem;

// The fields of a line; commas and doubled quotes may stand within quotes.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && is_quoted && i + 1 < line.size() && line[i + 1] == '"')
      fields.back() += line[++i];
    else if (c == '"')
      is_quoted = !is_quoted;
    else if (c == ',' && !is_quoted)
      fields.emplace_back();
    else if (c != '\r')
      fields.back() += c;
  }
  return fields;
}

std::optional<double> number_of(const std::string& field) {
  if (field.empty()) return std::numeric_limits<double>::quiet_NaN();
  double value = 0.0;
  const auto [end, fault] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (fault != std::errc() || end != field.data() + field.size()) return std::nullopt;
  return value;
}

}  // namespace

const ResultColumn* ResultTable::find(const std::string& name) const {
  const auto found = std::find_if(columns.begin(), columns.end(), [&](const auto& one) { return one.name == name; });
  return found == columns.end() ? nullptr : &*found;
}

ResultTable read_result_table(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) throw InvalidInput(fmt::format("{}: cannot be read: {}", file.string(), std::strerror(errno)));
  ResultTable table;
  std::string line;
  if (!std::getline(stream, line)) throw InvalidInput(fmt::format("{}: the file is empty", file.string()));
  for (std::string& name : fields_of(line)) table.columns.push_back({std::move(name), {}, {}});
  for (int number = 2; std::getline(stream, line); ++number) {
    std::vector<std::string> fields = fields_of(line);
    if (fields.size() != table.columns.size())
      throw InvalidInput(Location{file.string(), number, 0},
                         fmt::format("the row has {} fields, the header {}", fields.size(), table.columns.size()));
    for (std::size_t i = 0; i < fields.size(); ++i) table.columns[i].words.push_back(std::move(fields[i]));
    ++table.rows;
  }
  for (ResultColumn& column : table.columns) {
    std::vector<double> numbers;
    for (const std::string& word : column.words) {
      const auto value = number_of(word);
      if (!value) break;
      numbers.push_back(*value);
    }
    if (numbers.size() != table.rows) continue;
    column.numbers = std::move(numbers);
    column.words.clear();
  }
  return table;
}

std::vector<fs::path> result_tables(const fs::path& folder) {
  std::error_code fault;
  if (!fs::is_directory(folder, fault))
    throw InvalidInput(
        fmt::format("{}: there is no such folder of results{}", folder.string(),
                    fs::is_regular_file(folder, fault) ? "; name the folder that the file lies in" : ""));
  const auto refuse_to_read_beside_a_run = [](const fs::path& place) {
    if (const std::string writer = writer_of(place); !writer.empty())
      throw InvalidInput(fmt::format("{}: {}; its tables are not whole yet", place.string(), writer));
  };
  refuse_to_read_beside_a_run(folder);
  std::vector<fs::path> found;
  for (auto entry = fs::recursive_directory_iterator(folder, fault); entry != fs::recursive_directory_iterator();
       entry.increment(fault)) {
    if (fault) break;
    if (entry->is_directory() && entry->path().filename() == "former")
      entry.disable_recursion_pending();
    else if (entry->is_directory())
      refuse_to_read_beside_a_run(entry->path());
    if (!entry->is_regular_file()) continue;
    const fs::path file = entry->path().lexically_relative(folder);
    const bool is_partial = file.extension() == ".partial" && file.stem().extension() == ".csv";
    if (file.extension() == ".csv" || is_partial) found.push_back(file);
  }
  if (fault) throw InvalidInput(fmt::format("{}: cannot be read: {}", folder.string(), fault.message()));
  if (found.empty())
    throw InvalidInput(fmt::format("{}: the folder has no tables of results (*.csv)", folder.string()));
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace rubato::io
