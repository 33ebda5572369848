#pragma once

namespace rubato::model {

/// Of a law that steady responses and damper curves do not carry, beside model::Law or model::BlockLaw: because no
/// motion of it repeats, or because they do not know it. Analyses refuse it by name.
class OnlyTransient {
 public:
  virtual ~OnlyTransient() = default;

  /// Why, and what to take instead, as the end of a message that begins with the name of the part: "wears, so that no
  /// motion repeats; run a transient".
  virtual const char* why_no_steady_response() const = 0;
};

/// The same of any law; empty where steady responses take it.
template <class AnyLaw>
const char* why_no_steady_response(const AnyLaw& law) {
  const auto* only = dynamic_cast<const OnlyTransient*>(&law);
  return only ? only->why_no_steady_response() : "";
}

}  // namespace rubato::model
