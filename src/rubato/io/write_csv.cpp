#include <rubato/core/error.hpp>
#include <rubato/io/flush_timer.hpp>
#include <rubato/io/output_folder.hpp>
#include <rubato/io/write_csv.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace rubato::io {
namespace {

std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string title(const results::Block& block, std::size_t label) {
  std::string text = block.dimension.empty() ? block.variable : block.labels[label] + "." + block.variable;
  if (!block.unit.empty() && block.unit != "1") text += " [" + block.unit + "]";
  return field(text);
}

}  // namespace

/// Which tables have taken their names, and which wait for it. Used by several threads.
struct CsvSink::Register {
  struct Waiting {
    std::filesystem::path path, name;
  };
  std::function<bool()> may_replace;
  std::mutex mutex;
  std::set<std::string> written;
  std::vector<Waiting> waiting;

  void take_name(const Waiting& table) {
    if (table.path != table.name && std::rename(table.path.c_str(), table.name.c_str()) != 0)
      throw OutputError(write_failure(table.name, errno));
    const std::lock_guard lock(mutex);
    written.insert(table.name.filename().string());
  }
};

class CsvSink::Writer final : public results::RowWriter {
 public:
  Writer(std::filesystem::path path, const results::TableLayout& layout, std::shared_ptr<Register> notes)
      : path_(partial_name(path)), name_(std::move(path)), register_(std::move(notes)) {
    order_columns(layout);
    errno = 0;
    file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file_ < 0) throw OutputError(write_failure(name_, errno));
    buffer_.reserve(buffer_size + (1u << 12));
    buffer_ = header_ + "\n";
    header_.clear();
  }
  ~Writer() override {
    try {
      write();
    } catch (const OutputError&) {
      // A destructor cannot say so; whoever needs to know has flushed.
    }
    ::close(file_);
    if (path_ == name_) return;
    std::error_code ignored;
    if (size_ == 0) {
      std::filesystem::remove(path_, ignored);
      return;
    }
    const std::lock_guard lock(register_->mutex);
    register_->waiting.push_back({path_, name_});
  }

  void append(std::span<const double> row) override {
    char number[32];
    bool first = true;
    for (const Column& column : columns_) {
      if (!first) buffer_ += ',';
      first = false;
      const double value = row[column.place];
      if (std::isnan(value)) continue;
      if (column.words) {
        buffer_ += field((*column.words)[static_cast<std::size_t>(value)]);
        continue;
      }
      const auto end = std::to_chars(number, number + sizeof number, value).ptr;
      buffer_.append(number, end);
    }
    buffer_ += '\n';
    if (buffer_.size() > buffer_size || timer_.is_due()) write();
  }

  void flush() override { write(); }

 private:
  struct Column {
    std::size_t place;
    const std::vector<std::string>* words;
  };

  void order_columns(const results::TableLayout& layout) {
    blocks_ = layout.blocks;
    std::size_t place = 0;
    for (std::size_t i = 0; i < blocks_.size();) {
      std::size_t end = i + 1;
      while (!blocks_[i].dimension.empty() && end < blocks_.size() && blocks_[end].dimension == blocks_[i].dimension &&
             blocks_[end].labels == blocks_[i].labels)
        ++end;
      const std::size_t width = blocks_[i].width();
      for (std::size_t label = 0; label < width; ++label)
        for (std::size_t b = i; b < end; ++b) {
          header_ += (columns_.empty() ? "" : ",") + title(blocks_[b], label);
          columns_.push_back(
              {place + (b - i) * width + label, blocks_[b].categories.empty() ? nullptr : &blocks_[b].categories});
        }
      place += width * (end - i);
      i = end;
    }
  }

  // Hands whole rows to the operating system. Where it does not take them all, the file is cut back to its last whole
  // row and takes no more.
  void write() {
    if (failed_ || buffer_.empty()) return;
    failed_ = true;
    if (!has_disk_space(path_, static_cast<double>(buffer_.size()))) throw OutputError(write_failure(name_, ENOSPC));
    std::size_t written = 0;
    while (written < buffer_.size()) {
      errno = 0;
      const ssize_t count = ::write(file_, buffer_.data() + written, buffer_.size() - written);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) {
        const int reason = errno;
        const std::size_t row_end = buffer_.rfind('\n', written == 0 ? 0 : written - 1);
        const std::size_t whole = written == 0 || row_end == std::string::npos ? 0 : row_end + 1;
        (void)!::ftruncate(file_, static_cast<off_t>(size_ + whole));  // a device has no length; nothing is lost then
        size_ += whole;
        if (whole > 0 && register_->may_replace()) publish();
        throw OutputError(write_failure(name_, reason));
      }
      written += static_cast<std::size_t>(count);
    }
    if (register_->may_replace()) publish();
    failed_ = false;
    size_ += buffer_.size();
    buffer_.clear();
  }

  void publish() {
    register_->take_name({path_, name_});
    path_ = name_;
  }

  static constexpr std::size_t buffer_size = 1u << 16;

  std::filesystem::path path_, name_;  // where it is; where it goes
  std::shared_ptr<Register> register_;
  std::vector<results::Block> blocks_;
  std::vector<Column> columns_;
  std::string header_, buffer_;
  int file_ = -1;
  std::size_t size_ = 0;
  bool failed_ = false;
  FlushTimer timer_;
};

CsvSink::CsvSink(std::filesystem::path folder, std::function<bool()> may_replace)
    : folder_(std::move(folder)), register_(std::make_shared<Register>()) {
  register_->may_replace = may_replace ? std::move(may_replace) : [] { return true; };
}

CsvSink::~CsvSink() {
  std::error_code ignored;
  for (const auto& table : register_->waiting) std::filesystem::remove(table.path, ignored);
}

void CsvSink::close() {
  if (register_->may_replace())
    for (const auto& table : std::exchange(register_->waiting, {})) register_->take_name(table);
}

std::set<std::string> CsvSink::written() const {
  const std::lock_guard lock(register_->mutex);
  return register_->written;
}

std::unique_ptr<results::RowWriter> CsvSink::open(const results::TableLayout& layout) {
  const std::string name = layout.analysis + (layout.table.empty() ? "" : "." + layout.table) + ".csv";
  return std::make_unique<Writer>(folder_ / name, layout, register_);
}

}  // namespace rubato::io
