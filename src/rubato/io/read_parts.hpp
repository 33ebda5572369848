#pragma once

#include <rubato/io/study_folder.hpp>
#include <rubato/io/toml_reader.hpp>
#include <rubato/model/fields/model_fields.hpp>
#include <rubato/model/finite_elements/finite_elements.hpp>

#include <filesystem>
#include <memory>

// The parts of a study file, each in a file of its own. Private to io.
namespace rubato::io {

/// [parameters]
std::vector<model::ParameterDescription> read_parameters(TomlReader& root, const std::string& key);

/// The rows of the CSV files that [nodes] and [beams] name, added to those of the study.
void read_mesh(const model::NodeFileDescription& nodes, const StudyFolder& folder,
               model::StructureDescription& structure);
void read_mesh(const model::BeamFileDescription& beams, const StudyFolder& folder,
               model::StructureDescription& structure);

/// The files that [model] names.
void read_mesh(const model::FiniteElementFileDescription& files, const StudyFolder& folder,
               std::shared_ptr<const model::FiniteElements>& to);

/// [reduction], for the model before it. Throws InvalidInput where there is none.
void read_mesh(const model::ReductionDescription& reduction, const StudyFolder& folder,
               std::shared_ptr<const model::FiniteElements>& to);
/// [cyclic], for the model before it. Throws InvalidInput where there is none.
void read_mesh(const model::CyclicDescription& cyclic, const StudyFolder& folder,
               std::shared_ptr<const model::FiniteElements>& to);
/// Lets what analyses observe stay in the reduced model.
void keep_observed(model::StudyDescription& study);

/// [[analysis]]
std::vector<model::AnalysisDescription> read_analyses(TomlReader& root, const std::string& key,
                                                      const StudyFolder& folder);

/// A list of numbers, or { from, to, points, spacing }.
model::ValuesDescription to_values(TomlReader& reader, const toml::node& node, const std::string& key,
                                   const StudyFolder& folder);

/// A grid, a list of cases or random samples of parameters.
model::SweepDescription read_sweep(TomlReader& reader, const std::string& key, const StudyFolder& folder);

/// The entries of a table; toml++ sorts them, and sweeps keep the order of the file.
std::vector<std::pair<std::string, const toml::node*>> in_order_of_the_file(const toml::table& table);

/// "angular_frequency" or "frequency", whichever is there: exactly one must be.
std::string frequency_key(TomlReader& reader);

/// A method's name, or a table of its name and parameters.
model::MethodDescription to_method(TomlReader& reader, const toml::node& node, const std::string& key);

/// A coordinate, or a difference ("blade1 - damper").
model::ObservationDescription to_observation(const std::string& text, const Location& where);

/// A CSV file whose header names parameters and whose rows are numbers; `#` begins a comment.
model::CaseSweepDescription read_cases(const std::string& file, const StudyFolder& folder, const Location& where);

/// What the first column of a table is.
struct TableOver {
  std::string name = "time";
  std::string unit = "s";
};

/// A CSV file of two columns, time (or another) and value; a first line that is no number is a header; `#` begins a
/// comment. Units in square brackets of the header must be that of the first column and one of `units`.
model::TableDescription read_table(const std::string& file, const StudyFolder& folder, const Location& where,
                                   const std::vector<std::string>& units, const TableOver& over = {});

/// A Matrix Market file: coordinate or array format, real or integer, general or symmetric; symmetric in value.
model::MatrixDescription read_matrix_market(const std::string& file, const StudyFolder& folder, const Location& where);

/// Throws InvalidInput, at the file, for a text that holds a zero byte; `expected` says what it should be.
void refuse_binary(const std::string& text, const std::string& file, const std::string& expected);

/// The text of a file. Throws InvalidInput at `where` if it cannot be read or is larger than `limit` [bytes];
/// `remedy` says what to do then.
std::string read_text(const std::filesystem::path& path, const std::string& name, const Location& where,
                      std::uintmax_t limit, const std::string& what, const std::string& remedy = "");

}  // namespace rubato::io
