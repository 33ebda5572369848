#include <rubato/results/memory_sink.hpp>

#include <algorithm>

namespace rubato::results {
namespace {

class MemoryWriter final : public RowWriter {
 public:
  explicit MemoryWriter(std::shared_ptr<MemoryTable> table) : table_(std::move(table)) {}

  // A row counts once all of its values are kept: memory may run out in its midst.
  void append(std::span<const double> row) override {
    for (std::size_t i = 0; i < table_->values.size(); ++i) {
      const std::size_t width = table_->layout.blocks[i].width();
      auto& values = table_->values[i];
      values.insert(values.end(), row.begin(), row.begin() + static_cast<std::ptrdiff_t>(width));
      row = row.subspan(width);
    }
    ++table_->rows;
  }
  void flush() override {}

 private:
  std::shared_ptr<MemoryTable> table_;
};

}  // namespace

MemorySink::MemorySink(const std::vector<std::string>& analyses) {
  for (const std::string& name : analyses) analysis(name);
}

MemoryAnalysis& MemorySink::analysis(const std::string& name) {
  const auto found =
      std::find_if(analyses_.begin(), analyses_.end(), [&](const auto& one) { return one.name == name; });
  if (found != analyses_.end()) return *found;
  analyses_.emplace_back().name = name;
  return analyses_.back();
}

std::unique_ptr<RowWriter> MemorySink::open(const TableLayout& layout) {
  auto table = std::make_shared<MemoryTable>();
  table->layout = layout;
  table->values.resize(layout.blocks.size());
  const std::lock_guard lock(mutex_);
  analysis(layout.analysis).tables.push_back(table);
  return std::make_unique<MemoryWriter>(table);
}

void MemorySink::conclude(const std::string& name, const std::string& status, const std::string& message,
                          const std::vector<std::pair<std::string, std::string>>& attributes) {
  const std::lock_guard lock(mutex_);
  MemoryAnalysis& concluded = analysis(name);
  concluded.status = status;
  if (!message.empty()) concluded.message = message;
  for (const auto& [key, text] : attributes) {
    const auto is_same = [&key = key](const auto& one) { return one.first == key; };
    const auto found = std::find_if(concluded.attributes.begin(), concluded.attributes.end(), is_same);
    if (found == concluded.attributes.end())
      concluded.attributes.emplace_back(key, text);
    else
      found->second = text;
  }
}

void write(std::span<const MemoryAnalysis> analyses, Sink& sink) {
  std::vector<double> row;
  for (const MemoryAnalysis& analysis : analyses) {
    for (const auto& table : analysis.tables) {
      const auto writer = sink.open(table->layout);
      for (std::size_t i = 0; i < table->rows; ++i) {
        row.clear();
        for (std::size_t block = 0; block < table->values.size(); ++block) {
          const std::size_t width = table->layout.blocks[block].width();
          const auto begin = table->values[block].begin() + static_cast<std::ptrdiff_t>(i * width);
          row.insert(row.end(), begin, begin + static_cast<std::ptrdiff_t>(width));
        }
        writer->append(row);
      }
      writer->flush();
    }
    sink.conclude(analysis.name, analysis.status, analysis.message, analysis.attributes);
  }
}

}  // namespace rubato::results
