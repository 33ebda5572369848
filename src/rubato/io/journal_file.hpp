#pragma once

#include <rubato/io/flush_timer.hpp>
#include <rubato/io/source_files.hpp>
#include <rubato/model/description.hpp>
#include <rubato/results/journal.hpp>

#include <cstdint>
#include <filesystem>
#include <string>

namespace rubato::io {

/// A number that changes with whatever may change the results of an analysis: the text of the study, the contents of
/// the files that it names, replaced parameters, the version of the program.
std::string fingerprint_of(const model::StudyDescription& study, const SourceFiles& files,
                           const numerics::Parameters& overrides, const std::string& analysis);

/// The finished pieces of an analysis in a file: what was written reaches the disk at least once a second.
///
/// A line names the format and the fingerprint. Records follow, a piece each:
///
///   number of the piece, number of its values, checksum     three whole numbers of 64 bits
///   the values                                              numbers of 64 bits
///
/// in the order of bytes of the machine. The checksum is over fingerprint, number, count and values. A record counts
/// only if it is whole, in its place and of this journal; records after one that does not count are not read.
class JournalFile final : public results::Journal {
 public:
  /// Opens the journal of an interrupted run, or begins a new one where there is none.
  /// @param resume  false: begins a new one in any case
  /// Throws InvalidInput for a journal of another fingerprint or format, and OutputError.
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
  /// What is wrong with the journal that was found, and how many pieces are kept of it; empty where nothing is.
  const std::string& damage() const { return damage_; }
  /// Whether the only fault is a last piece without its end, as a killed run leaves it.
  bool is_cut_short() const { return is_cut_short_; }

 private:
  struct Record;
  void find_pieces(const std::string& head);
  void begin(const std::string& head);
  Record record_at(std::uintmax_t place, long number, std::vector<double>& values) const;
  std::uint64_t checksum(long number, std::span<const double> values) const;

  std::filesystem::path path_;
  std::string fingerprint_, damage_;
  bool is_cut_short_ = false;
  int file_ = -1;
  long finished_ = 0, next_read_ = 0;
  std::uintmax_t end_ = 0, read_at_ = 0;  ///< behind the last piece; the next to be read [bytes]
  std::string buffer_;
  FlushTimer timer_;
};

}  // namespace rubato::io
