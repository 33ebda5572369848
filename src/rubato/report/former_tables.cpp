#include <rubato/report/former_tables.hpp>
#include <rubato/report/results_tables.hpp>

#include <exception>
#include <system_error>

namespace rubato::report {

std::vector<std::string> tables_in(const std::filesystem::path& folder) {
  std::vector<std::string> files;
  try {
    const ResultsTables results(folder / "results.nc");
    for (const auto& analysis : results.analyses())
      for (const auto& table : analysis.tables)
        files.push_back(analysis.name + (table->name().empty() ? "" : "." + table->name()) + ".csv");
  } catch (const std::exception&) {  // it is about to be replaced, whatever it is
  }
  return files;
}

SetAside set_former_aside(const std::vector<std::string>& former, const std::set<std::string>& written,
                          const std::filesystem::path& folder) {
  const std::filesystem::path aside = folder / "former";
  SetAside result;
  for (const std::string& file : former) {
    std::error_code fault;
    if (written.contains(file)) continue;
    if (!std::filesystem::exists(folder / file, fault)) continue;
    std::filesystem::create_directory(aside, fault);
    if (!fault) std::filesystem::rename(folder / file, aside / file, fault);
    (fault ? result.left : result.moved).push_back(file);
  }
  return result;
}

}  // namespace rubato::report
