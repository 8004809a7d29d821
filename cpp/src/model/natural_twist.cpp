#include "model/natural_twist.hpp"

#include "der/core/index.hpp"

namespace der {

double natural_twist_at(const RodLayout& rod, const RodJoint& joint) {
  if (rod.natural_twist.empty()) return rod.initial_twist;
  const Index place = joint.place();
  const Index edge = joint.twist_place < rod.arc_length_at(place) ? place - 1 : place;
  const double share =
      (joint.twist_place - rod.arc_length_at(edge)) / rod.edge_length[to_size(rod.position(edge))];
  return (1.0 - share) * rod.natural_twist[to_size(rod.position(edge))] +
         share * rod.natural_twist[to_size(rod.position(edge + 1))];
}

}  // namespace der
