#pragma once

#include <rubato/results/sink.hpp>

namespace rubato::test {

/// An analysis "shaken" of an angle of two beams in the plane: node `a` clamped in the origin, `b` 1 m above it, `c` 1
/// m to the right of `b`. Over 11 rows in a second `b` and `c` go 0.1 m sin(pi t) to the right
/// and turn.
void add_scene(results::Sink& sink);

/// An analysis "swinging" of modes of a mechanism that is not stable: a body at (1, 0), whose axes are turned, carried
/// by a pin in the origin. In the first it swings about the pin; in the second, which grows, it goes around in a
/// circle.
void add_mechanism_modes(results::Sink& sink);

/// An analysis "pendulum" of a mechanism: a box "arm", 1 m long, that swings about the joint "hinge pin" in the origin
/// from the right to below it and back, with the force of a circular motion in the joint, whose stop holds from 0.4 s
/// to 0.6 s. Over 101 rows in a second; "arm:1" is a node within a beam that does not move.
void add_mechanism(results::Sink& sink);

}  // namespace rubato::test
