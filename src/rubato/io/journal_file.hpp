#pragma once

#include <rubato/io/flush_timer.hpp>
#include <rubato/model/description.hpp>
#include <rubato/results/journal.hpp>

#include <filesystem>
#include <string>

namespace rubato::io {

/// A number that changes with whatever may change the results of an analysis: the text of the study and of the files
/// that it names, replaced parameters, the version of the program.
std::string fingerprint_of(const model::StudyDescription& study, const numerics::Parameters& overrides,
                           const std::string& analysis);

/// The finished pieces of an analysis in a file: what was written reaches the disk at least once a second, and a piece
/// that a killed process left half-written does not count.
class JournalFile final : public results::Journal {
 public:
  /// Opens the journal of an interrupted run, or begins a new one where there is none.
  /// @param resume  false: begins a new one in any case
  /// Throws InvalidInput for a journal of another fingerprint, and OutputError.
  JournalFile(std::filesystem::path path, const std::string& fingerprint, bool resume);
  ~JournalFile() override;
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  long finished() const override { return finished_; }
  std::vector<double> read(long piece) override;
  void keep(std::span<const double> values) override;
  void flush();
  /// Removes the file: the analysis is done, and its results are safe.
  void remove();

 private:
  void find_pieces(const std::string& head);
  void begin(const std::string& head);

  std::filesystem::path path_;
  int file_ = -1;
  long finished_ = 0, next_read_ = 0;
  std::uintmax_t end_ = 0, read_at_ = 0;  ///< behind the last piece; the next to be read [bytes]
  std::string buffer_;
  FlushTimer timer_;
};

}  // namespace rubato::io
