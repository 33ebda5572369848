#pragma once

#include <rubato/model/mechanism_description.hpp>

#include <algorithm>
#include <span>
#include <string_view>
#include <vector>

// What the builder, the keys of the study file and the results ask about the types of joints, said once.
namespace rubato::model {

struct JointKind {
  const char* name;  ///< in the study file and in results
  JointDescription::Type type;
  bool in_plane, in_space;               ///< where there is such a joint
  int free_coordinates;                  ///< how many numbers say how it stands; of a strut its length
  bool has_radius_of_friction;           ///< its friction is a moment, and needs the radius at which it rubs
  std::vector<const char*> keys;         ///< those that it takes and some other types do not
  std::vector<const char*> needed_keys;  ///< those of them without which there is no such joint

  bool takes(std::string_view key) const { return std::find(keys.begin(), keys.end(), key) != keys.end(); }
};

/// All types, in the order of JointDescription::Type.
std::span<const JointKind> joint_kinds();

const JointKind& joint_kind(JointDescription::Type type);

}  // namespace rubato::model
