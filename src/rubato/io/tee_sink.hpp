#pragma once

#include <rubato/results/sink.hpp>

#include <memory>
#include <vector>

namespace rubato::io {

/// Sends everything to several sinks, which must outlive it.
class TeeSink final : public results::Sink {
 public:
  explicit TeeSink(std::vector<results::Sink*> sinks) : sinks_(std::move(sinks)) {}

  std::unique_ptr<results::RowWriter> open(const results::TableLayout& layout) override {
    auto writer = std::make_unique<Writer>();
    for (results::Sink* sink : sinks_) writer->writers.push_back(sink->open(layout));
    return writer;
  }
  void conclude(const std::string& analysis, const std::string& status, const std::string& message,
                const std::vector<std::pair<std::string, std::string>>& attributes) override {
    for (results::Sink* sink : sinks_) sink->conclude(analysis, status, message, attributes);
  }

 private:
  struct Writer final : results::RowWriter {
    void append(std::span<const double> row) override {
      for (auto& writer : writers) writer->append(row);
    }
    void flush() override {
      for (auto& writer : writers) writer->flush();
    }
    std::vector<std::unique_ptr<results::RowWriter>> writers;
  };

  std::vector<results::Sink*> sinks_;
};

}  // namespace rubato::io
