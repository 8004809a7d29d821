#pragma once

#include <tuple>
#include <vector>

#include "der/energies/arc_stretch.hpp"
#include "der/energies/axial_spring.hpp"
#include "der/energies/circulatory_load.hpp"
#include "der/energies/corner_fork.hpp"
#include "der/energies/element_list.hpp"
#include "der/energies/end_cell.hpp"
#include "der/energies/fork.hpp"
#include "der/energies/foundation.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/isotropic_bend.hpp"
#include "der/energies/joint_spring.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/planar_clamp.hpp"
#include "der/energies/planar_moment.hpp"
#include "der/energies/point_spring.hpp"
#include "der/energies/rotational_spring.hpp"
#include "der/energies/section_spring.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/spatial_end_cell.hpp"
#include "der/energies/spatial_joint_spring.hpp"
#include "der/energies/stretch.hpp"

namespace der {

/// Every kind of element. A new energy is one header with its kernel and one line here; assembly,
/// the energy report and the finite-difference tests loop over this list. A kind without elements
/// costs nothing in a run.
struct ElementLists {
  using Lists = std::tuple<
      ElementList<Stretch<2>>,                                //
      ElementList<FromPivot<Stretch<2>>>,                     //
      ElementList<PlanarBend<AngleCurvature>>,                //
      ElementList<PlanarBend<TangentCurvature>>,              //
      ElementList<FromPivot<PlanarBend<AngleCurvature>>>,     //
      ElementList<FromPivot<PlanarBend<TangentCurvature>>>,   //
      ElementList<FromPivot<PlanarClamp<AngleCurvature>>>,    //
      ElementList<FromPivot<PlanarClamp<TangentCurvature>>>,  //
      ElementList<EndCell<AngleCurvature, 1, 1>>, ElementList<EndCell<TangentCurvature, 1, 1>>,
      ElementList<EndCell<AngleCurvature, 2, 1>>, ElementList<EndCell<TangentCurvature, 2, 1>>,
      ElementList<EndCell<AngleCurvature, 1, 2>>, ElementList<EndCell<TangentCurvature, 1, 2>>,
      ElementList<EndCell<AngleCurvature, 2, 2>>, ElementList<EndCell<TangentCurvature, 2, 2>>,
      ElementList<ArcStretch<1, 1>>, ElementList<ArcStretch<1, 2>>, ElementList<ArcStretch<2, 0>>,
      ElementList<ArcStretch<2, 1>>, ElementList<ArcStretch<2, 2>>, ElementList<ArcStretch<3, 0>>,
      ElementList<ArcStretch<3, 1>>, ElementList<ArcStretch<3, 2>>, ElementList<JointSpring<1>>,
      ElementList<JointSpring<2>>,                                      //
      ElementList<Stretch<3>>,                                          //
      ElementList<FromSpatialPivot<Stretch<3>>>,                        //
      ElementList<IsotropicBend<AngleCurvature>>,                       //
      ElementList<IsotropicBend<TangentCurvature>>,                     //
      ElementList<FromSpatialPivot<IsotropicBend<AngleCurvature>>>,     //
      ElementList<FromSpatialPivot<IsotropicBend<TangentCurvature>>>,   //
      ElementList<FromSpatialPivot<IsotropicClamp<AngleCurvature>>>,    //
      ElementList<FromSpatialPivot<IsotropicClamp<TangentCurvature>>>,  //
      ElementList<SpatialBend<AngleCurvature>>,                         //
      ElementList<SpatialBend<TangentCurvature>>,                       //
      ElementList<FromSpatialPivot<SpatialBend<AngleCurvature>>>,       //
      ElementList<FromSpatialPivot<SpatialBend<TangentCurvature>>>,     //
      ElementList<CornerBend>,                                          //
      ElementList<FromSpatialPivot<CornerBend>>,                        //
      ElementList<FromSpatialPivot<SpatialClamp<AngleCurvature>>>,      //
      ElementList<FromSpatialPivot<SpatialClamp<TangentCurvature>>>,    //
      ElementList<SpatialEndCell<AngleCurvature, 1, 1>>,                //
      ElementList<SpatialEndCell<TangentCurvature, 1, 1>>,              //
      ElementList<SpatialEndCell<AngleCurvature, 2, 1>>,                //
      ElementList<SpatialEndCell<TangentCurvature, 2, 1>>,              //
      ElementList<SpatialEndCell<AngleCurvature, 1, 2>>,                //
      ElementList<SpatialEndCell<TangentCurvature, 1, 2>>,              //
      ElementList<SpatialEndCell<AngleCurvature, 2, 2>>,                //
      ElementList<SpatialEndCell<TangentCurvature, 2, 2>>,              //
      ElementList<SpatialJointSpring>,                                  //
      ElementList<FromSpatialPivot<Fork>>,                              //
      ElementList<FromSpatialPivot<CornerFork>>,                        //
      ElementList<PlanarMoment>,                                        //
      ElementList<FromPivot<PlanarMoment>>,                             //
      ElementList<Foundation<2>>,                                       //
      ElementList<Foundation<3>>,                                       //
      ElementList<AxialSpring<2>>,                                      //
      ElementList<AxialSpring<3>>,                                      //
      ElementList<PointSpring<2, 1>>,                                   //
      ElementList<PointSpring<2, 2>>,                                   //
      ElementList<PointSpring<2, 3>>,                                   //
      ElementList<PointSpring<2, 4>>,                                   //
      ElementList<PointSpring<2, 5>>,                                   //
      ElementList<PointSpring<2, 6>>,                                   //
      ElementList<PointSpring<3, 1>>,                                   //
      ElementList<PointSpring<3, 2>>,                                   //
      ElementList<PointSpring<3, 3>>,                                   //
      ElementList<PointSpring<3, 4>>,                                   //
      ElementList<PointSpring<3, 5>>,                                   //
      ElementList<PointSpring<3, 6>>,                                   //
      ElementList<RotationalSpring<1>>,                                 //
      ElementList<RotationalSpring<2>>,                                 //
      ElementList<FromPivot<RotationalSpring<1>>>,                      //
      ElementList<FromPivot<RotationalSpring<2>>>,                      //
      ElementList<SectionSpring<1>>,                                    //
      ElementList<SectionSpring<2>>>;
  Lists lists;
  std::vector<CirculatoryLoad> circulatory;  ///< loads without an energy
};

/// Calls `f(list)` for each kind of element.
template <class Elements, class F>
void for_each_list(Elements&& elements, F&& f) {
  std::apply([&](auto&&... list) { (f(list), ...); }, elements.lists);
}

}  // namespace der
