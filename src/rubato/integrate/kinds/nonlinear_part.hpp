#pragma once

#include <string>

namespace rubato::integrate {

/// A part of a model that is not linear, by what analyses ask of it.
struct NonlinearPart {
  enum class Family {
    slider,
    stop,
    law,             ///< of any kind in model/laws
    contact,         ///< of friction and separation, a law of several numbers
    pressed_slider,  ///< whose normal load follows from t or from the force of another part
    joint_friction,
    lock
  };
  Family family = Family::law;
  std::string kind;  ///< of a law: its table in the study file
  std::string name;
  bool depends_on_time = false;
  bool is_spring = false;                   ///< of a stop or lock of a mechanism: without damping
  const char* why_no_steady_response = "";  ///< of a law that only transients carry, as model::OnlyTransient says it
};

}  // namespace rubato::integrate
