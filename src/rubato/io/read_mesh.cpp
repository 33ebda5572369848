#include <rubato/io/csv_rows.hpp>
#include <rubato/io/read_parts.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rubato::io {
namespace {

using namespace model;
using Fields = std::vector<std::string_view>;

constexpr std::uintmax_t largest_mesh = 2048u << 20;

/// Where the columns of a file stand, by the names in its first row.
class Columns {
 public:
  /// @param known     names that a column may have
  /// @param required  the first so many must be there
  Columns(std::vector<std::string> known, std::size_t required)
      : known_(std::move(known)), place_(known_.size(), missing), required_(required) {}

  bool is_known() const { return count_ > 0; }

  void take(const Fields& fields, const Location& here) {
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto found = std::find(known_.begin(), known_.end(), fields[i]);
      if (found == known_.end())
        throw InvalidInput(here, fmt::format("the first row names the columns, and \"{}\" is none of them{}",
                                             fields[i].substr(0, 60), suggestion(std::string(fields[i]), known_)));
      std::size_t& place = place_[static_cast<std::size_t>(found - known_.begin())];
      if (place != missing) throw InvalidInput(here, fmt::format("two columns are called \"{}\"", fields[i]));
      place = i;
    }
    for (std::size_t i = 0; i < required_; ++i)
      if (place_[i] == missing) throw InvalidInput(here, fmt::format("the column \"{}\" is missing", known_[i]));
    count_ = fields.size();
  }

  void require_all(const Fields& fields, const Location& here) const {
    if (fields.size() != count_)
      throw InvalidInput(here, fmt::format("{} fields for {} columns", fields.size(), count_));
  }

  bool has(std::size_t column) const { return place_[column] != missing; }
  std::string_view of(const Fields& fields, std::size_t column) const { return fields[place_[column]]; }
  std::string text_of(const Fields& fields, std::size_t column, const Location& here) const {
    const std::string_view field = of(fields, column);
    if (field.empty()) throw InvalidInput(here, fmt::format("the field \"{}\" is empty", known_[column]));
    return std::string(field);
  }

 private:
  static constexpr std::size_t missing = static_cast<std::size_t>(-1);
  std::vector<std::string> known_;
  std::vector<std::size_t> place_;
  std::size_t required_, count_ = 0;
};

/// Calls with each row of the file that a table names.
template <class Take>
void for_each_row(const std::string& file, const Location& where, const StudyFolder& folder, Columns& columns,
                  Take&& take) {
  const std::string text = folder.read(file, where, largest_mesh, "the mesh");
  const std::string place = folder.place_of(file);
  refuse_binary(text, place, "a mesh is a text: a header with the names of the columns, and rows");
  std::size_t rows = 0;
  for_each_csv_row(text, place, [&](const Fields& fields, const Location& here) {
    if (!columns.is_known()) return columns.take(fields, here);
    columns.require_all(fields, here);
    take(fields, here);
    ++rows;
  });
  if (rows == 0) throw InvalidInput({place, 0, 0}, "the file has no rows; it needs a header and a row each");
}

}  // namespace

void read_mesh(const NodeFileDescription& file, const StudyFolder& folder, StructureDescription& structure) {
  const std::vector<std::string> names{"name", "x", "y", "z"};
  Columns columns(names, 3);
  for_each_row(file.file, file.file_where, folder, columns, [&](const Fields& fields, const Location& here) {
    NodeDescription node;
    node.name = columns.text_of(fields, 0, here);
    for (std::size_t i = 1; i < names.size(); ++i)
      if (columns.has(i)) node.position.emplace_back(csv_number(columns.of(fields, i), names[i], here));
    node.where = here;
    structure.nodes.push_back(std::move(node));
  });
}

void read_mesh(const BeamFileDescription& file, const StudyFolder& folder, StructureDescription& structure) {
  Columns columns({"first", "second", "name", "section", "material"}, 2);
  const auto choose = [&](std::size_t column, const std::string& key, const Fields& fields, const Location& here,
                          std::string& value, Location& where) {
    if (columns.has(column) && !columns.of(fields, column).empty()) {
      value = std::string(columns.of(fields, column));
      where = here;
    }
    if (value.empty())
      throw InvalidInput(here,
                         fmt::format("the beam has no {0}; give [beams] \"{0}\", or the file a column \"{0}\"", key));
  };
  for_each_row(file.file, file.file_where, folder, columns, [&](const Fields& fields, const Location& here) {
    BeamDescription beam = file.common;
    beam.where = here;
    for (std::size_t i = 0; i < 2; ++i) {
      beam.nodes[i] = columns.text_of(fields, i, here);
      beam.nodes_where[i] = here;
    }
    if (columns.has(2)) beam.name = std::string(columns.of(fields, 2));
    choose(3, "section", fields, here, beam.section, beam.section_where);
    choose(4, "material", fields, here, beam.material, beam.material_where);
    structure.beams.push_back(std::move(beam));
  });
}

}  // namespace rubato::io
