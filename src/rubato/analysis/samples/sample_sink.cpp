#include <rubato/analysis/samples/sample_sink.hpp>

#include <memory>

namespace rubato::analysis {
namespace {

class Writer final : public results::RowWriter {
 public:
  explicit Writer(KeptTable& table) : table_(table) {}

  void append(std::span<const double> row) override {
    switch (table_.kept) {
      case Kept::nothing:
        break;
      case Kept::last_row:
        table_.rows.assign(row.begin(), row.end());
        break;
      case Kept::extremes_and_rows:
      case Kept::extremes:
        table_.extremes.take(row);
        if (table_.kept == Kept::extremes) break;
        [[fallthrough]];
      case Kept::rows:
        table_.rows.insert(table_.rows.end(), row.begin(), row.end());
        break;
    }
  }
  void flush() override {}

 private:
  KeptTable& table_;
};

}  // namespace

std::unique_ptr<results::RowWriter> SampleSink::open(const results::TableLayout& layout) {
  KeptTable& table = tables_[layout.table];
  const auto wanted = kept_.find(layout.table);
  table.kept = wanted == kept_.end() ? Kept::nothing : wanted->second;
  table.layout = layout;
  return std::make_unique<Writer>(table);
}

const KeptTable* SampleSink::find(const std::string& table) const {
  const auto found = tables_.find(table);
  return found == tables_.end() || found->second.kept == Kept::nothing ? nullptr : &found->second;
}

}  // namespace rubato::analysis
