#include <rubato/core/stopping_aside.hpp>
#include <rubato/integrate/kinds/contact_limits.hpp>
#include <rubato/numerics/eigen_unsymmetric.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rubato::integrate {
namespace {

using Kind = ContactLimit::Kind;

constexpr Index most_unsymmetric = 400;  // seconds
constexpr double any_limit = 1e100;      // a friction force that no contact holds: at() cuts it to mu N

constexpr const char* two_directions =
    "and rubs in two directions: across the one in which it slides it would be damped as its speed and load say, which "
    "modes do not carry; write it with one tangential direction (tangential = { ... } and normal = { ... }), or take a "
    "transient";

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::open:
      return "open";
    case Kind::stuck:
      return "stuck";
    case Kind::frictionless:
      return "frictionless";
    case Kind::static_state:
      return "static";
    case Kind::sliding:
      break;
  }
  return "sliding";
}

std::vector<int> sliding_contacts(const ModesRequest& request, const model::ContactLimitDescription& description,
                                  const system::LocallyNonlinear& system) {
  std::vector<std::string> known;
  for (const auto& block : system.blocks()) known.push_back(block.name);
  std::vector<int> slides(known.size(), 0);
  for (const auto& [name, quantity] : description.sliding) {
    const Location& place = quantity.where.line > 0 ? quantity.where : description.where;
    const std::string title = fmt::format("{}contacts: sliding: \"{}\"", request.title, name);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw InvalidInput(place, fmt::format("{} is no [[contact]] of this study{}", title, suggestion(name, known)));
    const auto block = static_cast<std::size_t>(found - known.begin());
    const Index directions = system.blocks()[block].law->size() - 1;
    if (directions == 0)
      throw InvalidInput(place, title +
                                    " has no friction_coefficient, and nothing rubs that could slide; give it one, "
                                    "or leave it out");
    if (directions > 1) throw InvalidInput(place, title + " slides, " + two_directions);
    const double sign = model::evaluate(quantity, request.parameters, title);
    if (sign != 1.0 && sign != -1.0)
      throw InvalidInput(place, fmt::format("{} slides in the direction 1 or -1 of its u, got {}", title, sign));
    slides[block] = sign > 0.0 ? 1 : -1;
  }
  return slides;
}

/// Whether contacts slide on steadily in the static state.
bool slides_on(const ModesRequest& request, const model::ContactLimitDescription& description,
               const system::LocallyNonlinear& system) {
  bool slides = false;
  for (const auto& block : system.blocks()) {
    if (block.law->sliding_velocity() == 0.0) continue;
    slides = true;
    if (block.law->size() > 2)
      throw InvalidInput(description.where, fmt::format("{}contacts: in the static state \"{}\" slides, {}",
                                                        request.title, block.name, two_directions));
  }
  return slides;
}

void refuse_large(const ModesRequest& request, const model::ContactLimitDescription& description,
                  const system::LocallyNonlinear& system) {
  if (system.size() <= most_unsymmetric) return;
  throw InvalidInput(description.where,
                     fmt::format("{}contacts: modes of contacts that slide are found for up to {} coordinates, "
                                 "and this model has {}; reduce it ([reduction]), or take a transient",
                                 request.title, most_unsymmetric, system.size()));
}

/// Adds the slope of one contact's force by another's displacement.
class Slopes {
 public:
  explicit Slopes(const system::LocallyNonlinear& system) : system_(system) {}

  void add(Index row, Index by, double slope) {
    if (slope == 0.0) return;
    for (const model::Share& to : system_.column(row))
      for (const model::Share& from : system_.column(by))
        entries_.emplace_back(to.coordinate, from.coordinate, to.weight * from.weight * slope);
  }
  void add(Index contact, double slope) { add(contact, contact, slope); }
  SparseMatrix with(const SparseMatrix& matrix) const {
    SparseMatrix added(system_.size(), system_.size());
    added.setFromTriplets(entries_.begin(), entries_.end());
    return SparseMatrix(matrix + added);
  }

 private:
  const system::LocallyNonlinear& system_;
  std::vector<Eigen::Triplet<double>> entries_;
};

bool keeps_friction(Kind kind) { return kind == Kind::stuck || kind == Kind::static_state || kind == Kind::sliding; }

void add_law(const ContactLimit& limit, Index j, const system::LocallyNonlinear& system, const system::State& at,
             Slopes& stiffness, Slopes& damping) {
  const model::Law& law = *system.laws()[static_cast<std::size_t>(j)].law;
  const Index contact = system.first_law() + j;
  const bool is_static = limit.needs_static_state();
  const double sticking = law.sticking_stiffness();
  // What sticks and slips has its slope from the limit; of what it does otherwise, where nothing has moved.
  const Vector virgin = Vector::Zero(std::max<Index>(1, law.memory_size()));
  const bool is_at_state = is_static && sticking == 0.0;
  const model::LawPoint point = is_static ? system.law_point(j, at, model::Side::left) : model::LawPoint{};
  const model::LawAnswer answer =
      is_at_state ? law.at(point, at.memory.data() + system.memory_of(j)) : law.at(model::LawPoint{}, virgin.data());
  stiffness.add(contact, answer.by_u);
  damping.add(contact, answer.by_rate);
  const bool is_open = is_static && sticking > 0.0 &&
                       law.contact(point, at.memory.data() + system.memory_of(j), 0.0) == model::Law::Contact::open;
  if (keeps_friction(limit.kind) && !is_open) stiffness.add(contact, sticking);
}

/// By the slopes of a contact at its limit of friction, pressed, that slips on.
void add_sliding(const model::BlockLaw& law, Index first, int sign, Slopes& stiffness, Slopes& damping) {
  const Index normal = law.size() - 1;
  model::BlockPoint point;
  point.u[normal] = law.clearance() + std::max(1.0, std::abs(law.clearance()));
  point.rate[0] = sign;
  const double memory = sign * any_limit;
  const model::BlockAnswer answer = law.at(point, &memory);
  for (Index i = 0; i < law.size(); ++i)
    for (Index k = 0; k < law.size(); ++k) {
      stiffness.add(first + i, first + k, answer.by_u[i][k]);
      damping.add(first + i, first + k, answer.by_rate[i][k]);
    }
}

/// @return whether it adds what is not symmetric
bool add_block(const ContactLimit& limit, Index b, const system::LocallyNonlinear& system, const system::State& at,
               Slopes& stiffness, Slopes& damping) {
  const model::BlockLaw& law = *system.blocks()[static_cast<std::size_t>(b)].law;
  const Index first = system.row_of_block(b), normal = law.size() - 1;
  if (limit.kind == Kind::open) return false;
  if (limit.needs_static_state() &&
      law.contact(system.block_point(b, at), at.memory.data() + system.memory_of_block(b)) == model::Law::Contact::open)
    return false;
  int sign = limit.slides.empty() ? 0 : limit.slides[static_cast<std::size_t>(b)];
  if (limit.needs_static_state())
    if (const double velocity = law.sliding_velocity(); velocity != 0.0) sign = velocity > 0.0 ? 1 : -1;
  if (sign != 0) {
    add_sliding(law, first, sign, stiffness, damping);
    return true;
  }
  stiffness.add(first + normal, law.limit_stiffness(normal, true));
  damping.add(first + normal, law.closed_damping());
  for (Index i = 0; i < normal && keeps_friction(limit.kind); ++i)
    stiffness.add(first + i, law.limit_stiffness(i, true));
  return false;
}

}  // namespace

std::vector<ContactLimit> contact_limits(const ModesRequest& request, const SystemKind& kind) {
  if (!kind.structure())
    throw InvalidInput(request.description.contacts_where,
                       request.title +
                           "\"contacts\" is for structures; the modes of a mechanism are those of the state that they "
                           "are about, with its contacts as they are there (about = \"static\")");
  const system::LocallyNonlinear& system = *kind.structure();
  std::vector<ContactLimit> limits;
  for (const model::ContactLimitDescription& one : *request.description.contacts) {
    ContactLimit limit{one.kind, name_of(one.kind), {}};
    if (one.kind == Kind::sliding) limit.slides = sliding_contacts(request, one, system);
    if (one.kind == Kind::sliding || (one.kind == Kind::static_state && slides_on(request, one, system)))
      refuse_large(request, one, system);
    const auto same = std::count_if(limits.begin(), limits.end(),
                                    [&](const ContactLimit& other) { return other.kind == limit.kind; });
    if (same > 0 && one.kind != Kind::sliding)
      throw InvalidInput(one.where, fmt::format("{}contacts names \"{}\" twice", request.title, limit.name));
    if (same > 0) limit.name += std::to_string(same + 1);
    limits.push_back(std::move(limit));
  }
  return limits;
}

LimitMatrices matrices_in(const ContactLimit& limit, const system::LocallyNonlinear& system, const system::State& at) {
  Slopes stiffness(system), damping(system);
  for (Index i = 0; i < system.slider_count() && keeps_friction(limit.kind); ++i)
    stiffness.add(i, system.sliders()[static_cast<std::size_t>(i)].stiffness);
  for (Index j = 0; j < system.stop_count() && limit.needs_static_state(); ++j) {
    const model::Stop& stop = system.stops()[static_cast<std::size_t>(j)];
    const Index contact = system.slider_count() + j;
    if (!(system.relative_displacement(contact, at.q) > stop.gap)) continue;
    stiffness.add(contact, stop.stiffness);
    damping.add(contact, stop.damping);
  }
  for (Index j = 0; j < system.law_count(); ++j) add_law(limit, j, system, at, stiffness, damping);
  LimitMatrices matrices;
  for (Index b = 0; b < system.block_count(); ++b)
    if (add_block(limit, b, system, at, stiffness, damping)) matrices.is_symmetric = false;
  matrices.stiffness = stiffness.with(system.stiffness());
  matrices.damping = damping.with(system.damping());
  return matrices;
}

FreeMotions free_motions_in(const ContactLimit& limit, const SystemKind& kind, const system::State& at, Index count) {
  const system::LocallyNonlinear& system = *kind.structure();
  FreeMotions motions;
  motions.freedoms = system.size();
  // Aside: the dense solvers in it cannot be asked to stop.
  motions.found = stoppable_aside([matrices = matrices_in(limit, system, at), mass = system.mass(), count] {
    if (matrices.is_symmetric) return numerics::lowest_damped_modes(matrices.stiffness, matrices.damping, mass, count);
    return numerics::lowest_unsymmetric_modes(Matrix(matrices.stiffness), Matrix(matrices.damping), Matrix(mass),
                                              count);
  });
  return motions;
}

}  // namespace rubato::integrate
