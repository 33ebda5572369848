#include <rubato/steady/harmonic_balance/law_group.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace rubato::steady {
namespace {

/// A law of several numbers.
class OneBlock final : public LawGroup {
 public:
  OneBlock(const model::BlockLaw& law, Index place) : law_(law), place_(place) {}

  Index size() const override { return law_.size(); }
  Index memory_size() const override { return law_.memory_size(); }
  bool depends_on_rate() const override { return false; }
  double length() const override { return law_.clearance() != 0.0 ? std::abs(law_.clearance()) : 1.0; }
  void advance(const GroupPoint& from, const double* memory, const GroupPoint& to, double* next, double* force,
               Matrix* slopes) const override {
    const model::BlockAnswer answer = law_.advance(point(from), memory, point(to), next);
    std::copy_n(answer.force, size(), force);
    if (!slopes) return;
    slopes->setZero(size(), 2 * size());
    for (Index i = 0; i < size(); ++i)
      for (Index j = 0; j < size(); ++j) (*slopes)(i, j) = answer.by_u[i][j];
  }
  bool slopes(const GroupPoint& from, const double* memory, const GroupPoint& to, Matrix& slopes) const override {
    const auto* known = dynamic_cast<const model::BlockSlopes*>(&law_);
    return known && known->slopes(point(from), memory, point(to), slopes);
  }
  void add_dissipated(const GroupPoint& from, const double* memory, const GroupPoint& to, const double* next,
                      Vector& work) const override {
    work[place_] += law_.dissipated(point(from), memory, point(to), next);
  }

 private:
  model::BlockPoint point(const GroupPoint& at) const {
    model::BlockPoint point;
    std::copy_n(at.u, size(), point.u);
    std::copy_n(at.rate, size(), point.rate);
    return point;
  }

  const model::BlockLaw& law_;
  Index place_;
};

/// A number a member; those of small groups without asking for memory.
class Pressing {
 public:
  explicit Pressing(std::size_t count) : more_(count > few_.size() ? count : 0) {}
  double& operator[](std::size_t i) { return more_.empty() ? few_[i] : more_[i]; }
  double operator[](std::size_t i) const { return more_.empty() ? few_[i] : more_[i]; }

 private:
  std::array<double, 8> few_{};
  std::vector<double> more_;
};

/// Stops and laws, each behind the one that presses on it.
class Pressed final : public LawGroup {
 public:
  struct Member {
    const model::Stop* stop = nullptr;
    const model::LawBetween* law = nullptr;  ///< null of a stop
    Index place = -1;                        ///< of a law among those of the system
    Index by = -1;                           ///< the member that presses on it; -1: a number does, or nothing
    Index memory = 0;                        ///< where its memory begins in that of the group
  };

  explicit Pressed(std::vector<Member> members) : members_(std::move(members)) {
    for (Member& member : members_) {
      member.memory = memory_;
      if (member.law) memory_ += member.law->law->memory_size();
      depends_on_rate_ =
          depends_on_rate_ || (member.law ? member.law->law->depends_on_rate() : member.stop->damping > 0.0);
    }
  }

  Index size() const override { return static_cast<Index>(members_.size()); }
  Index memory_size() const override { return memory_; }
  bool depends_on_rate() const override { return depends_on_rate_; }

  double length() const override {
    double longest = 0.0;
    for (const Member& member : members_)
      if (!member.law) longest = std::max(longest, std::abs(member.stop->gap));
    return longest > 0.0 ? longest : 1.0;
  }

  void advance(const GroupPoint& from, const double* memory, const GroupPoint& to, double* next, double* force,
               Matrix* slopes) const override {
    Pressing start(members_.size()), end(members_.size());
    const Index d = size();
    if (slopes) slopes->setZero(d, 2 * d);
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const Member& member = members_[i];
      const auto place = static_cast<Index>(i);
      if (!member.law) {
        start[i] = pressing(*member.stop, from, place);
        end[i] = pressing(*member.stop, to, place);
        force[i] = std::max(0.0, end[i]);
        // At the gap with the slope of either side.
        if (slopes && (force[i] > 0.0 || to.u[place] == member.stop->gap)) {
          (*slopes)(place, place) = member.stop->stiffness;
          (*slopes)(place, d + place) = member.stop->damping;
        }
        continue;
      }
      const model::LawPoint begin = point(from, place, start), there = point(to, place, end);
      start[i] = member.law->law->at(begin, memory + member.memory).force;
      const model::LawAnswer answer =
          member.law->law->advance(begin, memory + member.memory, there, next + member.memory);
      end[i] = force[i] = answer.force;
      if (!slopes) continue;
      if (member.by >= 0) slopes->row(place) = answer.by_normal * slopes->row(member.by);
      (*slopes)(place, place) += answer.by_u;
      (*slopes)(place, d + place) += answer.by_rate;
    }
  }

  void add_dissipated(const GroupPoint& from, const double* memory, const GroupPoint& to, const double* next,
                      Vector& work) const override {
    Pressing start(members_.size()), end(members_.size());
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const Member& member = members_[i];
      const auto place = static_cast<Index>(i);
      if (!member.law) {
        start[i] = pressing(*member.stop, from, place);
        end[i] = pressing(*member.stop, to, place);
        continue;
      }
      const model::LawPoint begin = point(from, place, start), there = point(to, place, end);
      start[i] = member.law->law->at(begin, memory + member.memory).force;
      end[i] = member.law->law->at(there, next + member.memory).force;
      work[member.place] += member.law->law->dissipated(begin, memory + member.memory, there, next + member.memory);
    }
  }

 private:
  /// As system::LocallyNonlinear::normal_force: of an open stop what its spring would pull.
  static double pressing(const model::Stop& stop, const GroupPoint& at, Index place) {
    const double force = stop.force(at.u[place], at.rate[place]);
    return force > 0.0 ? force : std::min(0.0, stop.stiffness * (at.u[place] - stop.gap));
  }
  model::LawPoint point(const GroupPoint& at, Index place, const Pressing& pressing) const {
    const Member& member = members_[static_cast<std::size_t>(place)];
    model::LawPoint point;
    point.u = at.u[place];
    point.rate = at.rate[place];
    point.normal = member.by >= 0 ? pressing[static_cast<std::size_t>(member.by)] : member.law->normal.value;
    return point;
  }

  std::vector<Member> members_;
  Index memory_ = 0;
  bool depends_on_rate_ = false;
};

/// Sets of contacts that press on each other.
class Sets {
 public:
  explicit Sets(Index count) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  Index root(Index i) const {
    while (parent_[static_cast<std::size_t>(i)] != i) i = parent_[static_cast<std::size_t>(i)];
    return i;
  }
  void join(Index i, Index j) { parent_[static_cast<std::size_t>(root(i))] = root(j); }

 private:
  std::vector<Index> parent_;
};

}  // namespace

GroupedLaws group_laws(const system::LocallyNonlinear& system) {
  const Index sliders = system.slider_count(), first_law = system.first_law();
  Sets sets(system.contact_count());
  std::vector<char> presses(static_cast<std::size_t>(system.contact_count()), 0);
  for (Index j = 0; j < system.law_count(); ++j)
    if (const Index by = system.normal_contact(j); by >= 0) {
      sets.join(first_law + j, by);
      presses[static_cast<std::size_t>(by)] = 1;
    }
  GroupedLaws result;
  std::vector<std::vector<Pressed::Member>> members;
  std::vector<Index> roots;
  const auto group_of = [&](Index contact) {
    const Index root = sets.root(contact);
    const auto known = std::find(roots.begin(), roots.end(), root);
    if (known != roots.end()) return static_cast<std::size_t>(known - roots.begin());
    roots.push_back(root);
    members.emplace_back();
    result.groups.emplace_back();
    return roots.size() - 1;
  };
  std::vector<Index> place(static_cast<std::size_t>(system.contact_count()), -1);  // in its group
  const auto add = [&](Index contact, Pressed::Member member) {
    const std::size_t group = group_of(contact);
    place[static_cast<std::size_t>(contact)] = static_cast<Index>(members[group].size());
    members[group].push_back(member);
    result.groups[group].contacts.push_back(contact);
  };
  for (Index s = 0; s < system.stop_count(); ++s)
    add(sliders + s, {.stop = &system.stops()[static_cast<std::size_t>(s)]});
  for (const Index j : system.law_order()) {
    const Index contact = first_law + j, by = system.normal_contact(j);
    if (by < 0 && !presses[static_cast<std::size_t>(contact)])
      result.single.push_back(j);
    else
      add(contact, {.law = &system.laws()[static_cast<std::size_t>(j)],
                    .place = j,
                    .by = by < 0 ? -1 : place[static_cast<std::size_t>(by)]});
  }
  std::sort(result.single.begin(), result.single.end());
  for (std::size_t g = 0; g < members.size(); ++g)
    result.groups[g].law = std::make_shared<Pressed>(std::move(members[g]));
  for (Index b = 0; b < system.block_count(); ++b) {
    const model::BlockLaw& law = *system.blocks()[static_cast<std::size_t>(b)].law;
    GroupedLaws::Group group{std::make_shared<OneBlock>(law, system.law_count() + b), {}};
    for (Index i = 0; i < law.size(); ++i) group.contacts.push_back(system.row_of_block(b) + i);
    result.groups.push_back(std::move(group));
  }
  return result;
}

}  // namespace rubato::steady
