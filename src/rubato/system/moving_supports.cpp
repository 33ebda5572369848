#include <rubato/system/moving_supports.hpp>

#include <utility>

namespace rubato::system {

MovingSupports::MovingSupports(Parts parts) : parts_(std::move(parts)) {}

void MovingSupports::extend(double t, model::Side side, const Vector& free, Vector& all, int derivative) const {
  all.resize(free.size() + size());
  all.head(free.size()) = free;
  for (Index i = 0; i < size(); ++i) {
    const model::Prescribed& motion = parts_.motions[static_cast<std::size_t>(i)];
    const model::TimeLaw& law = derivative == 0   ? motion.displacement
                                : derivative == 1 ? motion.velocity
                                                  : motion.acceleration;
    all[free.size() + i] = model::value(law, t, side);
  }
}

void MovingSupports::reaction(double t, model::Side side, const Vector& q, const Vector& v, const Vector& a,
                              Vector& force) const {
  Vector load(size());
  parts_.loads.evaluate(t, load, side);
  force = parts_.mass * a + parts_.damping * v + parts_.stiffness * q - load;
}

// Half of x^T A x counts the coupling of free and given ones twice, and those given among themselves once.
double MovingSupports::kinetic(const Vector& v) const {
  const Vector own = v.tail(size());
  return own.dot(parts_.mass * v) - 0.5 * own.dot(parts_.own_mass * own);
}

double MovingSupports::strain(const Vector& q) const {
  const Vector own = q.tail(size());
  return own.dot(parts_.stiffness * q) - 0.5 * own.dot(parts_.own_stiffness * own);
}

}  // namespace rubato::system
