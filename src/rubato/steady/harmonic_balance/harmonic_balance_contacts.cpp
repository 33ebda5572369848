#include <rubato/steady/harmonic_balance/harmonic_balance_equations.hpp>

#include <algorithm>
#include <numeric>

// The forces of sliders, laws and groups of laws as the balance sees them, with their derivatives.
namespace rubato::steady {

HarmonicBalanceEquations::HarmonicBalanceEquations(const Vector& stiffness, const Vector& holding,
                                                   const system::LocallyNonlinear& system)
    : stiffness_(stiffness), holding_(holding), sliders_(system.slider_count()) {
  loops_.resize(static_cast<std::size_t>(sliders_));
  law_count_ = system.law_count() + system.block_count();
  seats_.resize(static_cast<std::size_t>(stiffness.size() - sliders_));
  own_.resize(static_cast<std::size_t>(stiffness.size()));
  std::iota(own_.begin(), own_.end(), Index{0});
  GroupedLaws grouped = group_laws(system);
  single_ = std::move(grouped.single);
  for (const Index j : single_) {
    seats_[static_cast<std::size_t>(system.first_law() + j - sliders_)].law = laws_.size();
    const model::LawBetween& law = system.laws()[static_cast<std::size_t>(j)];
    laws_.emplace_back(*law.law, law.normal.value);
  }
  for (GroupedLaws::Group& group : grouped.groups) {
    for (std::size_t i = 0; i < group.contacts.size(); ++i)
      seats_[static_cast<std::size_t>(group.contacts[i] - sliders_)] = {0, groups_.size(), static_cast<Index>(i)};
    most_partners_ = std::max(most_partners_, static_cast<Index>(group.contacts.size()));
    members_.push_back(std::move(group.contacts));
    groups_.emplace_back(*group.law);
    group_laws_.push_back(std::move(group.law));
  }
}

Vector HarmonicBalanceEquations::dissipated() const {
  Vector work = Vector::Zero(law_count_);
  for (std::size_t i = 0; i < laws_.size(); ++i) work[single_[i]] = laws_[i].dissipated();
  for (const GroupBySamples& group : groups_) group.add_dissipated(work);
  return work;
}

Complex HarmonicBalanceEquations::force_of(Index j, int k) const {
  if (j < sliders_) return loops_[static_cast<std::size_t>(j)].force(k);
  return is_grouped(j) ? group(j).force(seat(j).number, k) : law(j).force(k);
}

double HarmonicBalanceEquations::mean_force_of(Index j) const {
  if (j < sliders_) return loops_[static_cast<std::size_t>(j)].mean_force();
  return is_grouped(j) ? group(j).mean_force(seat(j).number) : law(j).mean_force();
}

void HarmonicBalanceEquations::derivative_of(Index i, Index j, int k, int l, Complex& by_real,
                                             Complex& by_imaginary) const {
  if (j < sliders_)
    loops_[static_cast<std::size_t>(j)].derivative(k, l, by_real, by_imaginary);
  else if (is_grouped(j))
    group(j).derivative(seat(i).number, seat(j).number, k, l, by_real, by_imaginary);
  else
    law(j).derivative(k, l, by_real, by_imaginary);
}

void HarmonicBalanceEquations::mean_derivative_of(Index i, Index j, int l, double& by_real,
                                                  double& by_imaginary) const {
  if (j < sliders_)
    loops_[static_cast<std::size_t>(j)].mean_derivative(l, by_real, by_imaginary);
  else if (is_grouped(j))
    group(j).mean_derivative(seat(i).number, seat(j).number, l, by_real, by_imaginary);
  else
    law(j).mean_derivative(l, by_real, by_imaginary);
}

Complex HarmonicBalanceEquations::derivative_by_mean_of(Index i, Index j, int k) const {
  if (j < sliders_) return 0.0;
  return is_grouped(j) ? group(j).derivative_by_mean(seat(i).number, seat(j).number, k) : law(j).derivative_by_mean(k);
}

double HarmonicBalanceEquations::mean_derivative_by_mean_of(Index i, Index j) const {
  if (j < sliders_) return loops_[static_cast<std::size_t>(j)].mean_derivative();
  return is_grouped(j) ? group(j).mean_derivative(seat(i).number, seat(j).number) : law(j).mean_derivative();
}

/// Finds the forces of a contact, those of a group with its first one.
void HarmonicBalanceEquations::pass(Index j, const SliderSeries& series) {
  const int count = series.orders.count;
  const auto coefficients = [&](Index i) { return series.coefficients.data() + i * count; };
  SampleAngles& angles = is_fine_ ? fine_angles_ : coarse_angles_;
  const double frequency = (*harmonics_)[1].angular_frequency;
  if (j < sliders_) {
    const double share = effective_[j] / stiffness_[j];  // of kT in what acts on W
    loops_[static_cast<std::size_t>(j)].pass(effective_[j], limits_[j], series.mean[j], series.orders, coefficients(j),
                                             share * offsets_[j]);
  } else if (!is_grouped(j)) {
    laws_[seat(j).law].pass(angles, frequency, series.mean[j], series.orders, coefficients(j));
  } else if (const std::span<const Index> members = partners(j);
             j == *std::min_element(members.begin(), members.end())) {
    Vector mean(static_cast<Index>(members.size()));
    std::vector<const Complex*> of_members(members.size());
    for (std::size_t i = 0; i < members.size(); ++i) {
      mean[static_cast<Index>(i)] = series.mean[members[i]];
      of_members[i] = coefficients(members[i]);
    }
    groups_[seat(j).group].pass(angles, frequency, mean, series.orders, of_members);
  }
}

void HarmonicBalanceEquations::differentiate(const SliderSeries& series) {
  const int count = series.orders.count;
  const Index rows = rows_per_slider(series);
  columns_.setZero(most_partners_ * count, rows * static_cast<Index>(active_.size()));
  by_mean_.setZero(columns_.cols(), most_partners_);
  fill_diagonal(series, diagonal_);
  for (std::size_t b = 0; b < active_.size(); ++b) {
    const Index j = active_[b], from = static_cast<Index>(b) * rows;
    const std::span<const Index> others = partners(j);
    if (is_grouped(j)) {
      if (j == *std::min_element(others.begin(), others.end())) groups_[seat(j).group].differentiate();
    } else if (j >= sliders_) {
      laws_[seat(j).law].differentiate();
    }
    for (std::size_t p = 0; p < others.size(); ++p) differentiate(series, others[p], static_cast<Index>(p), j, from);
  }
}

/// Of the force of contact o, the p-th of its partners, by the unknowns of contact j in the columns from `from`.
void HarmonicBalanceEquations::differentiate(const SliderSeries& series, Index o, Index p, Index j, Index from) {
  const int count = series.orders.count;
  const Index shift = series.has_mean ? 1 : 0, first = p * count;
  for (int l = 0; l < count; ++l)
    for (int i = 0; i < count; ++i) {
      Complex by_real, by_imaginary;
      derivative_of(o, j, series.orders.at(i), series.orders.at(l), by_real, by_imaginary);
      const double spring = i == l && o == j ? stiffness_[j] : 0.0;
      by_real = shared(j, by_real, Complex(spring));
      by_imaginary = shared(j, by_imaginary, Complex(0.0, spring));
      const auto place = static_cast<std::size_t>(i) + 1;
      by_real *= part(place, o);
      by_imaginary *= part(place, o);
      if (i == l && o == j) {
        by_real -= held(place, j);
        by_imaginary -= Complex(0.0, held(place, j));
      }
      columns_(first + i, from + shift + 2 * l) = by_real;
      columns_(first + i, from + shift + 2 * l + 1) = by_imaginary;
    }
  if (!series.has_mean) return;
  for (int i = 0; i < count; ++i)
    columns_(first + i, from) = shared(j, derivative_by_mean_of(o, j, series.orders.at(i)), Complex(0.0));
  const double by_mean = shared(j, mean_derivative_by_mean_of(o, j), o == j ? stiffness_[j] : 0.0);
  by_mean_(from, p) = part(0, o) * by_mean - (o == j ? held(0, j) : 0.0);
  for (int l = 0; l < count; ++l) {
    double &by_real = by_mean_(from + 1 + 2 * l, p), &by_imaginary = by_mean_(from + 2 + 2 * l, p);
    mean_derivative_of(o, j, series.orders.at(l), by_real, by_imaginary);
    by_real = shared(j, by_real, 0.0);
    by_imaginary = shared(j, by_imaginary, 0.0);
  }
  by_mean_.col(p).segment(from + 1, 2 * count) *= part(0, o);
}

}  // namespace rubato::steady
