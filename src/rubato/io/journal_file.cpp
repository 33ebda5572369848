#include <rubato/core/error.hpp>
#include <rubato/core/version.hpp>
#include <rubato/io/journal_file.hpp>
#include <rubato/io/output_folder.hpp>

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <cstdint>
#include <cstring>

namespace rubato::io {
namespace {

/// FNV-1a, 64 bits (Fowler, Noll and Vo).
class Digest {
 public:
  void take(std::string_view bytes) {
    for (const char c : bytes) value_ = (value_ ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    value_ = (value_ ^ 0xffu) * 0x100000001b3u;  // the end of a text
  }
  void take(double number) { take(std::string_view(reinterpret_cast<const char*>(&number), sizeof number)); }
  void take(const std::vector<double>& numbers) {
    take(std::string_view(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)));
  }
  void take(const model::MatrixDescription& matrix) {
    for (const auto& entry : matrix.entries) {
      take(static_cast<double>(entry.row));
      take(static_cast<double>(entry.column));
      take(entry.value);
    }
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

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

}  // namespace

std::string fingerprint_of(const model::StudyDescription& study, const numerics::Parameters& overrides,
                           const std::string& analysis) {
  Digest digest;
  digest.take(version);
  digest.take(study.text);
  digest.take(analysis);
  for (const auto& [name, value] : overrides) {
    digest.take(name);
    digest.take(value);
  }
  const auto take_law = [&](const model::TimeLawDescription& law) {
    if (const auto* table = std::get_if<model::TableDescription>(&law)) {
      digest.take(table->times);
      digest.take(table->values);
    }
  };
  for (const auto& force : study.model.forces) take_law(force.law);
  for (const auto& joint : study.model.joints)
    if (joint.motion) std::visit(take_law, joint.motion->law);
  if (study.model.base_motion) take_law(study.model.base_motion->law);
  if (study.model.matrices) {
    digest.take(study.model.matrices->mass);
    digest.take(study.model.matrices->stiffness);
    if (study.model.matrices->damping) digest.take(*study.model.matrices->damping);
  }
  const auto take_cases = [&](const auto& task) {
    if constexpr (requires { task.sweep; })
      if (const auto* cases = std::get_if<model::CaseSweepDescription>(&task.sweep)) {
        for (const auto& name : cases->names) digest.take(name);
        digest.take(cases->values);
      }
  };
  for (const auto& other : study.analyses) std::visit(take_cases, other.task);
  return fmt::format("{:016x}", digest.value());
}

JournalFile::JournalFile(std::filesystem::path path, const std::string& fingerprint, bool resume)
    : path_(std::move(path)) {
  const std::string head = "rubato journal 1 " + fingerprint + "\n";
  errno = 0;
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | (resume ? 0 : O_TRUNC), 0666);
  if (file_ < 0) throw OutputError(write_failure(path_, errno));
  try {
    std::string found(head.size(), '\0');
    found.resize(resume ? read_at(file_, 0, found.data(), found.size()) : 0);
    if (found.size() < head.size()) {
      begin(head);
    } else if (found != head) {
      throw InvalidInput(
          fmt::format("--resume: {} was left by another study, other values of --set or another version; "
                      "run without --resume to begin afresh",
                      path_.string()));
    } else {
      find_pieces(head);
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

// A piece is its number of values, the values, and the number again.
void JournalFile::find_pieces(const std::string& head) {
  end_ = read_at_ = head.size();
  for (;;) {
    std::uint64_t count = 0, again = 0;
    if (read_at(file_, end_, &count, sizeof count) < sizeof count) break;
    if (count > std::uint64_t{1} << 40) break;
    const std::uintmax_t behind = end_ + sizeof count + count * sizeof(double);
    if (read_at(file_, behind, &again, sizeof again) < sizeof again || again != count) break;
    end_ = behind + sizeof again;
    ++finished_;
  }
  if (::ftruncate(file_, static_cast<off_t>(end_)) != 0) throw OutputError(write_failure(path_, errno));
}

std::vector<double> JournalFile::read(long piece) {
  assert(piece == next_read_ && piece < finished_);
  ++next_read_;
  std::uint64_t count = 0;
  (void)read_at(file_, read_at_, &count, sizeof count);
  std::vector<double> values(count);
  if (read_at(file_, read_at_ + sizeof count, values.data(), count * sizeof(double)) < count * sizeof(double))
    throw OutputError(fmt::format("{}: cannot be read back: {}", path_.string(), std::strerror(errno)));
  read_at_ += 2 * sizeof count + count * sizeof(double);
  return values;
}

void JournalFile::keep(std::span<const double> values) {
  const std::uint64_t count = values.size();
  const auto add = [&](const void* bytes, std::size_t size) { buffer_.append(static_cast<const char*>(bytes), size); };
  add(&count, sizeof count);
  add(values.data(), values.size_bytes());
  add(&count, sizeof count);
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
