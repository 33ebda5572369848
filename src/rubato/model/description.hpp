#pragma once

#include <rubato/model/laws/law_kind.hpp>
#include <rubato/model/mechanism_description.hpp>
#include <rubato/model/quantity.hpp>
#include <rubato/model/structure_description.hpp>
#include <rubato/model/time_law_description.hpp>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

// A study as the user wrote it: plain values with the place of each, nothing evaluated. Every number may be a formula
// of the parameters. io/read_study fills it from a file; a C++ program may fill it by hand.
namespace rubato::model {

struct ParameterDescription {
  std::string name;
  Quantity value;  ///< may use the parameters before it
  Location where;
};

struct CoordinateDescription {
  std::string name;
  Quantity mass;      ///< [kg]
  Quantity position;  ///< at the start [m]
  Quantity velocity;  ///< at the start [m/s]
  Location where;
};

/// The names of the two coordinates that an element joins; "ground" may be one of them.
using Between = std::array<std::string, 2>;

struct SpringDescription {
  Between between;
  std::array<Location, 2> between_where;
  Quantity stiffness;  ///< [N/m]
  Location where;
};

struct DamperDescription {
  Between between;
  std::array<Location, 2> between_where;
  Quantity damping;  ///< [N s/m]
  Location where;
};

/// C = sum over modes of M phi (2 ratio omega) phi^T M with phi^T M phi = 1: modes of the model without sliders.
struct ModalDamping {
  std::vector<Quantity> ratios;   ///< [-]; one for all modes, or one a mode
  std::optional<Quantity> modes;  ///< only the lowest so many are damped
  Location where;
};

/// C = mass M + stiffness K, with mass in [1/s] and stiffness in [s].
struct RayleighDamping {
  Quantity mass;
  Quantity stiffness;
  Location where;
};

/// What is added to the dashpots.
using DampingDescription = std::variant<std::monostate, ModalDamping, RayleighDamping>;

/// Jenkins element: a spring in series with a Coulomb limit.
struct SliderDescription {
  std::string name;
  Between between;
  std::array<Location, 2> between_where;
  std::string joint;  ///< of mechanisms, instead: it rubs on the coordinate that this joint leaves free
  Location joint_where;
  Quantity stiffness;             ///< kT [N/m]
  Quantity friction_coefficient;  ///< mu [-]
  Quantity normal_load;           ///< N [N]; may use t: what presses is its positive part
  std::string normal_law;         ///< instead: a stop or a law, whose force presses; empty: normal_load counts
  Location normal_law_where;
  Location where;

  /// Whether N does not stay the same: the slider is a law then, as others are (model/laws/jenkins.hpp).
  bool is_law() const;
};

/// One-sided stop: pushes its ends apart where u = x_first - x_second exceeds the gap.
struct StopDescription {
  std::string name;
  Between between;
  std::array<Location, 2> between_where;
  std::string joint;  ///< of mechanisms, instead: u is the coordinate that this joint leaves free
  Location joint_where;
  Quantity gap;        ///< [m]; negative: compressed at u = 0
  Quantity stiffness;  ///< [N/m]
  Quantity damping;    ///< [N s/m]
  Location where;
};

/// Friction along a plane, under a spring across it that only pushes.
struct ContactDescription {
  using Shares = std::vector<std::pair<std::string, Quantity>>;  ///< coordinates and their weights

  std::string name;
  Between between;  ///< two nodes, or one and the ground; empty: the shares count
  std::array<Location, 2> between_where;
  std::vector<Quantity> normal_direction;      ///< from the second end to the first, of any length
  std::vector<Quantity> tangential_direction;  ///< in space: the first of two; empty: the axis least along the normal
  Location normal_direction_where, tangential_direction_where;
  std::vector<Quantity> at, to;  ///< of mechanisms: the point of the first part, and one of the plane [m]
  Location at_where, to_where;
  std::optional<Quantity> radius;  ///< of mechanisms: of a disk or sphere about `at` [m]
  std::vector<Shares> tangential;  ///< one or two displacements along the plane
  Shares normal;                   ///< that across it, positive where the ends come nearer
  Location tangential_where, normal_where;
  std::optional<Quantity> tangential_stiffness;  ///< kT [N/m]
  Quantity normal_stiffness;                     ///< kn [N/m]
  std::optional<Quantity> friction_coefficient;  ///< mu [-]; none: nothing rubs
  std::optional<Quantity> gap;                   ///< [m]
  std::optional<Quantity> normal_load;           ///< N at d = 0 [N], instead of the gap
  std::optional<Quantity> normal_damping;        ///< cn while closed [N s/m]
  std::optional<Quantity> sliding_velocity;      ///< V of a belt or disc [m/s]: V t is added to the first u
  Location where;
};

struct ForceDescription {
  std::string on;          ///< a coordinate
  TimeLawDescription law;  ///< [N]
  bool follows = false;    ///< of mechanisms: along an axis of the node or body, which turns with it
  std::vector<Quantity>
      at;  ///< of a force that follows: its point in the configuration given [m]; the node unless given
  Location where, follows_where, at_where;
};

/// A force per length that is the same all along a beam or truss, however many elements divide it.
struct DistributedForceDescription {
  std::string on;                   ///< the name of a beam or truss
  std::vector<Quantity> direction;  ///< along x and y; along x, y and z in space [-]; its length multiplies the law
  TimeLawDescription law;           ///< [N/m]
  Location where;
};

/// A force or, with nodes, a displacement that is held in the static start and released in the transient.
struct HeldDescription {
  std::string on;  ///< a coordinate
  Quantity value;  ///< [N] or [m]; [N m] or [rad] of a rotation
  Location where;
};

/// A coordinate that moves with time as a law says, whatever that takes; in a static state it stands where it starts.
struct PrescribedDescription {
  std::string on;          ///< a coordinate
  TimeLawDescription law;  ///< [m] or [rad]
  Location where;
};

/// Acts on elements and masses of nodes, in their translations.
struct GravityDescription {
  std::vector<Quantity> acceleration;  ///< along x and y; along x, y and z in space [m/s2]
  Location where;
};

/// The ground moves in the direction of `direction`; coordinates are then relative to it, and the load is
/// -M direction * acceleration(t).
struct BaseMotionDescription {
  enum class Of { acceleration, velocity, displacement };  ///< the latter two for harmonic laws only
  TimeLawDescription law;                                  ///< [m/s2], [m/s] or [m]
  Of of = Of::acceleration;
  std::vector<std::pair<std::string, Quantity>> direction;  ///< by coordinate, [-]; empty: 1 for every coordinate
  Location where;
};

/// Matrices read from Matrix Market files instead of coordinates, springs and dashpots, in triplets (zero-based).
struct MatrixDescription {
  struct Entry {
    int row = 0, column = 0;
    double value = 0.0;
  };
  std::string file;
  int size = 0;
  std::vector<Entry> entries;  ///< both triangles
  Location where;
};

struct MatricesDescription {
  MatrixDescription mass;                                            ///< [kg]
  std::optional<MatrixDescription> damping;                          ///< [N s/m]
  MatrixDescription stiffness;                                       ///< [N/m]
  std::vector<std::string> names;                                    ///< of the coordinates; "1", "2", ... unless given
  std::vector<Location> names_where;                                 ///< of each name, or empty
  std::vector<std::pair<std::string, Quantity>> position, velocity;  ///< at the start, where not zero
  Location where;
};

struct FiniteElements;

struct ModelDescription {
  std::vector<CoordinateDescription> coordinates;
  std::optional<MatricesDescription> matrices;
  std::shared_ptr<const FiniteElements> finite_elements;  ///< of [model]; null: none
  StructureDescription structure;
  std::vector<BodyDescription> bodies;
  std::vector<JointDescription> joints;
  std::vector<BushingDescription> bushings;
  std::vector<GearDescription> gears;
  std::vector<SpringDescription> springs;
  std::vector<DamperDescription> dampers;
  DampingDescription damping;
  std::vector<SliderDescription> sliders;
  std::vector<StopDescription> stops;
  std::vector<LawDescription> laws;
  std::vector<ContactDescription> contacts;
  std::vector<ForceDescription> forces;
  std::vector<DistributedForceDescription> distributed_forces;
  std::vector<HeldDescription> held_forces, displacements;
  std::vector<PrescribedDescription> prescribed;
  std::optional<GravityDescription> gravity;
  std::optional<BaseMotionDescription> base_motion;
  Location where;
};

/// A method by its name, with the parameters that it takes (`alpha`, `beta`, `gamma`, `rho_inf`, `theta`).
struct MethodDescription {
  std::string name = "generalized_alpha";
  std::vector<std::pair<std::string, Quantity>> parameters;
  Location where;
};

/// A coordinate, or the difference of two ("blade1 - damper").
struct ObservationDescription {
  std::string first;
  std::string second;  ///< empty: `first` alone
  Location where;
};

struct OutputDescription {
  enum class Kind { every_step, every, interval, times };
  Kind kind = Kind::every_step;
  int every = 1;                ///< steps
  Quantity interval;            ///< [s]
  std::vector<Quantity> times;  ///< [s]
  Location where;
  bool shows_every_step = false;  ///< in a table besides, for the key numbers of a sample; no key asks for it
};

/// The state of equilibrium under the loads just before t = 0, held forces and held displacements.
/// Of which beams section forces are kept.
struct SectionForcesDescription {
  bool of_all = false;
  std::vector<ObservationDescription> beams;  ///< by their names
  Location where;

  bool is_wanted() const { return of_all || !beams.empty(); }
};

/// Values in order: a list, or so many points from one value to another, both ends included.
struct ValuesDescription {
  std::vector<Quantity> list;  ///< empty: the range below
  Quantity from, to, points;
  bool logarithmic = false;  ///< equal ratios between neighbours
  Location where;
};

/// Every combination of values; the last parameter varies fastest.
struct GridSweepDescription {
  std::vector<std::pair<std::string, ValuesDescription>> parameters;  ///< in the order of the file
};

/// A list of cases, a row each, from a CSV file (already read) whose header names the parameters.
struct CaseSweepDescription {
  std::string file;
  std::vector<std::string> names;
  std::vector<double> values;  ///< row by row, [cases * names]
  Location where;
};

/// Where the samples of a parameter come from: normal (mean, deviation), uniform (from, to), or lognormal (median,
/// deviation of the logarithm).
struct DistributionDescription {
  enum class Kind { normal, uniform, lognormal };
  std::string parameter;
  Kind kind = Kind::normal;
  Quantity first, second;
  Location where;
};

struct RandomSweepDescription {
  enum class Sampling { random, latin_hypercube, sobol };
  Quantity samples;
  long seed = 1;
  Sampling sampling = Sampling::latin_hypercube;
  std::vector<DistributionDescription> parameters;  ///< in the order of the file
  Location where;
};

/// std::monostate: the parameters as they are.
using SweepDescription =
    std::variant<std::monostate, GridSweepDescription, CaseSweepDescription, RandomSweepDescription>;

/// An analysis that is repeated over samples of parameters, where it has no sweep of its own.
struct SweptDescription {
  enum class SpeedUnit { rad_per_second, hertz, rpm };

  SweepDescription sweep;  ///< std::monostate: it is not repeated
  Location where;
  bool keeps_samples = false;           ///< the table of each sample, besides its key numbers
  std::vector<Quantity> engine_orders;  ///< of modes: lines across the natural frequencies over a speed
  std::string speed;                    ///< the parameter that is the speed; empty: the only one that is swept
  Location engine_orders_where, speed_where;
  SpeedUnit speed_unit = SpeedUnit::rad_per_second;

  bool is_wanted() const { return sweep.index() != 0; }
};

struct StaticDescription {
  std::optional<std::vector<ObservationDescription>> observe;        ///< all coordinates unless given
  std::optional<std::vector<ObservationDescription>> displacements;  ///< which are held; all unless given
  bool without_friction = false;  ///< of sliders and contacts; else friction grows with the loads
  SectionForcesDescription section_forces;
  SweptDescription swept;
};

/// A step that chooses itself: step = { tolerance = ... }.
struct StepDescription {
  Quantity tolerance;      ///< [-]
  std::string controller;  ///< "pi" unless given, "cardona_cassano", "fixed"
  std::string estimator;   ///< "local_error", "inertia_jump", "embedded"; what suits method and controller unless given
  std::optional<Quantity> first, smallest, largest;  ///< [s]
  std::optional<bool> locate_events;  ///< end steps where contacts change their state; only stops unless given
  std::optional<Quantity> reference;  ///< l of inertia_jump [m sqrt(kg)]
  bool reference_is_initial = false;  ///< l = |q0|_M even where the model has a value of its own
  bool as_printed = false;            ///< inertia_jump with the misprint of its source
  bool rebuild = true;                ///< the auxiliary acceleration when the step changes
  Location where;
};

struct TransientDescription {
  std::optional<StaticDescription> initial;  ///< starts from equilibrium; the `observe` in it is not used
  MethodDescription method;
  std::optional<Quantity> step;                   ///< [s]; not for `exact`
  std::optional<StepDescription> automatic_step;  ///< instead of `step`
  Quantity duration;                              ///< [s]
  OutputDescription output;
  std::optional<std::vector<ObservationDescription>> observe;  ///< all coordinates unless given
  SectionForcesDescription section_forces;
  bool energy = true;  ///< keep the energy ledger
  bool allow_unstable = false;
  bool project_velocities = false;  ///< of mechanisms: removes what their constraints forbid after each step
  Location project_velocities_where;
  SweptDescription swept;
};

struct MethodStudyDescription {
  std::vector<MethodDescription> methods;  ///< all that apply unless given
  Quantity step;                           ///< [s], of the table of errors
  Quantity duration;                       ///< [s]
  std::vector<Quantity> ladder;            ///< steps of the figure error against step; a default ladder unless given
  std::optional<ObservationDescription> observe;  ///< the first coordinate unless given
  bool as_printed = false;                        ///< also the conventions of the thesis's tables
};

/// Points whose time histories are kept.
struct WaveformsDescription {
  ValuesDescription at;  ///< the nearest frequencies of the response, in its unit
  Quantity points = 128.0;
  Location where;
};

struct FrequencyResponseDescription {
  enum class Route { periodic, harmonic_balance, time_marching };
  enum class Start { unloaded, previous, rest };  ///< what a slider that never slips remembers
  enum class Direction { up, down, both };

  ValuesDescription frequencies;  ///< [rad/s], or [Hz]
  bool frequencies_in_hertz = false;
  std::string excitation;  ///< the parameter that takes them; empty: the one that the forces use
  Location excitation_where;
  SweepDescription sweep;
  Location sweep_where;
  Route route = Route::periodic;
  Location route_where;
  Start start = Start::unloaded;
  Location start_where;
  Direction direction = Direction::up;
  Location direction_where;
  std::optional<std::vector<ObservationDescription>> observe;  ///< all coordinates unless given
  std::vector<Quantity> harmonics;                             ///< orders over the fundamental; the first unless given
  std::optional<Quantity> orders;           ///< of harmonic balance; chosen by the error unless given
  std::optional<Quantity> tolerance;        ///< relative [-]
  std::optional<MethodDescription> method;  ///< of time marching, as the two below
  std::optional<Quantity> steps_per_period, max_periods;
  std::optional<WaveformsDescription> waveforms;
  std::optional<Location> about_equilibrium;  ///< of a mechanism: where that was asked for
};

/// A configuration that a transient of the same study reaches.
struct ReachedDescription {
  std::string analysis;
  Location analysis_where, where;
  std::optional<Quantity> time;  ///< [s]; its end unless given
  bool settles = false;          ///< go on to the static equilibrium next to it
};

/// What contacts do to small motions in one set of modes.
struct ContactLimitDescription {
  enum class Kind { open, stuck, frictionless, static_state, sliding };
  Kind kind = Kind::stuck;
  std::vector<std::pair<std::string, Quantity>> sliding;  ///< contacts and the sign (or direction) in which they slide
  Location where;
};

struct ModesDescription {
  std::optional<Quantity> count;                                 ///< of each limit; all, at most 20, unless given
  std::optional<std::vector<ObservationDescription>> observe;    ///< shapes to keep: all coordinates unless given
  std::optional<Location> about_equilibrium;                     ///< of a mechanism: where that was asked for
  std::optional<ReachedDescription> about_reached;               ///< of a mechanism
  std::optional<std::vector<ContactLimitDescription>> contacts;  ///< free and stuck unless given
  Location contacts_where;
  std::vector<Quantity> nodal_diameters;  ///< of a disk of equal sectors; all unless given
  Location nodal_diameters_where;
  SweptDescription swept;
};

struct DamperCurveDescription {
  enum class Objective {
    amplitude,   ///< the largest of the observed ones, over frequency; the optimum is its lowest value
    dissipated,  ///< friction work of all sliders over a period; the optimum is its highest value
  };

  std::string parameter;
  Location parameter_where;
  ValuesDescription range;        ///< of the parameter
  ValuesDescription frequencies;  ///< from and to [rad/s], or [Hz]; points, where given, are scanned for peaks
  bool has_frequency_points = false;
  bool frequencies_in_hertz = false;
  std::string excitation;  ///< the parameter that takes them; empty: the one that the forces use
  Location excitation_where;
  SweepDescription sweep;  ///< of other parameters: a curve for each combination
  Location sweep_where;
  Objective objective = Objective::amplitude;
  Location objective_where;
  bool optimum = true;                                         ///< refined, with what certifies it
  std::optional<std::vector<ObservationDescription>> observe;  ///< all coordinates unless given
  std::optional<FrequencyResponseDescription::Route> route;    ///< chosen by cost unless given
  Location route_where;
  std::optional<Quantity> tolerance;          ///< relative [-], of harmonic balance
  std::optional<Location> about_equilibrium;  ///< of a mechanism: where that was asked for
};

struct AnalysisDescription {
  std::string name;
  std::variant<TransientDescription, MethodStudyDescription, ModesDescription, FrequencyResponseDescription,
               DamperCurveDescription, StaticDescription>
      task;
  Location where;
};

struct StudyDescription {
  std::string title;
  std::string file;  ///< as the user named it; messages use it
  std::string text;  ///< the whole file, kept in the results
  std::vector<ParameterDescription> parameters;
  ModelDescription model;
  std::vector<AnalysisDescription> analyses;
};

/// The values of the parameters, each a formula of those before it; `overrides` (from --set) replace values and must
/// name known parameters. Throws InvalidInput.
numerics::Parameters evaluate_parameters(const std::vector<ParameterDescription>& parameters,
                                         const numerics::Parameters& overrides = {});

}  // namespace rubato::model
