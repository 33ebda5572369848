#include <rubato/model/joints/joint_kinds.hpp>

#include <cassert>
#include <initializer_list>

namespace rubato::model {
namespace {

using Keys = std::vector<const char*>;

/// The keys of what may act on the one coordinate that a joint leaves free.
Keys with_laws(std::initializer_list<const char*> own) {
  Keys keys{"damping", "drive", "friction", "lock", "rate", "rest", "stiffness"};
  keys.insert(keys.end(), own);
  return keys;
}

}  // namespace

std::span<const JointKind> joint_kinds() {
  using Type = JointDescription::Type;
  // clang-format off
  static const std::vector<JointKind> kinds{
      // name        type              plane  space  free   radius  keys, those that are needed
      {"rigid",       Type::rigid,       true,  true,  0, false, {}, {}},
      {"revolute",    Type::revolute,    true,  true,  1, true,  with_laws({"angle", "axis", "moment"}), {}},
      {"prismatic",   Type::prismatic,   true,  true,  1, false, with_laws({"axis", "displacement", "force"}), {"axis"}},
      {"distance",    Type::distance,    true,  true,  0, false, {"length"}, {}},
      {"cylindrical", Type::cylindrical, false, true,  2, true,  {"axis", "friction"}, {"axis"}},
      {"spherical",   Type::spherical,   false, true,  3, false, {}, {}},
      {"universal",   Type::universal,   false, true,  2, true,  {"axis", "friction", "second_axis"},
                                                                 {"axis", "second_axis"}},
      {"planar",      Type::planar,      false, true,  3, false, {"axis", "friction"}, {"axis"}},
      {"screw",       Type::screw,       false, true,  1, true,  with_laws({"angle", "axis", "lead", "moment"}),
                                                                 {"axis", "lead"}},
      {"strut",       Type::strut,       true,  true,  1, false, with_laws({"force"}), {}}};
  // clang-format on
  return kinds;
}

const JointKind& joint_kind(JointDescription::Type type) {
  const JointKind& kind = joint_kinds()[static_cast<std::size_t>(type)];
  assert(kind.type == type);
  return kind;
}

}  // namespace rubato::model
