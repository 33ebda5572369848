#include <rubato/core/error.hpp>
#include <rubato/report/results_tables.hpp>

#include <algorithm>
#include <limits>
#include <sstream>

#include <fmt/format.h>
#include <netcdf.h>

namespace rubato::report {
namespace {

void check(int status, const std::string& what) {
  if (status != NC_NOERR) throw InvalidInput(fmt::format("cannot read {}: {}", what, nc_strerror(status)));
}

/// An attribute as text, whatever its type: numbers are joined by blanks.
std::string attribute_text(int group, int variable, const char* name) {
  nc_type type = NC_NAT;
  std::size_t length = 0;
  check(nc_inq_att(group, variable, name, &type, &length), name);
  if (type == NC_CHAR) {
    std::string text(length, '\0');
    check(nc_get_att_text(group, variable, name, text.data()), name);
    return text.substr(0, text.find('\0'));
  }
  std::string text;
  if (type == NC_STRING) {
    std::vector<char*> strings(length, nullptr);
    check(nc_get_att_string(group, variable, name, strings.data()), name);
    for (const char* string : strings) text += (text.empty() ? "" : " ") + std::string(string == nullptr ? "" : string);
    nc_free_string(length, strings.data());
    return text;
  }
  std::vector<double> values(length);
  check(nc_get_att_double(group, variable, name, values.data()), name);
  for (const double value : values) text += (text.empty() ? "" : " ") + fmt::format("{:.12g}", value);
  return text;
}

std::string attribute_or_empty(int group, int variable, const char* name) {
  return nc_inq_attid(group, variable, name, nullptr) == NC_NOERR ? attribute_text(group, variable, name) : "";
}

Attributes attributes_of(int group) {
  int count = 0;
  check(nc_inq_natts(group, &count), "attributes");
  Attributes out;
  for (int i = 0; i < count; ++i) {
    char name[NC_MAX_NAME + 1] = {};
    check(nc_inq_attname(group, NC_GLOBAL, i, name), "attributes");
    out.emplace_back(name, attribute_text(group, NC_GLOBAL, name));
  }
  return out;
}

/// The strings of the variable that is named like a dimension, in this group or above it; numbers where there is none.
std::vector<std::string> labels_of(int group, const std::string& dimension, std::size_t length) {
  std::vector<std::string> labels(length);
  for (std::size_t i = 0; i < length; ++i) labels[i] = std::to_string(i + 1);
  for (int at = group;;) {
    int variable = -1;
    nc_type type = NC_NAT;
    if (nc_inq_varid(at, dimension.c_str(), &variable) == NC_NOERR && nc_inq_vartype(at, variable, &type) == NC_NOERR &&
        type == NC_STRING) {
      std::vector<char*> strings(length, nullptr);
      check(nc_get_var_string(at, variable, strings.data()), dimension);
      for (std::size_t i = 0; i < length; ++i) labels[i] = strings[i] == nullptr ? "" : strings[i];
      nc_free_string(length, strings.data());
      return labels;
    }
    if (nc_inq_grp_parent(at, &at) != NC_NOERR) return labels;
  }
}

class GroupTable : public TableSource {
 public:
  GroupTable(int group, std::string name) : group_(group), name_(std::move(name)), attributes_(attributes_of(group)) {
    int count = 0;
    check(nc_inq_nvars(group_, &count), "variables");
    for (int id = 0; id < count; ++id) add_variable(id);
    // The coordinate of the rows is named like their dimension; it goes first.
    const auto coordinate = std::find_if(variables_.begin(), variables_.end(),
                                         [&](const Variable& variable) { return variable.name == row_dimension_; });
    if (coordinate != variables_.end()) {
      const auto index = coordinate - variables_.begin();
      std::rotate(variables_.begin(), coordinate, coordinate + 1);
      std::rotate(ids_.begin(), ids_.begin() + index, ids_.begin() + index + 1);
    }
  }

  const std::string& name() const override { return name_; }
  const std::string& row_dimension() const override { return row_dimension_; }
  const Attributes& attributes() const override { return attributes_; }
  const std::vector<Variable>& variables() const override { return variables_; }
  std::size_t rows() const override { return rows_; }

  void read(std::size_t variable, std::size_t first_row, std::size_t rows, std::size_t labels,
            std::span<double> values) const override {
    const std::size_t start[] = {first_row, 0}, count[] = {rows, labels};
    check(nc_get_vara_double(group_, ids_[variable], start, count, values.data()), variables_[variable].name);
    const double missing = variables_[variable].categories.empty() ? NC_FILL_DOUBLE : NC_FILL_INT;
    for (double& value : values) {
      if (value == missing) value = std::numeric_limits<double>::quiet_NaN();
    }
  }

 private:
  static constexpr std::size_t cache_bytes = 2u << 20;

  void add_variable(int id) {
    char name[NC_MAX_NAME + 1] = {};
    nc_type type = NC_NAT;
    int dimension_count = 0;
    int dimensions[NC_MAX_VAR_DIMS] = {};
    check(nc_inq_var(group_, id, name, &type, &dimension_count, dimensions, nullptr), "variables");
    if (type == NC_STRING || type == NC_CHAR || dimension_count < 1 || dimension_count > 2) return;
    char dimension[NC_MAX_NAME + 1] = {};
    std::size_t length = 0;
    check(nc_inq_dim(group_, dimensions[0], dimension, &length), name);
    if (row_dimension_.empty()) {
      row_dimension_ = dimension;
      rows_ = length;
    } else if (row_dimension_ != dimension) {
      return;
    }
    Variable variable;
    variable.name = name;
    variable.unit = attribute_or_empty(group_, id, "units");
    variable.description = attribute_or_empty(group_, id, "long_name");
    if (dimension_count == 2) {
      check(nc_inq_dim(group_, dimensions[1], dimension, &length), name);
      variable.dimension = dimension;
      variable.labels = labels_of(group_, dimension, length);
    }
    // Rows are read in order, so a few chunks suffice; netCDF would keep 16 MB a variable. Files of other making, which
    // need not have chunks, are read without.
    nc_set_var_chunk_cache(group_, id, cache_bytes, 11, 1.0f);
    std::istringstream meanings(attribute_or_empty(group_, id, "flag_meanings"));
    for (std::string word; meanings >> word;) variable.categories.push_back(word);
    variables_.push_back(std::move(variable));
    ids_.push_back(id);
  }

  int group_;
  std::string name_, row_dimension_;
  Attributes attributes_;
  std::vector<Variable> variables_;
  std::vector<int> ids_;
  std::size_t rows_ = 0;
};

std::vector<int> subgroups(int group) {
  int count = 0;
  check(nc_inq_grps(group, &count, nullptr), "groups");
  std::vector<int> out(static_cast<std::size_t>(count));
  check(nc_inq_grps(group, &count, out.data()), "groups");
  return out;
}

std::string group_name(int group) {
  char name[NC_MAX_NAME + 1] = {};
  check(nc_inq_grpname(group, name), "groups");
  return name;
}

}  // namespace

ResultsTables::ResultsTables(const std::filesystem::path& file) {
  check(nc_open(file.c_str(), NC_NOWRITE, &file_), file.string());
  try {
    attributes_ = attributes_of(file_);
    for (const int group : subgroups(file_)) {
      AnalysisTables analysis{group_name(group), attributes_of(group), {}};
      auto main = std::make_unique<GroupTable>(group, "");
      if (!main->variables().empty()) analysis.tables.push_back(std::move(main));
      for (const int inner : subgroups(group)) {
        auto table = std::make_unique<GroupTable>(inner, group_name(inner));
        if (!table->variables().empty()) analysis.tables.push_back(std::move(table));
      }
      analyses_.push_back(std::move(analysis));
    }
  } catch (...) {
    nc_close(file_);
    throw;
  }
}

ResultsTables::~ResultsTables() { nc_close(file_); }

}  // namespace rubato::report
