#pragma once

#include <string>
#include <variant>
#include <vector>

#include "der/scenario/actuation.hpp"
#include "der/scenario/analysis.hpp"
#include "der/scenario/axial_spring.hpp"
#include "der/scenario/joint.hpp"
#include "der/scenario/output.hpp"
#include "der/scenario/rod.hpp"
#include "der/scenario/solver.hpp"
#include "der/scenario/support.hpp"
#include "der/scenario/time.hpp"

/// The scene as plain validated data: what the user wrote, in SI units, with defaults filled in and
/// every cross-reference checked (rod names, node numbers, arc lengths, dimensions). It knows no
/// mechanics. `reader.hpp` makes it from a text or a dictionary.
namespace der::scenario {

struct Load;

enum class ModelChoice {
  Auto,
  Planar,       ///< x and y of each node
  SpatialBend,  ///< x, y and z of each node
  Spatial,      ///< x, y and z of each node, and the angle of each edge's section
};

/// The copies and the end of a scene are in scene.cpp, where `Load` is complete: a new kind of load
/// recompiles only those who include load.hpp.
struct Scene {
  Scene();
  Scene(const Scene& other);
  Scene(Scene&& other) noexcept;
  Scene& operator=(const Scene& other);
  Scene& operator=(Scene&& other) noexcept;
  ~Scene();

  std::string title;
  /// Components of all vectors but `Rod::director` and `AxisRotation::axis`, which have 3: 2 in a
  /// scene of the planar model, else 3.
  int dimension = 2;
  bool in_space = false;                  ///< whether its vectors are written with three components
  ModelChoice model = ModelChoice::Auto;  ///< as asked for; see model_choice.hpp
  Analysis analysis = DynamicAnalysis{};
  std::vector<Rod> rods;
  std::vector<Joint> joints;
  std::vector<AxialSpring> springs;
  std::vector<Support> supports;
  std::vector<Load> loads;
  std::vector<Actuation> actuations;
  Time time;  ///< of a dynamic analysis
  /// "equilibrium", or the folder of a run whose last frame is the start; empty: undeformed.
  std::string start_from;
  Solver solver;
  Output output;
  /// Warnings about parts of the scene that can be run but are probably not intended: sentences.
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
