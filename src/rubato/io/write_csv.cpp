#include <rubato/core/error.hpp>
#include <rubato/io/output_folder.hpp>
#include <rubato/io/write_csv.hpp>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string>
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

class CsvWriter final : public results::RowWriter {
 public:
  CsvWriter(std::filesystem::path path, const results::TableLayout& layout) : path_(std::move(path)) {
    order_columns(layout);
    errno = 0;
    file_ = std::fopen(path_.c_str(), "wb");
    if (!file_) throw OutputError(write_failure(path_, errno));
    buffer_ = header_ + "\n";
    header_.clear();
  }
  ~CsvWriter() override {
    if (!file_) return;
    if (!failed_) std::fwrite(buffer_.data(), 1, buffer_.size(), file_);
    std::fclose(file_);
  }

  void append(std::span<const double> row) override {
    char number[32];
    bool first = true;
    for (const Column& column : columns_) {
      if (!first) buffer_ += ',';
      first = false;
      const double value = row[column.place];
      if (!std::isfinite(value)) continue;
      if (column.words) {
        buffer_ += field((*column.words)[static_cast<std::size_t>(value)]);
        continue;
      }
      const auto end = std::to_chars(number, number + sizeof number, value).ptr;
      buffer_.append(number, end);
    }
    buffer_ += '\n';
    if (buffer_.size() > (1u << 16)) write();
  }

  void flush() override {
    write();
    errno = 0;
    if (std::fflush(file_) != 0) fail();
  }

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

  void write() {
    errno = 0;
    if (std::fwrite(buffer_.data(), 1, buffer_.size(), file_) != buffer_.size()) fail();
    buffer_.clear();
  }
  [[noreturn]] void fail() {
    failed_ = true;
    throw OutputError(write_failure(path_, errno));
  }

  std::filesystem::path path_;
  std::vector<results::Block> blocks_;
  std::vector<Column> columns_;
  std::string header_, buffer_;
  std::FILE* file_ = nullptr;
  bool failed_ = false;
};

}  // namespace

std::unique_ptr<results::RowWriter> CsvSink::open(const results::TableLayout& layout) {
  const std::string name = layout.analysis + (layout.table.empty() ? "" : "." + layout.table) + ".csv";
  return std::make_unique<CsvWriter>(folder_ / name, layout);
}

}  // namespace rubato::io
