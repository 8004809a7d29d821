#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

/// The scene as plain validated data: what the user wrote, in SI units, with defaults filled in and
/// every cross-reference checked (rod names, node numbers, arc lengths, dimensions). It knows no
/// mechanics. `reader.hpp` makes it from a text or a dictionary.
namespace der::scenario {

/// Where a thing stands in the scene text (1-based; 0 when there is no text), for later messages.
struct Mark {
  int line = 0;
  int column = 0;
};

/// A point in space or a vector: 2 components (x, y) or 3 (x, y, z), as the scene's dimension says.
using Components = std::vector<double>;

/// A scalar that follows a table over time: linear between entries, constant beyond both ends. A
/// constant is a table with one entry. `times` [s] strictly increasing.
struct Series {
  std::vector<double> times{0.0};
  std::vector<double> values{0.0};
  [[nodiscard]] bool constant() const { return values.size() == 1; }
};

/// Value of a table at time `t` [s]: linear between entries, constant beyond both ends.
double value_at(const Series& series, double t);

/// As `Series`, with a vector value for each time.
struct VectorSeries {
  std::vector<double> times{0.0};
  std::vector<Components> values;
  [[nodiscard]] bool constant() const { return values.size() == 1; }
};

/// The value of `at:`: a place along a rod's rest length.
struct Location {
  enum class Kind { Start, Middle, End, All, ArcLength, Node };
  Kind kind = Kind::Start;
  double arc_length = 0.0;  ///< [m], for Kind::ArcLength
  int node = 0;             ///< 0-based, for Kind::Node; negative counts from the end
  Mark mark;
};

struct Circle {
  double radius = 0.0;  ///< [m]
};
struct Tube {
  double inner_radius = 0.0;  ///< [m]
  double outer_radius = 0.0;  ///< [m]
};
struct Rectangle {
  double width = 0.0;   ///< [m] out of the plane of a planar scene
  double height = 0.0;  ///< [m] in the plane of bending of a planar scene
};
struct Stiffness {
  double EA = 0.0;               ///< [N]
  double EI = 0.0;               ///< [N m^2]
  std::optional<double> GJ;      ///< [N m^2], needed only where a scene twists
  double mass_per_length = 0.0;  ///< [kg/m]
};
using CrossSection = std::variant<Circle, Tube, Rectangle, Stiffness>;

struct Material {
  double youngs_modulus = 0.0;  ///< [Pa]
  double density = 0.0;         ///< [kg/m^3]
};

/// Rigid spheres threaded on nodes. The reader leaves the list in the order of the text; a later
/// entry replaces an earlier one on the same node.
struct Sphere {
  Location at;
  double radius = 0.0;   ///< [m]
  double density = 0.0;  ///< [kg/m^3]
};

enum class CurvatureMeasure { Angle, Tangent };

/// The rod is stress-free in the shape in which it is drawn.
struct AsDrawn {};
/// Signed natural curvature [1/m], positive counter-clockwise: one value, or one for each node.
using NaturalCurvature = std::variant<AsDrawn, double, std::vector<double>>;

struct Rod {
  std::string name;
  /// Initial node positions [m], one per node (from `points`, or spaced evenly over `from`..`to`).
  std::vector<Components> points;
  CrossSection cross_section;
  std::optional<Material> material;  ///< absent only with `Stiffness`
  CurvatureMeasure curvature = CurvatureMeasure::Angle;
  NaturalCurvature natural_curvature = AsDrawn{};
  /// Initial velocities [m/s], one per node; empty: at rest.
  std::vector<Components> initial_velocity;
  std::vector<Sphere> spheres;
  Mark mark;
};

enum class Component { X, Y, Z };

/// A component that moves by a table: its displacement from the initial position [m].
struct Prescribed {
  Component component = Component::X;
  Series displacement;
};

/// An elastic support: pulls a place of a rod to an anchor, or its tangent to the drawn direction.
struct Spring {
  Components stiffness;               ///< [N/m] along each axis; empty: none
  Components anchor;                  ///< [m]; empty: where the place is as drawn
  double rotational_stiffness = 0.0;  ///< [N m/rad]; 0: none
};

struct Support {
  std::string rod;
  Location at;
  std::vector<Component> fix;         ///< held at their initial value
  std::vector<Prescribed> prescribe;  ///< moved by a table
  bool clamp = false;                 ///< all components of the node and the tangent at it are held
  std::optional<Series> rotation;     ///< of the clamped tangent, from its initial direction [rad]
  std::optional<Spring> spring;
  Mark mark;

  /// Whether it holds nodes; otherwise it is only a spring, at any arc length.
  [[nodiscard]] bool holds() const { return clamp || !fix.empty() || !prescribe.empty(); }
};

struct Gravity {
  Components acceleration;  ///< [m/s^2]
};
/// Stokes drag 6 pi mu R u and buoyancy on the spheres.
struct Fluid {
  double density = 0.0;    ///< [kg/m^3]; 0: no buoyancy
  double viscosity = 0.0;  ///< [Pa s]
};
/// Linear damping: a force -coefficient * velocity per unit rest length, on one rod or on all.
struct Damping {
  std::optional<std::string> rod;
  double coefficient = 0.0;  ///< [N s/m^2]
};
struct PointForce {
  std::string rod;
  Location at;
  VectorSeries force;  ///< [N], dead (keeps its direction)
};
struct Moment {
  std::string rod;
  Location at;
  Series moment;  ///< [N m] about z, positive counter-clockwise
};
/// A dead force per unit rest length on the part `from`..`to` [m] of a rod.
struct DistributedForce {
  std::string rod;
  double from = 0.0;
  double to = 0.0;
  VectorSeries force;  ///< [N/m]
};
struct Load {
  std::variant<Gravity, Fluid, Damping, PointForce, Moment, DistributedForce> what;
  Mark mark;
};

enum class ModelChoice { Auto, Planar };

// Each analysis has its word in the scene as `kName`.

/// A run over time: `time:`.
struct DynamicAnalysis {
  static constexpr const char* kName = "dynamic";
};
/// The static equilibrium under the loads.
struct StaticAnalysis {
  static constexpr const char* kName = "static";
  bool leave_saddles = true;  ///< whether an unstable equilibrium is left for a stable one
};
/// Free vibrations about the equilibrium.
struct ModesAnalysis {
  static constexpr const char* kName = "modes";
  int count = 6;
};
/// Linear buckling loads of the unloaded equilibrium.
struct BucklingAnalysis {
  static constexpr const char* kName = "buckling";
  int count = 3;
};
/// What a continuation scales: what acts, or what moves.
enum class Varied { Loads, Supports };
/// The path of equilibria as a factor of loads or prescribed motions changes.
struct ContinuationAnalysis {
  static constexpr const char* kName = "continuation";
  Varied vary = Varied::Loads;
  std::optional<int> number;  ///< of the one load or support that varies; absent: all
  double from = 0.0;          ///< first factor
  double to = 1.0;            ///< last factor
  double step = 0.05;         ///< largest distance of two points
  int points = 500;           ///< largest number of points of a branch
  int branches = 0;           ///< how many bifurcations deep other branches are followed
};
/// What is done with the scene.
using Analysis = std::variant<DynamicAnalysis, StaticAnalysis, ModesAnalysis, BucklingAnalysis,
                              ContinuationAnalysis>;

/// How long the time steps are.
enum class Stepping {
  Fixed,      ///< `step: 0.01`
  Automatic,  ///< `step: auto`: what an explicit integrator can take
  Adaptive,   ///< `tolerance: 1e-3`: as the error demands
};

/// More steps than anyone can wait for.
constexpr double kMostSteps = 1e12;

struct Time {
  double duration = 0.0;  ///< [s]
  Stepping stepping = Stepping::Fixed;
  double step = 0.0;       ///< [s] of Stepping::Fixed
  double tolerance = 0.0;  ///< of Stepping::Adaptive: error of positions over the structure's size
  std::string integrator = "tr_bdf2";
  /// Whether an explicit step above the stable one may run, and a motion in which the integrator
  /// creates energy.
  bool allow_unstable = false;
  double minimum_step = 0.0;  ///< [s] floor for retries after a failed step; 0: not given
  /// For generalized_alpha: spectral radius at infinite frequency (0: full damping, 1: none).
  double spectral_radius = 0.9;
};

struct Solver {
  std::string linear = "auto";  ///< a name of the linear-solver registry, or `auto`
  /// Newton stops when the residual is below this fraction of the acting forces ...
  double residual_tolerance = 1e-9;
  /// ... and the step below this fraction of the structure's size.
  double step_tolerance = 1e-9;
  int max_iterations = 50;
};

enum class Reduce { None, Min, Max };
/// Which of the two values of a quantity that jumps: toward smaller arc lengths, or larger ones.
enum class Side { Before, After };
struct Probe {
  std::string name;
  std::string quantity;            ///< a name of the probe registry (x, vy, turning_angle, ...)
  std::optional<std::string> rod;  ///< absent: the whole model (energies only)
  std::optional<Location> at;
  Reduce over = Reduce::None;  ///< with `over: rod`: the extreme along the rod
  std::optional<Side> side;    ///< absent: after; quantities that jump only
  Mark mark;
};

struct Output {
  /// [s] between saved frames; always above 0 in a run over time.
  double every = 0.0;
  std::vector<Probe> probes;
};

struct Scene {
  std::string title;
  int dimension = 2;  ///< of the vectors in the text: 2 or 3
  ModelChoice model = ModelChoice::Auto;
  Analysis analysis = DynamicAnalysis{};
  std::vector<Rod> rods;
  std::vector<Support> supports;
  std::vector<Load> loads;
  Time time;  ///< of a dynamic analysis
  /// "equilibrium", or the folder of a run whose last frame is the start; empty: as drawn.
  std::string start_from;
  Solver solver;
  Output output;
  /// What can be run as it is, but is most likely not what was meant: sentences.
  std::vector<std::string> warnings;

  [[nodiscard]] bool is_dynamic() const {
    return std::holds_alternative<DynamicAnalysis>(analysis);
  }
  /// "dynamic", or the word of `analysis:`.
  [[nodiscard]] const char* analysis_name() const {
    return std::visit([](const auto& chosen) { return chosen.kName; }, analysis);
  }
};

}  // namespace der::scenario
