#include "study.hpp"

#include <rubato/core/error.hpp>
#include <rubato/io/folder_lock.hpp>
#include <rubato/io/output_folder.hpp>
#include <rubato/io/tee_sink.hpp>
#include <rubato/io/write_csv.hpp>
#include <rubato/io/write_netcdf.hpp>
#include <rubato/report/former_tables.hpp>
#include <rubato/report/write_report.hpp>

#include <cstdlib>

namespace rubato::python {
namespace {

// HDF5 keeps one state for the whole process.
std::mutex writing;

/// A folder that goes with its content.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "rubato-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw OutputError("no folder can be made in " + std::filesystem::temp_directory_path().string());
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

io::Provenance provenance_of(const model::StudyDescription& study, const std::string& command) {
  return {study.title, study.file, study.text, command, io::utc_now()};
}

}  // namespace

void Run::write(const std::filesystem::path& folder, const std::string& command) const {
  const std::lock_guard only_one(writing);
  io::make_output_folder(folder);
  const io::FolderLock lock(folder);
  const auto former = report::tables_in(folder);
  io::NetcdfSink netcdf(folder / "results.nc", provenance_of(*study_.description, command));
  for (const auto& analysis : analyses()) netcdf.expect(analysis.name);
  io::CsvSink csv(folder, [&] { return netcdf.is_published(); });
  io::TeeSink sink({&netcdf, &csv});
  results::write(analyses(), sink);
  netcdf.close();
  csv.close();
  (void)report::set_former_aside(former, csv.written(), folder);
  report::write_report(folder / "results.nc", folder / "report.html");
}

void Run::write_report(const std::filesystem::path& page, const std::string& command) const {
  const std::lock_guard only_one(writing);
  const ScratchFolder scratch;
  const auto file = scratch.path() / "results.nc";
  io::NetcdfSink netcdf(file, provenance_of(*study_.description, command));
  for (const auto& analysis : analyses()) netcdf.expect(analysis.name);
  results::write(analyses(), netcdf);
  netcdf.close();
  report::write_report(file, page);
}

}  // namespace rubato::python
