#include <rubato/core/error.hpp>
#include <rubato/core/version.hpp>
#include <rubato/io/checksum.hpp>
#include <rubato/io/journal_file.hpp>
#include <rubato/io/output_folder.hpp>

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <cstdint>
#include <cstring>

namespace rubato::io {
namespace {

constexpr std::size_t flush_at = 1u << 20;

/// Reads up to `size` bytes at a place; returns how many there were.
std::size_t read_at(int file, std::uintmax_t place, void* bytes, std::size_t size) {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count =
        ::pread(file, static_cast<char*>(bytes) + done, size - done, static_cast<off_t>(place + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

std::uintmax_t size_of(int file) {
  struct stat status {};
  return ::fstat(file, &status) == 0 ? static_cast<std::uintmax_t>(status.st_size) : 0;
}

constexpr std::string_view format = "rubato journal 2 ", former_format = "rubato journal 1 ";

/// What stands before the values of a piece.
struct RecordHead {
  std::uint64_t number = 0, count = 0, checksum = 0;
};
static_assert(sizeof(RecordHead) == 3 * sizeof(std::uint64_t));

std::string why_refused(std::string_view found, std::string_view head) {
  if (found.starts_with(former_format)) return "was left by an earlier Rubato, whose journals cannot be verified";
  const bool is_journal =
      found.size() == head.size() && found.starts_with(format) && found.back() == '\n' &&
      found.substr(format.size(), found.size() - format.size() - 1).find_first_not_of("0123456789abcdef") ==
          std::string_view::npos;
  return is_journal ? "was left by another study, other files that it names, other values of --set or another version"
                    : "does not begin as a journal does: it is damaged, or something else";
}

}  // namespace

std::string fingerprint_of(const model::StudyDescription& study, const SourceFiles& files,
                           const numerics::Parameters& overrides, const std::string& analysis) {
  Checksum checksum;
  checksum.take(std::string_view(version));
  checksum.take(std::string_view(study.text));
  checksum.take(std::string_view(analysis));
  for (const auto& [name, value] : overrides) {
    checksum.take(std::string_view(name));
    checksum.take(value);
  }
  for (const SourceFile& file : files) {
    checksum.take(std::string_view(file.name));
    checksum.take(file.checksum);
  }
  return fmt::format("{:016x}", checksum.value());
}

JournalFile::JournalFile(std::filesystem::path path, const std::string& fingerprint, bool resume)
    : path_(std::move(path)), fingerprint_(fingerprint) {
  const std::string head = std::string(format) + fingerprint + "\n";
  errno = 0;
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | (resume ? 0 : O_TRUNC), 0666);
  if (file_ < 0) throw OutputError(write_failure(path_, errno));
  try {
    std::string found(head.size(), '\0');
    found.resize(resume ? read_at(file_, 0, found.data(), found.size()) : 0);
    if (found == head) {
      find_pieces(head);
    } else if (head.starts_with(found)) {  // empty, or its first line had no time to reach the disk
      begin(head);
    } else {
      throw InvalidInput(fmt::format("--resume: {} {}; run without --resume to begin afresh", path_.string(),
                                     why_refused(found, head)));
    }
  } catch (...) {
    ::close(file_);
    throw;
  }
}

JournalFile::~JournalFile() {
  try {
    flush();
  } catch (const OutputError&) {
    // A destructor cannot say so; the pieces are computed again.
  }
  ::close(file_);
}

void JournalFile::begin(const std::string& head) {
  if (::ftruncate(file_, 0) != 0) throw OutputError(write_failure(path_, errno));
  buffer_ = head;
  flush();
  read_at_ = end_;
}

std::uint64_t JournalFile::checksum(long number, std::span<const double> values) const {
  Checksum checksum;
  checksum.take(std::string_view(fingerprint_));
  checksum.take(static_cast<std::uint64_t>(number));
  checksum.take(static_cast<std::uint64_t>(values.size()));
  checksum.take(values.data(), values.size_bytes());
  return checksum.value();
}

/// What stands at a place of the file.
struct JournalFile::Record {
  enum class Kind { whole, cut_short, damaged, end } kind = Kind::end;
  std::uintmax_t behind = 0;  ///< where the next one is
};

JournalFile::Record JournalFile::record_at(std::uintmax_t place, long number, std::vector<double>& values) const {
  using Kind = Record::Kind;
  RecordHead head;
  const std::size_t found = read_at(file_, place, &head, sizeof head);
  if (found < sizeof head) return {found == 0 ? Kind::end : Kind::cut_short};
  const std::uintmax_t size = size_of(file_), begin = place + sizeof head;
  if (head.number != static_cast<std::uint64_t>(number)) return {Kind::damaged};
  // A count that was damaged looks like one that reaches beyond the end.
  if (head.count > (size - begin) / sizeof(double)) return {Kind::cut_short};
  values.resize(head.count);
  if (read_at(file_, begin, values.data(), head.count * sizeof(double)) < head.count * sizeof(double))
    return {Kind::cut_short};
  if (head.checksum != checksum(number, values)) return {Kind::damaged};
  return {Kind::whole, begin + head.count * sizeof(double)};
}

// Keeps the pieces up to the first that is not whole, and cuts the file there.
void JournalFile::find_pieces(const std::string& head) {
  end_ = read_at_ = head.size();
  std::vector<double> values;
  Record record;
  for (;;) {
    record = record_at(end_, finished_, values);
    if (record.kind != Record::Kind::whole) break;
    end_ = record.behind;
    ++finished_;
  }
  const std::uintmax_t size = size_of(file_);
  is_cut_short_ = record.kind == Record::Kind::cut_short;
  if (record.kind != Record::Kind::end)
    damage_ = fmt::format("{}: piece {} {}; the {} before it are kept, and the rest ({} bytes) is computed again",
                          path_.string(), finished_ + 1,
                          record.kind == Record::Kind::damaged ? "is damaged" : "is cut short", finished_, size - end_);
  if (::ftruncate(file_, static_cast<off_t>(end_)) != 0) throw OutputError(write_failure(path_, errno));
}

std::vector<double> JournalFile::read(long piece) {
  assert(piece == next_read_ && piece < finished_);
  std::vector<double> values;
  const Record record = record_at(read_at_, piece, values);
  if (record.kind != Record::Kind::whole)
    throw OutputError(fmt::format("{}: piece {} cannot be read back; has another program changed the file?",
                                  path_.string(), piece + 1));
  ++next_read_;
  read_at_ = record.behind;
  return values;
}

void JournalFile::keep(std::span<const double> values) {
  const RecordHead head{static_cast<std::uint64_t>(finished_), values.size(), checksum(finished_, values)};
  const auto add = [&](const void* bytes, std::size_t size) { buffer_.append(static_cast<const char*>(bytes), size); };
  add(&head, sizeof head);
  add(values.data(), values.size_bytes());
  ++finished_;
  if (buffer_.size() > flush_at || timer_.is_due()) flush();
}

void JournalFile::flush() {
  std::size_t written = 0;
  if (!buffer_.empty() && !has_disk_space(path_, static_cast<double>(buffer_.size())))
    throw OutputError(write_failure(path_, ENOSPC));
  while (written < buffer_.size()) {
    errno = 0;
    const ssize_t count =
        ::pwrite(file_, buffer_.data() + written, buffer_.size() - written, static_cast<off_t>(end_ + written));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) throw OutputError(write_failure(path_, errno));
    written += static_cast<std::size_t>(count);
  }
  end_ += written;
  buffer_.clear();
}

void JournalFile::remove() {
  buffer_.clear();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace rubato::io
