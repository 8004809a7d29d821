#include "output/tangent_field.hpp"
#include "output/leg_field.hpp"
#include "output/spatial_leg_field.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/followed.hpp"
#include "der/model/frames.hpp"
#include "der/model/location.hpp"
#include "der/output/vertex_strain.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/spatial_clamp.hpp"
#include "model/curvature_jump.hpp"
#include "model/reference_edge.hpp"
#include "output/glue_kink.hpp"
#include "output/moment_recovery.hpp"
#include "output/natural_curvature.hpp"
#include "output/tangent_line.hpp"
#include "supports/leg_clamp.hpp"

namespace der {
namespace {

std::vector<double> arc_lengths(const std::vector<TangentLine::Sample>& samples) {
  std::vector<double> result;
  for (const auto& sample : samples) result.push_back(sample.arc_length);
  return result;
}

/// The free end of a rod, whose edge leans against the curve: it lies on the curve and the next
/// node beside it (model/location.hpp).
struct FreeEnd {
  bool last = false;
  Index edge = 0;
  double bend_length = 0.0;  ///< [m] of the node beside it
};

std::vector<FreeEnd> free_ends(const RodMesh& rod) {
  std::vector<FreeEnd> ends;
  if (rod.closed || rod.num_edges() < 2) return ends;
  for (const bool last : {false, true}) {
    const Index node = last ? rod.num_edges() : 0;
    const Index next = last ? node - 1 : 1;
    if (rod.clamp_at(node) != nullptr || rod.clamp_at(next) != nullptr) continue;
    ends.push_back({last, last ? node - 1 : 0, bend_length(rod, next)});
  }
  return ends;
}

/// How much further [m] than the middle of an edge beside a clamp lies its knot.
double knot_beyond_middle(const RodMesh& rod, Index edge) {
  return tangent_place(rod, edge) - rod.edge_middle(edge);
}

/// Whether an edge beside a clamp leans against a rod that is stress-free as drawn: from its pivot
/// to a node on the drawn curve it is turned by more than the tangent at its knot. Where the scene
/// gives the natural curvature, the cell of the clamp has it, and the edge does not.
bool leans_as_drawn(const RodMesh& rod, Index edge) {
  return rod.natural_curvature.empty() && rod.natural_curvatures.empty() &&
         (rod.clamp_at(edge) != nullptr || rod.clamp_at(edge + 1) != nullptr);
}

/// Adds the arc lengths [m] at which the natural curvature jumps.
void add_natural_jumps(const RodMesh& rod, std::vector<double>& kinks) {
  for (const CurvatureJump& jump : rod.natural_jumps) {
    kinks.push_back(rod.arc_length_at(jump.place));
  }
}

/// The clamps at the knots, as the knots' legs see them; at those of edges one that is not used.
std::vector<Clamp> held_at_knots(const TangentLine& line, const RodMesh& rod, const Model& model) {
  std::vector<Clamp> held;
  for (const TangentLine::Knot& knot : line.knots()) {
    held.emplace_back();
    if (knot.clamp < 0) continue;
    held.back() = clamp_of_leg(rod.clamps[to_size(knot.clamp)], knot.arrives, rod, model);
  }
  return held;
}

/// The turns towards the two directors [rad], in a plane the first of them.
Vec3 turn_values(const TangentLine::Turn& turn, const Model& model, const State& state) {
  return turn.actuated.value([&](Index control) { return control_value(model, state, control); });
}

/// The direction of a rod as a `Value` that is linear along it: an angle in a plane, the tangent in
/// space.
template <class Value>
class DirectionField : public RodField {
 public:
  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    read_knots(model, state);
    return number_of(value(i, model, state));
  }
  void sample_all(const Model& model, const State& state, double* values) const override {
    read_knots(model, state);
    for (std::size_t i = 0; i < line_.samples().size(); ++i) {
      values[i] = number_of(value(i, model, state));
    }
  }
  [[nodiscard]] double interpolate(const SampleWeights& weights, const Model& model,
                                   const State& state) const override {
    read_knots(model, state);
    Value sum = weights.front().weight * value(weights.front().sample, model, state);
    for (std::size_t i = 1; i < weights.size(); ++i) {
      sum += weights[i].weight * value(weights[i].sample, model, state);
    }
    if (line_.is_actuated() && weights.size() > 1) {
      sum += turned(line_.turn_between(weights), model, state);
    }
    return number_of(sum);
  }
  [[nodiscard]] bool smooth_at(std::size_t i) const override { return line_.samples()[i].smooth; }

 protected:
  explicit DirectionField(TangentLine line)
      : RodField(arc_lengths(line.samples())), line_(std::move(line)) {}

  [[nodiscard]] const TangentLine& line() const { return line_; }

 private:
  /// Sets `knots` to the directions there, and `kinks` to the jumps of their derivative [1/m].
  virtual void read(const Model& model, const State& state, std::vector<Value>& knots,
                    std::vector<Value>& kinks) const = 0;
  /// The part of a direction that an actuated turn adds.
  [[nodiscard]] virtual Value turned(const TangentLine::Turn& turn, const Model& model,
                                     const State& state) const = 0;
  /// The quantity in a direction.
  [[nodiscard]] virtual double number_of(const Value& direction) const = 0;

  void read_knots(const Model& model, const State& state) const {
    knots_.clear();
    kinks_.clear();
    read(model, state, knots_, kinks_);
  }
  [[nodiscard]] Value value(std::size_t i, const Model& model, const State& state) const {
    const TangentLine::Sample& sample = line_.samples()[i];
    Value sum = sample.knots.front().factor * knots_[sample.knots.front().number];
    if (sample.knots.size() > 1) sum += sample.knots[1].factor * knots_[sample.knots[1].number];
    for (const auto& [kink, factor] : sample.kinks) sum += factor * kinks_[kink];
    for (const TangentLine::Turn& turn : sample.turns) sum += turned(turn, model, state);
    return sum;
  }

  TangentLine line_;
  mutable std::vector<Value> knots_;  // kept, so that reading allocates nothing
  mutable std::vector<Value> kinks_;
};

class PlanarDirection : public DirectionField<double> {
 public:
  /// `component`: of the tangent; none: the angle itself.
  static std::unique_ptr<RodField> make(std::optional<int> component, const RodMesh& rod,
                                        const Model& model) {
    std::vector<double> kinks;
    if (rod.EI > 0.0) {
      for (const MomentPlace& place : rod.moment_places) kinks.push_back(place.arc_length);
    }
    add_natural_jumps(rod, kinks);
    return std::unique_ptr<RodField>(
        new PlanarDirection(component, rod, model, TangentLine(rod, std::move(kinks), model)));
  }

 private:
  PlanarDirection(std::optional<int> component, const RodMesh& rod, const Model& model,
                  TangentLine line)
      : DirectionField(std::move(line)),
        component_(component),
        rod_(rod),
        held_(held_at_knots(this->line(), rod, model)) {
    if (rod.EI > 0.0) ends_ = free_ends(rod);
    if (!ends_.empty() && !rod.moment_places.empty()) spread_.emplace(rod, model);
    if (!rod.moment_places.empty() && rod.EI > 0.0) moments_.emplace(rod, model);
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      edges_.push_back(effective_edge(rod, edge, model));
    }
    find_reference_leans(model);
    for (const CurvatureJump& jump : rod.natural_jumps) {
      natural_jumps_.push_back(jump.turn.z());
    }
    find_reference(model);
  }

  void find_reference_leans(const Model& model) {
    const NaturalCurvature natural(rod_, model);
    for (Index edge = 0; edge < rod_.num_edges(); ++edge) {
      reference_leans_.push_back(0.0);
      if (!leans_as_drawn(rod_, edge)) continue;
      const Vec2 chord = reference_edge(rod_, edge, model);
      const Vec2 effective = edges_[to_size(edge)].drawn(model.reference_positions);
      reference_leans_.back() =
          angle_between(chord, effective) -
          knot_beyond_middle(rod_, edge) * natural.at(edge, rod_.edge_middle(edge));
    }
  }

  /// The knot from which whole turns count: a clamp, an edge that the state follows, or the first
  /// one.
  void find_reference(const Model& model) {
    const auto& knots = line().knots();
    for (std::size_t i = 0; i < knots.size(); ++i) {
      if (knots[i].clamp >= 0) {
        reference_ = i;
        return;
      }
    }
    for (std::size_t i = 0; i < knots.size(); ++i) {
      const Edge edge = rod_.edge(rod_.position(knots[i].edge), model);
      for (std::size_t k = 0; k < model.followed_edges.size(); ++k) {
        const Edge& followed = model.followed_edges[k].edge;
        if (followed.first != edge.first || followed.last != edge.last) continue;
        reference_ = i;
        followed_ = static_cast<Index>(k);
        return;
      }
    }
  }

  [[nodiscard]] Vec2 direction(std::size_t number, const Model& model, const State& state) const {
    const TangentLine::Knot& knot = line().knots()[number];
    if (knot.clamp < 0)
      return effective_vector(edges_[to_size(rod_.position(knot.edge))], model, state);
    const double angle = tangent_angle(held_[number], model, state);
    return {std::cos(angle), std::sin(angle)};
  }

  /// Angle [rad] of the reference, whole turns included.
  [[nodiscard]] double reference_angle(const Vec2& direction, const Model& model,
                                       const State& state) const {
    const TangentLine::Knot& knot = line().knots()[reference_];
    if (knot.clamp >= 0) return tangent_angle(held_[reference_], model, state);
    if (followed_ < 0) return std::atan2(direction.y(), direction.x());
    const double before =
        model.followed_edges[to_size(followed_)].direction + state.followed[followed_];
    return before + angle_between({std::cos(before), std::sin(before)}, direction);
  }

  void read(const Model& model, const State& state, std::vector<double>& knots,
            std::vector<double>& kinks) const override {
    const auto& places = line().knots();
    Vec2 before = direction(0, model, state);
    double angle = 0.0;
    double offset = 0.0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Vec2 here = direction(i, model, state);
      angle += angle_between(before, here);
      before = here;
      knots.push_back(angle);
      if (i == reference_) offset = reference_angle(here, model, state) - angle;
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
      knots[i] += offset;
      if (places[i].clamp < 0) knots[i] -= reference_leans_[to_size(rod_.position(places[i].edge))];
    }
    for (const FreeEnd& end : ends_) {
      (end.last ? knots.back() : knots.front()) -= lean(end, model, state);
    }
    for (std::size_t i = 0; moments_ && i < moments_->size(); ++i) {
      kinks.emplace_back(-moments_->value(i, model, state).whole.z() / rod_.EI);
    }
    kinks.insert(kinks.end(), natural_jumps_.begin(), natural_jumps_.end());
  }

  /// How far the outermost edge is turned beyond the curve [rad].
  [[nodiscard]] double lean(const FreeEnd& end, const Model& model, const State& state) const {
    double turn = 0.0;
    if (spread_) turn += end.bend_length / rod_.EI * spread_->excess(end.edge, model, state).z();
    if (!rod_.natural_curvature.empty()) {
      const double twelfth = rod_.edge_length[to_size(end.edge)] / 12.0;
      turn += (end.last ? twelfth * rod_.natural_curvature.back()
                        : -twelfth * rod_.natural_curvature.front());
    }
    return turn;
  }

  [[nodiscard]] double turned(const TangentLine::Turn& turn, const Model& model,
                              const State& state) const override {
    return turn_values(turn, model, state)[0];
  }

  [[nodiscard]] double number_of(const double& angle) const override {
    if (!component_) return angle;
    return *component_ == 0 ? std::cos(angle) : std::sin(angle);
  }

  std::optional<int> component_;
  RodMesh rod_;
  std::vector<Clamp> held_;  // at the knots
  std::vector<EffectiveEdge> edges_;
  std::vector<double> reference_leans_;  // of each edge [rad]
  std::vector<double> natural_jumps_;    // of the curvature [1/m]
  std::vector<FreeEnd> ends_;
  std::optional<MomentRecovery> spread_;  // where moments at free ends may matter
  std::optional<SpreadMoments> moments_;
  std::size_t reference_ = 0;
  Index followed_ = -1;  // in Model::followed_edges
};

class SpatialDirection : public DirectionField<Vec3> {
 public:
  static std::unique_ptr<RodField> make(int component, const RodMesh& rod, const Model& model) {
    std::optional<SpreadMoments> moments;
    std::vector<double> kinks;
    if (model.has_sections() && !rod.vertices.empty()) {
      moments.emplace(rod, model);
      for (std::size_t i = 0; i < moments->size(); ++i) kinks.push_back((*moments)[i].arc_length);
      if (kinks.empty()) moments.reset();
    }
    add_natural_jumps(rod, kinks);
    auto glue = GlueKink::make(rod, model);
    if (glue) kinks.push_back(0.0);
    TangentLine line(rod, std::move(kinks), model);
    return std::unique_ptr<RodField>(new SpatialDirection(component, rod, model, std::move(line),
                                                          std::move(moments), std::move(glue)));
  }

 private:
  SpatialDirection(int component, const RodMesh& rod, const Model& model, TangentLine line,
                   std::optional<SpreadMoments> moments, std::optional<GlueKink> glue)
      : DirectionField(std::move(line)),
        component_(component),
        rod_(rod),
        held_(held_at_knots(this->line(), rod, model)),
        moments_(std::move(moments)),
        glue_(std::move(glue)) {
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      edges_.push_back(spatial_edge(rod, edge, model));
    }
    reference_leans_.assign(edges_.size(), Vec2::Zero());
    if (!model.has_sections() || rod.vertices.empty()) return;
    find_reference_leans(model);
    find_natural_jumps(model);
    ends_ = free_ends(rod);
    if (moments_ && !ends_.empty()) spread_.emplace(rod, model);
  }

  void find_reference_leans(const Model& model) {
    for (const RodVertex& vertex : rod_.vertices) {
      if (vertex.clamp < 0) continue;
      const Index edge = vertex.leaves_clamp() ? vertex.after : vertex.before;
      if (!leans_as_drawn(rod_, edge)) continue;
      const Vec3 chord = reference_edge<3>(rod_, edge, model);
      const SectionFrame section = initial_frame(model, rod_.first_edge + edge);
      const Vec3 leant = section.tangent - chord.normalized();
      reference_leans_[to_size(edge)] = Vec2(leant.dot(section.first), leant.dot(section.second)) -
                                        knot_beyond_middle(rod_, edge) * vertex.natural_curvature;
    }
  }

  void find_natural_jumps(const Model& model) {
    for (const auto& [place, turn] : rod_.natural_jumps) {
      const Index edge = rod_.edge_before(place);
      const SectionFrame section = initial_frame(model, rod_.first_edge + edge);
      const Vec3 bent = turn.cross(section.tangent);
      natural_jumps_.emplace_back(edge, Vec2(bent.dot(section.first), bent.dot(section.second)));
    }
  }

  void read(const Model& model, const State& state, std::vector<Vec3>& knots,
            std::vector<Vec3>& kinks) const override {
    for (std::size_t i = 0; i < held_.size(); ++i) {
      const TangentLine::Knot& knot = line().knots()[i];
      knots.push_back(knot.clamp >= 0 ? held_frame(held_[i].held, model, state).tangent
                                      : tangent_of_edge(rod_.position(knot.edge), model, state));
    }
    for (const FreeEnd& end : ends_) {
      (end.last ? knots.back() : knots.front()) -= lean(end, model, state);
    }
    for (std::size_t i = 0; moments_ && i < moments_->size(); ++i) {
      const SpreadMoments::Moment& moment = (*moments_)[i];
      if (glue_ && is_at_start(moment.arc_length)) {
        kinks.emplace_back(Vec3::Zero());
        continue;
      }
      const SectionFrame section = frame(rod_.position(moment.first_edge), model, state);
      kinks.emplace_back(-change_by(moments_->value(i, model, state).whole, 1.0, section));
    }
    for (const auto& [edge, jump] : natural_jumps_) {
      const SectionFrame section = frame(edge, model, state);
      kinks.emplace_back(jump[0] * section.first + jump[1] * section.second);
    }
    if (glue_) kinks.push_back(glue_->jump(model, state));
  }

  /// Whether an arc length [m] is that of the start of a ring, which is its end, too.
  [[nodiscard]] bool is_at_start(double s) const {
    return std::min(s, rod_.rest_length() - s) <= rod_.same_place();
  }

  /// At its knot.
  [[nodiscard]] Vec3 tangent_of_edge(Index edge, const Model& model, const State& state) const {
    Vec3 tangent = effective_vector(edges_[to_size(edge)], model, state).normalized();
    const Vec2& leans = reference_leans_[to_size(edge)];
    if (leans.isZero(0.0)) return tangent;
    const SectionFrame section = frame(edge, model, state);
    tangent -= leans[0] * section.first + leans[1] * section.second;
    return tangent;
  }

  [[nodiscard]] SectionFrame frame(Index edge, const Model& model, const State& state) const {
    return section_frame(model, rod_.first_edge + edge, state);
  }

  /// How the tangent changes along a length [m] under a moment [N m].
  [[nodiscard]] Vec3 change_by(const Vec3& moment, double length, const SectionFrame& frame) const {
    const auto bent = [&](double part, double stiffness) {
      return stiffness > 0.0 ? length * part / stiffness : 0.0;
    };
    return bent(moment.dot(frame.second), rod_.EI_1) * frame.first -
           bent(moment.dot(frame.first), rod_.EI_2) * frame.second;
  }

  /// How far the tangent of an outermost edge is beyond that of the curve.
  [[nodiscard]] Vec3 lean(const FreeEnd& end, const Model& model, const State& state) const {
    const SectionFrame section = frame(end.edge, model, state);
    Vec3 change = Vec3::Zero();
    if (spread_) {
      change += change_by(spread_->excess(end.edge, model, state), end.bend_length, section);
    }
    if (!rod_.natural_curvatures.empty()) {
      const Vec2& natural =
          end.last ? rod_.natural_curvatures.back() : rod_.natural_curvatures.front();
      const double twelfth = (end.last ? 1.0 : -1.0) * rod_.edge_length[to_size(end.edge)] / 12.0;
      change += twelfth * (natural[0] * section.first + natural[1] * section.second);
    }
    return change;
  }

  [[nodiscard]] Vec3 turned(const TangentLine::Turn& turn, const Model& model,
                            const State& state) const override {
    const Vec3 values = turn_values(turn, model, state);
    const SectionFrame section = frame(turn.edge, model, state);
    return values[0] * section.first + values[1] * section.second;
  }

  [[nodiscard]] double number_of(const Vec3& direction) const override {
    return direction[component_] / direction.norm();
  }

  int component_;
  RodMesh rod_;
  std::vector<Clamp> held_;  // at the knots
  std::vector<SpatialEdge> edges_;
  std::vector<Vec2> reference_leans_;  // of each edge, towards its two directors
  /// Jumps of the drawn curvature behind edges, towards their two directors [1/m].
  std::vector<std::pair<Index, Vec2>> natural_jumps_;
  std::vector<FreeEnd> ends_;
  std::optional<MomentRecovery> spread_;  // where moments at free ends may matter
  std::optional<SpreadMoments> moments_;
  std::optional<GlueKink> glue_;
};

}  // namespace

std::unique_ptr<RodField> make_slope_field(const RodMesh& rod, const Model& model) {
  if (!rod.legs.empty()) return make_leg_field(LegQuantity::Slope, rod, model);
  return PlanarDirection::make(std::nullopt, rod, model);
}

std::unique_ptr<RodField> make_tangent_field(int number, const RodMesh& rod, const Model& model) {
  if (!rod.legs.empty() && model.dimension == 3) {
    constexpr std::array components{SpatialLegQuantity::TangentX, SpatialLegQuantity::TangentY,
                                    SpatialLegQuantity::TangentZ};
    return make_spatial_leg_field(components[to_size(number)], rod, model);
  }
  if (!rod.legs.empty()) {
    return make_leg_field(number == 0 ? LegQuantity::TangentX : LegQuantity::TangentY, rod, model);
  }
  if (model.dimension == 2) return PlanarDirection::make(number, rod, model);
  return SpatialDirection::make(number, rod, model);
}

}  // namespace der
