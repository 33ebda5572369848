#include <rubato/analysis/steady/status_counts.hpp>

#include <fmt/format.h>

namespace rubato::analysis {

const std::vector<std::string>& status_words() {
  static const std::vector<std::string> words{"converged", "not_converged", "subharmonic", "quasi_periodic",
                                              "unbounded", "impossible",    "drifting"};
  return words;
}

PointStatus point_status(steady::SteadyStatus status) {
  switch (status) {
    case steady::SteadyStatus::converged:
      return PointStatus::converged;
    case steady::SteadyStatus::not_converged:
      return PointStatus::not_converged;
    case steady::SteadyStatus::subharmonic:
      return PointStatus::subharmonic;
    case steady::SteadyStatus::quasi_periodic:
      return PointStatus::quasi_periodic;
    case steady::SteadyStatus::unbounded:
      return PointStatus::unbounded;
    case steady::SteadyStatus::drifting:
      return PointStatus::drifting;
  }
  return PointStatus::not_converged;
}

void Tally::note(double place) {
  count += 1.0;
  if (first < 0.0) first = place;
}

void Tally::add(const Tally& other) {
  count += other.count;
  if (other.first >= 0.0 && (first < 0.0 || other.first < first)) first = other.first;
}

double StatusCounts::total() const {
  double sum = 0.0;
  for (const Tally& tally : by_status) sum += tally.count;
  return sum;
}

void StatusCounts::add(const StatusCounts& other) {
  for (std::size_t i = 0; i < by_status.size(); ++i) by_status[i].add(other.by_status[i]);
  negative_loads.add(other.negative_loads);
  excursions.add(other.excursions);
}

void StatusCounts::pack(std::vector<double>& values) const {
  for (const Tally& tally : by_status) values.insert(values.end(), {tally.count, tally.first});
  for (const Tally* tally : {&negative_loads, &excursions}) values.insert(values.end(), {tally->count, tally->first});
}

void StatusCounts::unpack(PackedNumbers& values) {
  const auto read = [&](Tally& tally) {
    tally.count = values.next();
    tally.first = values.next();
  };
  for (Tally& tally : by_status) read(tally);
  read(negative_loads);
  read(excursions);
}

void StatusCounts::describe(std::vector<std::pair<std::string, std::string>>& statistics) const {
  for (std::size_t i = 0; i < by_status.size(); ++i)
    if (i == 0 || by_status[i].count > 0.0)
      statistics.emplace_back(status_words()[i], fmt::format("{:.0f}", by_status[i].count));
}

}  // namespace rubato::analysis
