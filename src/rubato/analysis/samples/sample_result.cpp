#include <rubato/analysis/packed_numbers.hpp>
#include <rubato/analysis/samples/sample_result.hpp>

#include <algorithm>

namespace rubato::analysis {
namespace {

/// A byte a number behind their count: texts are short beside the numbers of a sample.
void pack(const std::string& text, std::vector<double>& values) {
  values.push_back(static_cast<double>(text.size()));
  for (const char c : text) values.push_back(static_cast<double>(static_cast<unsigned char>(c)));
}

std::string text_of(PackedNumbers& numbers) {
  std::string text;
  for (const double c : numbers.rows(1))
    text += static_cast<char>(static_cast<unsigned char>(std::clamp(c, 0.0, 255.0)));
  return text;
}

}  // namespace

std::vector<double> SampleResult::packed() const {
  std::vector<double> values{static_cast<double>(number), static_cast<double>(status), warning_count,
                             static_cast<double>(warnings.size())};
  for (const std::string& warning : warnings) pack(warning, values);
  pack(reason, values);
  for (const auto* list : {&numbers.values, &rows}) {
    values.push_back(static_cast<double>(list->size()));
    values.insert(values.end(), list->begin(), list->end());
  }
  return values;
}

SampleResult SampleResult::unpacked(long number, std::span<const double> values) {
  PackedNumbers list(values);
  SampleResult result;
  result.number = number;
  list.expect(static_cast<double>(number));
  const double status = list.next();
  if (!(status == 0.0 || status == 1.0 || status == 2.0)) PackedNumbers::refuse();
  result.status = static_cast<SampleStatus>(status);
  result.warning_count = list.next();
  const double count = list.next();
  if (!(count >= 0.0 && count < 1e6)) PackedNumbers::refuse();
  for (double i = 0.0; i < count; i += 1.0) result.warnings.push_back(text_of(list));
  result.reason = text_of(list);
  result.numbers.values = list.rows(1);
  result.rows = list.rows(1);
  list.expect_end();
  return result;
}

}  // namespace rubato::analysis
