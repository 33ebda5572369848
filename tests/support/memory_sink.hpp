#pragma once

#include <rubato/analysis/run_context.hpp>

#include <algorithm>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace rubato::testing {

/// Keeps the rows of every table, by "analysis" or "analysis.table".
class MemorySink final : public results::Sink {
 public:
  struct Table {
    results::TableLayout layout;
    std::vector<std::vector<double>> rows;

    /// Column of `variable` of `label` (empty for scalar blocks).
    std::size_t column(const std::string& variable, const std::string& label = "") const {
      std::size_t place = 0;
      for (const auto& block : layout.blocks) {
        if (block.variable == variable) {
          if (label.empty()) return place;
          const auto found = std::find(block.labels.begin(), block.labels.end(), label);
          if (found != block.labels.end()) return place + static_cast<std::size_t>(found - block.labels.begin());
        }
        place += block.width();
      }
      throw std::out_of_range(variable + " of " + label);
    }
  };

  std::unique_ptr<results::RowWriter> open(const results::TableLayout& layout) override {
    Table& table = tables[layout.table.empty() ? layout.analysis : layout.analysis + "." + layout.table];
    table.layout = layout;
    return std::make_unique<Writer>(table);
  }
  void conclude(const std::string&, const std::string& status, const std::string&,
                const std::vector<std::pair<std::string, std::string>>&) override {
    last_status = status;
  }

  std::map<std::string, Table> tables;
  std::string last_status;

 private:
  struct Writer final : results::RowWriter {
    explicit Writer(Table& t) : table(t) {}
    void append(std::span<const double> row) override { table.rows.emplace_back(row.begin(), row.end()); }
    void flush() override {}
    Table& table;
  };
};

struct MemoryJournal final : results::Journal {
  std::vector<std::vector<double>> pieces;
  long finished() const override { return static_cast<long>(pieces.size()); }
  std::vector<double> read(long piece) override { return pieces.at(static_cast<std::size_t>(piece)); }
  void keep(std::span<const double> values) override { pieces.emplace_back(values.begin(), values.end()); }
};

struct QuietProgress final : analysis::Progress {
  void begin(const std::string&, double, const std::string&) override {}
  void advance(double) override {}
  void end() override {}
};

}  // namespace rubato::testing
