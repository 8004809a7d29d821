#pragma once

#include <array>
#include <optional>

#include "der/lanes/member_assembler.hpp"
#include "der/lanes/member_controls.hpp"
#include "der/lanes/member_frames.hpp"
#include "der/lanes/member_mass.hpp"
#include "der/lanes/member_model.hpp"
#include "der/solvers/newton.hpp"

namespace der {

/// The parts of several members that stay the same while they are stepped. `mass` is there for
/// methods that begin with an explicit stage.
template <class T>
struct Members {
  using Options = std::array<NewtonOptions, to_size(LaneTraits<T>::kCount)>;

  Members(const MemberModels<T>& models, const MemberStates<T>& states,
          const MemberAssemblers<T>& assemblers, const Options& options, bool with_mass)
      : model(models),
        frames(model),
        controls(model, states),
        assembler(model, assemblers, controls),
        newton(options) {
    if (with_mass) mass.emplace(model);
  }

  MemberModel<T> model;
  MemberFrames<T> frames;
  MemberControls<T> controls;
  MemberAssembler<T> assembler;
  Options newton;
  std::optional<MemberMass<T>> mass;
};

}  // namespace der
