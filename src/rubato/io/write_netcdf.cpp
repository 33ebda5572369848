#include <rubato/core/error.hpp>
#include <rubato/core/version.hpp>
#include <rubato/io/output_folder.hpp>
#include <rubato/io/write_netcdf.hpp>

#include <fmt/format.h>
#include <netcdf.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <numeric>

namespace rubato::io {

/// The open file. Once a write has failed it takes no more, and closing it is best effort.
class NetcdfSink::File {
 public:
  explicit File(std::filesystem::path path) : path_(std::move(path)) {
    errno = 0;
    check(nc_create(path_.c_str(), NC_NETCDF4 | NC_CLOBBER, &id_));
    is_open_ = true;
  }
  ~File() {
    if (is_open_) nc_close(id_);
  }

  int id() const { return id_; }
  bool has_failed() const { return has_failed_; }

  void check(int status) {
    if (status == NC_NOERR) return;
    has_failed_ = true;
    const int system_error = errno;
    // HDF5 hides the reason; the operating system's, where there is one, says more.
    std::string message = write_failure(path_, system_error);
    if (system_error == 0) message += fmt::format(" ({})", nc_strerror(status));
    throw OutputError(message);
  }

  void close() {
    if (!is_open_) return;
    is_open_ = false;
    errno = 0;
    check(nc_close(id_));
  }

  int group(int parent, const std::string& name) {
    int id = 0;
    if (nc_inq_grp_ncid(parent, name.c_str(), &id) != NC_NOERR) check(nc_def_grp(parent, name.c_str(), &id));
    return id;
  }

  void attribute(int group, int variable, const std::string& name, const std::string& text) {
    errno = 0;
    check(nc_put_att_text(group, variable, name.c_str(), text.size(), text.data()));
  }

  void sync() {
    errno = 0;
    check(nc_sync(id_));
  }

 private:
  std::filesystem::path path_;
  int id_ = 0;
  bool is_open_ = false, has_failed_ = false;
};

namespace {

using File = NetcdfSink::File;
using Clock = std::chrono::steady_clock;

class NetcdfWriter final : public results::RowWriter {
 public:
  NetcdfWriter(std::shared_ptr<File> file, const results::TableLayout& layout)
      : file_(std::move(file)), width_(layout.row_width()) {
    group_ = file_->group(file_->id(), layout.analysis);
    if (!layout.table.empty()) group_ = file_->group(group_, layout.table);
    for (const auto& [name, text] : layout.attributes) file_->attribute(group_, NC_GLOBAL, name, text);
    capacity_ = std::clamp<std::size_t>((1u << 17) / std::max<std::size_t>(width_, 1), 1, 4096);
    int rows = 0;
    file_->check(nc_def_dim(group_, layout.row_dimension.c_str(), NC_UNLIMITED, &rows));
    for (const results::Block& block : layout.blocks) define(block, rows);
    buffer_.reserve(capacity_ * width_);
    last_sync_ = Clock::now();
  }

  ~NetcdfWriter() override {
    if (file_->has_failed()) return;
    try {
      write();
    } catch (const OutputError&) {
      // The sink's close() reports what is missing: a destructor cannot.
    }
  }

  void append(std::span<const double> row) override {
    buffer_.insert(buffer_.end(), row.begin(), row.end());
    ++buffered_;
    if (buffered_ < capacity_) return;
    write();
    const auto now = Clock::now();
    if (now - last_sync_ < std::chrono::seconds(1)) return;
    last_sync_ = now;
    file_->sync();
  }

  void flush() override {
    write();
    file_->sync();
  }

 private:
  struct Variable {
    int id;
    std::size_t width, offset;
    bool has_labels, has_words;
  };

  int labelled_dimension(const results::Block& block) {
    // nc_inq_dimid would also find the dimension of a group above, whose names are others.
    int count = 0, own[NC_MAX_DIMS] = {}, dimension = 0;
    file_->check(nc_inq_dimids(group_, &count, own, 0));
    for (int i = 0; i < count; ++i) {
      char name[NC_MAX_NAME + 1] = {};
      file_->check(nc_inq_dimname(group_, own[i], name));
      if (block.dimension == name) return own[i];
    }
    file_->check(nc_def_dim(group_, block.dimension.c_str(), block.labels.size(), &dimension));
    int variable = 0;
    file_->check(nc_def_var(group_, block.dimension.c_str(), NC_STRING, 1, &dimension, &variable));
    std::vector<const char*> names;
    for (const std::string& label : block.labels) names.push_back(label.c_str());
    file_->check(nc_put_var_string(group_, variable, names.data()));
    return dimension;
  }

  void define(const results::Block& block, int rows) {
    Variable variable{0, block.width(), offset_, !block.dimension.empty(), !block.categories.empty()};
    offset_ += variable.width;
    int dimensions[2] = {rows, variable.has_labels ? labelled_dimension(block) : 0};
    const int rank = variable.has_labels ? 2 : 1;
    file_->check(nc_def_var(group_, block.variable.c_str(), variable.has_words ? NC_INT : NC_DOUBLE, rank, dimensions,
                            &variable.id));
    const std::size_t chunk_rows = std::max<std::size_t>(1, std::min<std::size_t>(capacity_, 65536 / variable.width));
    const std::size_t chunk[2] = {chunk_rows, variable.width};
    file_->check(nc_def_var_chunking(group_, variable.id, NC_CHUNKED, chunk));
    file_->attribute(group_, variable.id, "units", block.unit.empty() ? "1" : block.unit);
    file_->attribute(group_, variable.id, "long_name", block.description);
    if (variable.has_words) {
      std::vector<int> values(block.categories.size());
      std::iota(values.begin(), values.end(), 0);
      file_->check(nc_put_att_int(group_, variable.id, "flag_values", NC_INT, values.size(), values.data()));
      std::string meanings;
      for (std::string word : block.categories) {
        std::replace(word.begin(), word.end(), ' ', '_');
        meanings += (meanings.empty() ? "" : " ") + word;
      }
      file_->attribute(group_, variable.id, "flag_meanings", meanings);
    }
    variables_.push_back(variable);
  }

  void write() {
    if (buffered_ == 0) return;
    for (const Variable& variable : variables_) {
      column_.resize(buffered_ * variable.width);
      for (std::size_t row = 0; row < buffered_; ++row)
        std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(row * width_ + variable.offset), variable.width,
                    column_.begin() + static_cast<std::ptrdiff_t>(row * variable.width));
      // A value that is not there is netCDF's fill value, which readers show as missing.
      for (double& value : column_)
        if (value != value) value = variable.has_words ? static_cast<double>(NC_FILL_INT) : NC_FILL_DOUBLE;
      const std::size_t start[2] = {rows_, 0}, count[2] = {buffered_, variable.width};
      errno = 0;
      file_->check(nc_put_vara_double(group_, variable.id, start, count, column_.data()));
    }
    rows_ += buffered_;
    buffered_ = 0;
    buffer_.clear();
  }

  std::shared_ptr<File> file_;
  int group_ = 0;
  std::size_t width_, capacity_ = 1, offset_ = 0, rows_ = 0, buffered_ = 0;
  std::vector<Variable> variables_;
  std::vector<double> buffer_, column_;
  Clock::time_point last_sync_;
};

}  // namespace

NetcdfSink::NetcdfSink(const std::filesystem::path& path, const Provenance& provenance)
    : file_(std::make_shared<File>(path)) {
  const auto note = [&](const char* name, const std::string& text) {
    file_->attribute(file_->id(), NC_GLOBAL, name, text);
  };
  note("Conventions", "CF-1.8");
  note("title", provenance.title);
  note("source", std::string("rubato ") + version);
  note("version", version);
  note("history", provenance.date + " " + provenance.command);
  note("study_file", provenance.study_file);
  note("study", provenance.study_text);
  file_->sync();
}

NetcdfSink::~NetcdfSink() = default;

std::unique_ptr<results::RowWriter> NetcdfSink::open(const results::TableLayout& layout) {
  return std::make_unique<NetcdfWriter>(file_, layout);
}

void NetcdfSink::conclude(const std::string& analysis, const std::string& status, const std::string& message,
                          const std::vector<std::pair<std::string, std::string>>& attributes) {
  if (file_->has_failed()) return;
  const int group = file_->group(file_->id(), analysis);
  file_->attribute(group, NC_GLOBAL, "status", status);
  if (!message.empty()) file_->attribute(group, NC_GLOBAL, "message", message);
  for (const auto& [name, text] : attributes) file_->attribute(group, NC_GLOBAL, name, text);
  file_->sync();
}

void NetcdfSink::close() { file_->close(); }

}  // namespace rubato::io
