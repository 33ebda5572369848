#pragma once

#include <atomic>
#include <exception>

namespace rubato {

/// A long computation was asked to stop, and has. What it had not finished is lost; what calls it again begins afresh.
class Stopped : public std::exception {
 public:
  const char* what() const noexcept override { return "stopped"; }
};

/// While it lives, computations of this thread hear of a flag that asks them to stop. Scopes of one thread may nest:
/// the innermost counts. Threads that share the work each need one.
///
/// Why not an argument: iterations that take minutes lie deep (a factorisation in a Newton step in a march in a
/// search), below interfaces that have no other reason to know of it.
class StopScope {
 public:
  explicit StopScope(const std::atomic<bool>& flag) noexcept;
  ~StopScope();
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;

 private:
  const std::atomic<bool>* outer_;
};

/// To be called once in each iteration that may take milliseconds or more, where the objects may be left as they are.
/// Throws Stopped where this thread's scope says so; does nothing in a thread without one.
void stop_if_asked();

}  // namespace rubato
