#pragma once

#include <fmt/format.h>

#include <string>

// Studies of two masses on springs as a structure and as a mechanism, and of how they are marched.
namespace rubato::testing {

inline const std::string swinging =
    "force = [{ on = \"X\", expression = \"4*sin(1.3*t) + 0.5\" }, { on = \"Z\", expression = \"3*cos(2*t)\" }]\n";

/// Two masses on springs, one that slides along x and one that presses, as coordinates or as the x of two bodies.
struct TwoMasses {
  std::string analysis, parts;  ///< with X, Z for the two
  std::string forces = swinging;

  std::string structure() const {
    return "coordinate = [{ name = \"x\", mass = 1.0 }, { name = \"z\", mass = 1.5 }]\n" + rest("x", "z");
  }
  std::string mechanism() const {
    return "body = [{ name = \"x\", mass = 1.0, inertia = 1.0, position = [0.0, 0.0] }, "
           "{ name = \"z\", mass = 1.5, inertia = 1.0, position = [0.0, 1.0] }]\n" +
           rest("x.x", "z.x");
  }

 private:
  std::string rest(const std::string& x, const std::string& z) const {
    const std::string text =
        "spring = [{ between = [\"X\", \"ground\"], stiffness = 3.5 }, "
        "{ between = [\"Z\", \"ground\"], stiffness = 2.0 }]\n"
        "damper = [{ between = [\"X\", \"ground\"], damping = 0.1 }]\n" +
        forces + parts;
    std::string result;
    for (const char c : text) result += c == 'X' ? x : c == 'Z' ? z : std::string(1, c);
    return result + analysis;
  }
};

inline const std::string equal_steps =
    "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nmethod = \"average_acceleration\"\nstep = 0.01\n"
    "duration = 12.0\n";
/// Of mechanisms with joints, whose multipliers need damping.
inline const std::string damped_steps =
    "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nmethod = \"damped_newmark\"\nstep = 0.01\n"
    "duration = 12.0\n";
inline std::string automatic(double tolerance, const std::string& more = "") {
  return fmt::format(
      "[[analysis]]\nname = \"run\"\ntype = \"transient\"\nstep = {{ tolerance = {}{} }}\nduration = "
      "12.0\noutput = {{ interval = 0.1 }}\n",
      tolerance, more);
}

}  // namespace rubato::testing
