#include <rubato/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace rubato {
namespace {

std::string place(const Location& where) {
  if (where.line <= 0) return where.file.empty() ? "" : where.file + ": ";
  const std::string column = where.column > 0 ? fmt::format(":{}", where.column) : "";
  if (where.file.empty()) return fmt::format("line {}{}: ", where.line, column);
  return fmt::format("{}:{}{}: ", where.file, where.line, column);
}

// Levenshtein distance with transposition of neighbours, so that "balde" is one edit from "blade".
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, substitution});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

/// A message that quotes a text of any length, without its middle: what is wrong stands at the begin, the remedy at the
/// end.
std::string shortened(const std::string& message) {
  constexpr std::size_t longest = 6000, kept = 2000;
  if (message.size() <= longest) return message;
  const auto is_inside = [&](std::size_t i) { return (static_cast<unsigned char>(message[i]) & 0xC0u) == 0x80u; };
  std::size_t end = kept, begin = message.size() - kept;
  while (end > 0 && is_inside(end)) --end;
  while (begin < message.size() && is_inside(begin)) ++begin;
  return fmt::format("{} ... ({} characters left out) ... {}", message.substr(0, end), begin - end,
                     message.substr(begin));
}

}  // namespace

InvalidInput::InvalidInput(const Location& where, const std::string& message)
    : std::runtime_error(place(where) + "error: " + shortened(message)), where_(where), message_(shortened(message)) {}

std::string nearest_name(std::string_view name, std::span<const std::string> known) {
  std::string best;
  std::size_t best_distance = 0;
  for (const std::string& candidate : known) {
    const std::size_t distance = edit_distance(name, candidate);
    const std::size_t allowed = std::max(name.size(), candidate.size()) / 3;
    if (distance > std::max<std::size_t>(allowed, 1) || distance >= candidate.size()) continue;
    if (best.empty() || distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string suggestion(std::string_view name, std::span<const std::string> known) {
  if (known.empty()) return {};
  std::string text;
  const std::string nearest = nearest_name(name, known);
  if (!nearest.empty()) text = "; did you mean \"" + nearest + "\"?";
  text += nearest.empty() ? "; known: " : " (known: ";
  const std::size_t listed = std::min<std::size_t>(known.size(), 8);
  for (std::size_t i = 0; i < listed; ++i) text += (i == 0 ? "" : ", ") + known[i];
  if (listed < known.size()) text += ", ...";
  if (!nearest.empty()) text += ")";
  return text;
}

}  // namespace rubato
