#include <rubato/core/error.hpp>
#include <rubato/core/version.hpp>
#include <rubato/io/flush_timer.hpp>
#include <rubato/io/netcdf_file.hpp>
#include <rubato/io/write_netcdf.hpp>
#include <rubato/results/variable_names.hpp>

#include <netcdf.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <numeric>

namespace rubato::io {
namespace {

using Lock = std::lock_guard<std::mutex>;

class NetcdfWriter final : public results::RowWriter {
 public:
  NetcdfWriter(std::shared_ptr<NetcdfFile> file, const results::TableLayout& layout)
      : file_(std::move(file)), width_(layout.row_width()) {
    const Lock lock(file_->mutex());
    group_ = file_->group(file_->id(), layout.analysis);
    if (!layout.table.empty()) group_ = file_->group(group_, layout.table);
    for (const auto& [name, text] : layout.attributes) file_->attribute(group_, NC_GLOBAL, name, text);
    capacity_ = std::clamp<std::size_t>(values_a_batch / std::max<std::size_t>(width_, 1), 1, most_rows_a_batch);
    int rows = 0;
    file_->check(nc_def_dim(group_, layout.row_dimension.c_str(), NC_UNLIMITED, &rows));
    const std::vector<std::string> names = results::variable_names(layout);
    for (std::size_t i = 0; i < names.size(); ++i) define(layout.blocks[i], names[i], rows);
    buffer_.reserve(capacity_ * width_);
  }

  ~NetcdfWriter() override {
    try {
      write();
    } catch (const OutputError&) {
      // A destructor cannot say so; whoever needs to know has flushed.
    }
  }

  void append(std::span<const double> row) override {
    buffer_.insert(buffer_.end(), row.begin(), row.end());
    ++buffered_;
    // The first rows go to the disk at once: former results make room for these then.
    if (timer_.is_due() || (buffered_ == capacity_ && !file_->is_published()))
      flush();
    else if (buffered_ == capacity_)
      write();
  }

  void flush() override {
    write();
    if (is_refused_) return;
    const Lock lock(file_->mutex());
    file_->sync();
    file_->publish();
  }

 private:
  static constexpr std::size_t values_a_batch = 1u << 17, most_rows_a_batch = 1024, values_a_chunk = 1u << 16;

  struct Variable {
    int id;
    std::size_t width, offset, chunk_rows;
    bool has_labels, has_words;

    double chunk_bytes() const {
      return static_cast<double>(chunk_rows * width * (has_words ? sizeof(int) : sizeof(double)));
    }
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
    double bytes = 0.0;
    for (const std::string& label : block.labels) {
      names.push_back(label.c_str());
      bytes += 48.0 + static_cast<double>(label.size());  // with its reference and its place in the heap
    }
    file_->make_room(bytes);
    file_->check(nc_put_var_string(group_, variable, names.data()));
    return dimension;
  }

  void define(const results::Block& block, const std::string& name, int rows) {
    const std::size_t width = block.width();
    if (width == 0) return;  // netCDF knows no dimension without length
    const std::size_t chunk_rows = std::clamp<std::size_t>(values_a_chunk / width, 1, capacity_);
    Variable variable{0, width, offset_, chunk_rows, !block.dimension.empty(), !block.categories.empty()};
    offset_ += width;
    int dimensions[2] = {rows, variable.has_labels ? labelled_dimension(block) : 0};
    const int rank = variable.has_labels ? 2 : 1;
    file_->check(
        nc_def_var(group_, name.c_str(), variable.has_words ? NC_INT : NC_DOUBLE, rank, dimensions, &variable.id));
    const std::size_t chunk[2] = {chunk_rows, width};
    file_->check(nc_def_var_chunking(group_, variable.id, NC_CHUNKED, chunk));
    // Rows are only ever appended, so two chunks suffice; netCDF would keep 16 MB a variable. Written chunks go first.
    const auto cache_bytes = static_cast<std::size_t>(2.0 * variable.chunk_bytes());
    file_->check(nc_set_var_chunk_cache(group_, variable.id, cache_bytes, 11, 1.0f));
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

  // What the chunks that the buffered rows begin take in the file, which grows by whole chunks.
  double growth() const {
    double bytes = 0.0;
    for (const Variable& variable : variables_) {
      const auto chunks = [&](std::size_t rows) { return (rows + variable.chunk_rows - 1) / variable.chunk_rows; };
      bytes += static_cast<double>(chunks(rows_ + buffered_) - chunks(rows_)) * variable.chunk_bytes();
    }
    return bytes;
  }

  void write() {
    if (buffered_ == 0 || is_refused_) return;
    const Lock lock(file_->mutex());
    is_refused_ = true;
    file_->make_room(growth());
    for (const Variable& variable : variables_) {
      column_.resize(buffered_ * variable.width);
      for (std::size_t row = 0; row < buffered_; ++row)
        std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(row * width_ + variable.offset), variable.width,
                    column_.begin() + static_cast<std::ptrdiff_t>(row * variable.width));
      // A value that is not there is netCDF's fill value, which readers show as missing.
      for (double& value : column_)
        if (std::isnan(value)) value = variable.has_words ? static_cast<double>(NC_FILL_INT) : NC_FILL_DOUBLE;
      const std::size_t start[2] = {rows_, 0}, count[2] = {buffered_, variable.width};
      errno = 0;
      file_->check(nc_put_vara_double(group_, variable.id, start, count, column_.data()));
    }
    is_refused_ = false;
    file_->note_worth();
    rows_ += buffered_;
    buffered_ = 0;
    buffer_.clear();
  }

  std::shared_ptr<NetcdfFile> file_;
  int group_ = 0;
  std::size_t width_, capacity_ = 1, offset_ = 0, rows_ = 0, buffered_ = 0;
  std::vector<Variable> variables_;
  std::vector<double> buffer_, column_;
  FlushTimer timer_;
  bool is_refused_ = false;  ///< a write was refused or has failed: the rows after it are not wanted
};

}  // namespace

NetcdfSink::NetcdfSink(const std::filesystem::path& path, const Provenance& provenance)
    : file_(std::make_shared<NetcdfFile>(path)) {
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

void NetcdfSink::expect(const std::string& analysis) {
  const Lock lock(file_->mutex());
  file_->attribute(file_->group(file_->id(), analysis), NC_GLOBAL, "status", "unfinished");
}

std::unique_ptr<results::RowWriter> NetcdfSink::open(const results::TableLayout& layout) {
  return std::make_unique<NetcdfWriter>(file_, layout);
}

void NetcdfSink::conclude(const std::string& analysis, const std::string& status, const std::string& message,
                          const std::vector<std::pair<std::string, std::string>>& attributes) {
  const Lock lock(file_->mutex());
  if (file_->has_failed()) return;
  const int group = file_->group(file_->id(), analysis);
  file_->attribute(group, NC_GLOBAL, "status", status);
  if (!message.empty()) file_->attribute(group, NC_GLOBAL, "message", message);
  for (const auto& [name, text] : attributes) file_->attribute(group, NC_GLOBAL, name, text);
  file_->sync();
  if (status == "done") file_->note_worth();
  file_->publish();
}

bool NetcdfSink::is_published() const { return file_->is_published(); }

bool NetcdfSink::is_there() const { return file_->is_there(); }

bool NetcdfSink::has_failed() const { return file_->has_failed(); }

void NetcdfSink::close() { file_->close(); }

}  // namespace rubato::io
