#pragma once

#include <rubato/report/table_source.hpp>

#include <filesystem>
#include <memory>
#include <vector>

namespace rubato::report {

/// One analysis of a results file: its group.
struct AnalysisTables {
  std::string name;
  Attributes attributes;
  std::vector<std::unique_ptr<TableSource>> tables;  ///< the main table first, where there is one
};

/// A results file (netCDF-4) seen as tables: the group of an analysis holds its main table, subgroups hold the others.
/// The tables read from the file while this lives.
class ResultsTables {
 public:
  /// @throws InvalidInput when the file cannot be opened or is not netCDF
  explicit ResultsTables(const std::filesystem::path& file);
  ~ResultsTables();
  ResultsTables(const ResultsTables&) = delete;
  ResultsTables& operator=(const ResultsTables&) = delete;

  const Attributes& attributes() const { return attributes_; }  ///< title, history, study, version
  const std::vector<AnalysisTables>& analyses() const { return analyses_; }

 private:
  int file_ = -1;
  Attributes attributes_;
  std::vector<AnalysisTables> analyses_;
};

}  // namespace rubato::report
