#pragma once

#include <rubato/analysis/run_context.hpp>

#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace rubato::analysis {

/// How many threads an analysis may have.
inline int threads_of(const RunContext& context) {
  const int cores = std::max(1, tbb::info::default_concurrency());
  return context.threads > 0 ? std::min(context.threads, cores) : cores;
}

/// How many pieces are in memory at once.
inline long pieces_at_once(const RunContext& context) { return 4L * threads_of(context); }

/// What is done with the pieces of a long analysis. A piece begins afresh: what it results in depends on it alone.
/// A result has `is_whole` (false: it was interrupted) and `packed()`, itself as a list of numbers for the journal.
template <class Piece, class Result>
struct PieceWork {
  std::function<std::optional<Piece>()> next;  ///< in the order of the rows; empty at the end
  /// A result that the journal has kept. Throws InvalidInput for numbers of something else.
  std::function<Result(const Piece&, const std::vector<double>&)> recall;
  std::function<Result(const Piece&)> solve;  ///< called by several threads at once
  std::function<void(Result&)> write;         ///< called by one thread at a time, in the order of the pieces
};

/// Recalls the pieces that the journal has kept, and solves the others on several threads until all are written or
/// someone asks to stop. What is written has the same bits whatever the number of threads. Whole results are kept in
/// the journal up to the first that is not: what follows a gap would not be found again.
/// @return whether a piece was interrupted
template <class Piece, class Result>
bool work_in_pieces(const PieceWork<Piece, Result>& work, RunContext& context) {
  const long known = context.journal ? context.journal->finished() : 0;
  for (long i = 0; i < known; ++i) {
    const auto piece = work.next();
    if (!piece) break;
    Result result = work.recall(*piece, context.journal->read(i));
    work.write(result);
  }
  bool was_interrupted = false;
  struct Task {
    Piece piece;
    std::optional<Result> result = {};
  };
  using Shared = std::shared_ptr<Task>;
  tbb::task_arena arena(threads_of(context));
  arena.execute([&] {
    tbb::parallel_pipeline(
        static_cast<std::size_t>(pieces_at_once(context)),
        tbb::make_filter<void, Shared>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& flow) -> Shared {
          auto piece = context.stop.load() ? std::nullopt : work.next();
          if (!piece) {
            flow.stop();
            return nullptr;
          }
          return std::make_shared<Task>(Task{std::move(*piece)});
        }) & tbb::make_filter<Shared, Shared>(tbb::filter_mode::parallel, [&](Shared task) {
          task->result = work.solve(task->piece);
          return task;
        }) & tbb::make_filter<Shared, void>(tbb::filter_mode::serial_in_order, [&](const Shared& task) {
          Result& result = *task->result;
          work.write(result);
          if (!result.is_whole) was_interrupted = true;
          if (context.journal && !was_interrupted) context.journal->keep(result.packed());
        }));
  });
  return was_interrupted;
}

/// Counts what is finished over all threads and tells of it, from whichever thread is free to.
class SweepProgress {
 public:
  /// @param points_a_report  1 where a point takes long
  SweepProgress(Progress& progress, long points_a_report) : progress_(progress), points_a_report_(points_a_report) {}
  /// `count` may be negative: points that are solved again.
  void add(long count) {
    const long now = points_.fetch_add(count, std::memory_order_relaxed) + count;
    if (now % points_a_report_ == 0) tell();
  }

 private:
  void tell() {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (lock) progress_.advance(static_cast<double>(points_.load(std::memory_order_relaxed)));
  }
  Progress& progress_;
  long points_a_report_;
  std::atomic<long> points_{0};
  std::mutex mutex_;
};

}  // namespace rubato::analysis
