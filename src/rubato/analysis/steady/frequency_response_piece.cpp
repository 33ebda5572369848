#include <rubato/analysis/steady/frequency_response_piece.hpp>

#include <rubato/core/stopping.hpp>
#include <rubato/steady/marching/quasi_periodic.hpp>

#include <algorithm>
#include <limits>

namespace rubato::analysis {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void SweepCounts::add(const SweepCounts& other) {
  StatusCounts::add(other);
  iterations += other.iterations;
}

std::vector<double> PieceResult::packed() const {
  std::vector<double> values{static_cast<double>(piece.first_line), static_cast<double>(piece.lines),
                             static_cast<double>(piece.first_step), static_cast<double>(piece.steps)};
  counts.pack(values);
  values.push_back(counts.iterations);
  for (const auto* rows : {&main, &linear, &waveforms}) {
    values.push_back(static_cast<double>(rows->size()));
    values.insert(values.end(), rows->begin(), rows->end());
  }
  return values;
}

PieceResult PieceResult::unpacked(const SweepPiece& piece, const SweepTables& tables, std::span<const double> values) {
  PieceResult result;
  result.piece = piece;
  PackedNumbers numbers(values);
  for (const double place : {static_cast<double>(piece.first_line), static_cast<double>(piece.lines),
                             static_cast<double>(piece.first_step), static_cast<double>(piece.steps)})
    numbers.expect(place);
  result.counts.unpack(numbers);
  result.counts.iterations = numbers.next();
  result.main = numbers.rows(tables.main.width());
  result.linear = numbers.rows(tables.linear.width());
  result.waveforms = numbers.rows(tables.waveforms.width());
  numbers.expect_end();
  return result;
}

PieceSolver::PieceSolver(const FrequencyResponsePlan& plan, const StudyInput& input,
                         const steady::SteadySolvers& solvers, const SweepTables& tables, SweepProgress& progress,
                         const std::atomic<bool>& stop)
    : plan_(plan), input_(input), make_(solvers), tables_(tables), progress_(progress), stop_(stop) {}

PieceSolver::Lane& PieceSolver::lane(std::size_t index) {
  while (lanes_.size() <= index) {
    Lane lane;
    lane.drive =
        std::make_unique<ParametricExcitation>(input_, plan_.dependence, plan_.sweep.places(), plan_.excitation);
    if (plan_.may_lack_period(input_)) lane.drive->allow_no_period();
    lane.values.resize(plan_.sweep.names().size());
    lanes_.push_back(std::move(lane));
  }
  excitations_.resize(lanes_.size());
  responses_.resize(lanes_.size());
  return lanes_[index];
}

double PieceSolver::point_value(std::size_t step) const {
  return plan_.excitation_factor * plan_.frequencies[plan_.steps[step].frequency];
}

double PieceSolver::point_number(long line, std::size_t step) const {
  return static_cast<double>(line) * static_cast<double>(plan_.steps.size()) + static_cast<double>(step);
}

RowPlace PieceSolver::place_of(const Lane& lane, std::size_t step) const {
  return {lane.values, plan_.steps[step].is_downwards, plan_.frequencies[plan_.steps[step].frequency]};
}

/// Builds the structure of a lane's parameters unless it is there.
void PieceSolver::require_structure(Lane& lane, double point) {
  std::vector<double> wanted;
  for (std::size_t i = 0; i < lane.values.size(); ++i)
    if (plan_.is_structural[i]) wanted.push_back(lane.values[i]);
  if (plan_.structure_follows_point) wanted.push_back(point);
  if (model_ && wanted == structure_values_) return;
  solver_.reset();
  free_.reset();
  stuck_.reset();
  model_.reset();
  model_ =
      std::make_unique<SteadyModel>(build_steady_model(input_.study, lane.drive->parameters_at(lane.values, point)));
  solver_ = make_.response(model_->system(), model_->request(plan_.observed, plan_.request));
  structure_values_ = std::move(wanted);
}

void PieceSolver::take_drive(Lane& lane, double point) {
  if (model_->about) require_swinging_loads(input_.study.model, lane.drive->parameters_at(lane.values, point));
  lane.drive->take_line(lane.values, model_->assembled);
}

/// What is solved next does not depend on what was solved before.
void PieceSolver::forget() {
  for (const auto* solver : {&solver_, &free_, &stuck_})
    if (*solver) (*solver)->forget();
}

void PieceSolver::take_line(Lane& lane, long line) {
  plan_.sweep.values(line, lane.values);
  std::vector<bool> others = plan_.is_linear;
  others.flip();
  lane.has_limits = plan_.sweep.is_first_but_for(line, others);
}

void PieceSolver::solve_linear(const RowPlace& place, const system::Excitation& excitation, PieceResult& result) {
  if (!free_) {
    steady::SteadyRequest request = model_->request(plan_.observed, plan_.request);
    request.rates = false;
    request.harmonics = {1};
    free_ = make_.free(model_->system(), request);
    stuck_ = make_.stuck(model_->system(), request);
  }
  free_->solve(excitation, steady::SteadyStart::unloaded, free_response_);
  stuck_->solve(excitation, steady::SteadyStart::unloaded, stuck_response_);
  tables_.linear.add(place, free_response_, stuck_response_, result.linear);
}

/// What lies between the samples is missed by less than a thousandth of the amplitude of the first orders.
AboutRest::Excursion PieceSolver::excursion_of_last() const {
  constexpr int samples = 64;
  return model_->about->excursion(solver_->waveform(samples).position);
}

/// Loads whose frequencies have no common fundamental: the system is marched from its start until it settles.
void PieceSolver::march_without_period(Lane& lane, double point, steady::SteadyResponse& response) {
  const system::AssembledModel here = build_structure(input_.study, lane.drive->parameters_at(lane.values, point));
  response = steady::solve_quasi_periodic(here.system, steady::marching_options(plan_.route), plan_.request,
                                          lane.drive->window());
  response.harmonics.setConstant(static_cast<Index>(plan_.observed.size()),
                                 static_cast<Index>(plan_.request.harmonics.size()), nothing);
}

void PieceSolver::finish_point(const Lane& lane, long line, std::size_t step, const system::Excitation& excitation,
                               steady::SteadyResponse& response, PieceResult& result) {
  const RowPlace place = place_of(lane, step);
  // Both directions have the same limits.
  if (lane.has_limits && step < plan_.frequencies.size() && lane.drive->has_period())
    solve_linear(place, excitation, result);
  const bool moves_far =
      model_->about && response.amplitude.allFinite() && !model_->about->told(excursion_of_last()).empty();
  if (model_->about) model_->about->place(plan_.observed, response);
  tables_.main.add(place, excitation.angular_frequency, response, result.main);
  SweepCounts& counts = result.counts;
  const double number = point_number(line, step);
  counts.of(point_status(response.status)).note(number);
  counts.iterations += response.iterations;
  if (moves_far) counts.excursions.note(number);
  if (!lane.drive->negative_loads().empty()) counts.negative_loads.note(number);
  progress_.add(1);
}

void PieceSolver::solve_line(const SweepPiece& piece, PieceResult& result) {
  Lane& mine = lane(0);
  system::Excitation& excitation = excitations_[0];
  steady::SteadyResponse& response = responses_[0];
  take_line(mine, piece.first_line);
  bool is_new_line = true;
  for (std::size_t step = piece.first_step; step < piece.first_step + piece.steps; ++step) {
    if (stop_.load(std::memory_order_relaxed)) {
      result.is_whole = false;
      return;
    }
    const double point = point_value(step);
    try {
      if (is_new_line || plan_.structure_follows_point) {
        require_structure(mine, point);
        if (is_new_line) forget();
        take_drive(mine, point);
        is_new_line = false;
      }
      mine.drive->take_point(point, excitation);
      if (mine.drive->has_period())
        solver_->solve(excitation, plan_.start, response);
      else
        march_without_period(mine, point, response);
    } catch (const InvalidInput&) {
      tables_.main.add_impossible(place_of(mine, step), result.main);
      result.counts.of(PointStatus::impossible).note(point_number(piece.first_line, step));
      progress_.add(1);
      continue;
    }
    finish_point(mine, piece.first_line, step, excitation, response, result);
    if (plan_.waveform_points > 0 && plan_.waveform_at[plan_.steps[step].frequency]) {
      steady::Waveform waveform = solver_->waveform(plan_.waveform_points);
      if (model_->about) model_->about->place(waveform);
      tables_.waveforms.add(place_of(mine, step), waveform, result.waveforms);
    }
  }
}

// Returns false, with nothing in `result`, where one of the lines has a point that cannot be.
bool PieceSolver::solve_lanes(const SweepPiece& piece, PieceResult& result) {
  const auto count = static_cast<std::size_t>(piece.lines);
  (void)lane(count - 1);
  for (std::size_t i = 0; i < count; ++i) {
    lanes_[i].result = {};
    take_line(lanes_[i], piece.first_line + static_cast<long>(i));
  }
  try {
    require_structure(lanes_[0], point_value(piece.first_step));
    forget();
    for (std::size_t i = 0; i < count; ++i) lanes_[i].drive->take_line(lanes_[i].values, model_->assembled);
    for (std::size_t step = piece.first_step; step < piece.first_step + piece.steps; ++step) {
      if (stop_.load(std::memory_order_relaxed)) {
        result.is_whole = false;
        break;
      }
      for (std::size_t i = 0; i < count; ++i) {
        lanes_[i].drive->take_point(point_value(step), excitations_[i]);
        if (!lanes_[i].drive->has_period()) throw InvalidInput("points without a period are marched one by one");
      }
      solver_->solve_lanes({excitations_.data(), count}, plan_.start, {responses_.data(), count});
      for (std::size_t i = 0; i < count; ++i)
        finish_point(lanes_[i], piece.first_line + static_cast<long>(i), step, excitations_[i], responses_[i],
                     lanes_[i].result);
    }
  } catch (const Stopped&) {
    result.is_whole = false;
  } catch (const InvalidInput&) {
    double points = 0.0;
    for (std::size_t i = 0; i < count; ++i) points += lanes_[i].result.counts.total();
    progress_.add(-static_cast<long>(points));
    return false;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const PieceResult& part = lanes_[i].result;
    result.main.insert(result.main.end(), part.main.begin(), part.main.end());
    result.linear.insert(result.linear.end(), part.linear.begin(), part.linear.end());
    result.counts.add(part.counts);
  }
  return true;
}

PieceResult PieceSolver::solve(const SweepPiece& piece) {
  const StopScope scope(stop_);
  PieceResult result;
  result.piece = piece;
  try {
    if (piece.lines > 1 && solve_lanes(piece, result)) return result;
    for (int i = 0; i < piece.lines && result.is_whole; ++i)
      solve_line({piece.first_line + i, 1, piece.first_step, piece.steps}, result);
  } catch (const Stopped&) {
    result.is_whole = false;
  }
  return result;
}

int PieceSolver::lanes() {
  Lane& mine = lane(0);
  take_line(mine, 0);
  try {
    require_structure(mine, point_value(0));
  } catch (const InvalidInput&) {
    return 1;
  }
  return model_->about ? 1 : solver_->lanes();
}

/// The first lane with one point of a line.
PieceSolver::Lane& PieceSolver::take_point(long line, std::size_t step) {
  Lane& mine = lane(0);
  take_line(mine, line);
  require_structure(mine, point_value(step));
  take_drive(mine, point_value(step));
  mine.drive->take_point(point_value(step), excitations_[0]);
  return mine;
}

std::string PieceSolver::reason(long line, std::size_t step) {
  try {
    (void)take_point(line, step);
    solver_->forget();
    solver_->solve(excitations_[0], plan_.start, responses_[0]);
  } catch (const InvalidInput& fault) {
    return fault.where().file.empty() ? fault.message() : fault.what();
  }
  return {};
}

Vector PieceSolver::drift(long line, std::size_t step) {
  (void)take_point(line, step);
  solver_->forget();
  solver_->solve(excitations_[0], plan_.start, responses_[0]);
  return responses_[0].drift;
}

std::string PieceSolver::excursion(long line, std::size_t step) {
  (void)take_point(line, step);
  solver_->forget();
  solver_->solve(excitations_[0], plan_.start, responses_[0]);
  return model_->about ? model_->about->told(excursion_of_last()) : std::string();
}

std::vector<ParametricExcitation::NegativeLoad> PieceSolver::negative_loads(long line, std::size_t step) {
  return take_point(line, step).drive->negative_loads();
}

}  // namespace rubato::analysis
