#include <rubato/io/checksum.hpp>
#include <rubato/io/read_parts.hpp>
#include <rubato/io/study_folder.hpp>

namespace rubato::io {

std::string StudyFolder::read(const std::string& file, const Location& where, std::uintmax_t limit,
                              const std::string& what) const {
  std::string text = read_text(path_ / file, file, where, limit, what);
  if (files_) {
    Checksum checksum;
    checksum.take(std::string_view(text));
    files_->push_back({file, checksum.value()});
  }
  return text;
}

std::string StudyFolder::place_of(const std::string& file) const { return (path_ / file).lexically_normal().string(); }

}  // namespace rubato::io
