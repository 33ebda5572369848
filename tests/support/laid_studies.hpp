#pragma once

#include <rubato/core/error.hpp>

#include <support/mechanism_study.hpp>
#include <support/tilted_plane.hpp>

#include <fmt/format.h>

#include <cmath>
#include <ostream>
#include <string>

// Studies of the plane, and the same ones laid into a plane that lies askew in space.
namespace rubato::testing {

/// Where a study lies, and how its places are written there.
struct Laid {
  bool in_space = false;
  TiltedPlane tilted;

  std::string point(double x, double y) const { return in_space ? tilted.point(x, y) : pair(x, y); }
  std::string direction(double x, double y) const { return in_space ? tilted.direction(x, y) : pair(x, y); }
  /// Keys of a body of 2 kg with its centre of mass there; in space about the other two axes something smaller.
  std::string body(double inertia, double x, double y) const {
    return fmt::format("mass = 2.0\ninertia = {}\nposition = {}\n",
                       in_space ? fmt::format("[{:.17g}, {:.17g}, {}]", 0.75 * inertia, 0.875 * inertia, inertia)
                                : fmt::format("{}", inertia),
                       point(x, y)) +
           (in_space ? "rotation = " + tilted.rotation() + "\n" : "");
  }
  /// The key of a hinge across the plane.
  std::string hinge_axis() const { return in_space ? "axis = " + tilted.normal() + "\n" : ""; }
  std::string gravity() const { return "[gravity]\nacceleration = " + direction(0.0, -9.81) + "\n"; }

 private:
  static std::string pair(double x, double y) { return fmt::format("[{:.17g}, {:.17g}]", x, y); }
};

inline const Laid in_plane{false, {}}, in_space{true, {}};

inline void PrintTo(const Laid& laid, std::ostream* out) { *out << (laid.in_space ? "in space" : "in the plane"); }

/// For INSTANTIATE_TEST_SUITE_P.
template <class Info>
std::string name_of_laid(const Info& info) {
  return info.param.in_space ? "in_space" : "in_the_plane";
}

inline std::string transient(const std::string& step, double duration) {
  return fmt::format("[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = {}\nduration = {}\n", step, duration);
}

/// A block of 2 kg in a straight guide, "guide", which rises by an angle.
/// @param speed  of the block up the guide
inline std::string block_in_guide(const Laid& laid, double rise, const std::string& joint_keys, double speed = 0.0) {
  const double c = std::cos(rise), s = std::sin(rise);
  return "[[body]]\nname = \"block\"\n" + laid.body(0.1, 0.0, 0.0) +
         "velocity = " + laid.direction(speed * c, speed * s) +
         "\n[[joint]]\nname = \"guide\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"block\"]\nat = " +
         laid.point(0.0, 0.0) + "\naxis = " + laid.direction(c, s) + "\n" + joint_keys + "\n";
}

/// A bar of 0.6 kg m2 about its pin, "pin", 0.5 m from its centre of mass.
inline std::string bar_on_pin(const Laid& laid, const std::string& joint_keys) {
  return "[[body]]\nname = \"bar\"\n" + laid.body(0.1, 0.5, 0.0) +
         "[[joint]]\nname = \"pin\"\ntype = \"revolute\"\nbetween = [\"ground\", \"bar\"]\nat = " +
         laid.point(0.0, 0.0) + "\n" + laid.hinge_axis() + joint_keys + "\n";
}

/// A rocket of 2 kg and 0.4 kg m2 with a thrust of 5 N along its own x axis, which follows it.
inline std::string rocket(const Laid& laid, double spin, const std::string& force_keys = "following = true\n") {
  return "[[body]]\nname = \"rocket\"\n" + laid.body(0.4, 0.0, 0.0) +
         fmt::format("angular_velocity = {}\n",
                     laid.in_space ? fmt::format("[0.0, 0.0, {}]", spin) : fmt::format("{}", spin)) +
         "[[force]]\non = \"rocket.x\"\nexpression = \"5\"\n" + force_keys + transient("0.0005", 2.0);
}

/// What is said of a study: why it is refused, or failed.
inline std::string verdict(const std::string& text) {
  try {
    const MechanismStudy ran(text);
    return ran.report.status == analysis::RunStatus::done ? "no complaint" : ran.report.message;
  } catch (const InvalidInput& fault) {
    return fault.what();
  }
}

}  // namespace rubato::testing
