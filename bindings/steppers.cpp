#include <pybind11/stl.h>

#include <vector>

#include "bindings.hpp"
#include "der/steppers/stepper.hpp"

namespace der::python {

void bind_steppers(py::module_& module) {
  py::class_<StepperInfo>(module, "StepperInfo", "Facts about a time integrator.")
      .def_readonly("name", &StepperInfo::name, "As `time.integrator` names it.")
      .def_readonly(
          "order", &StepperInfo::order,
          "Order of convergence in the time step; 2 at most in space, where sections twist.")
      .def_readonly("implicit", &StepperInfo::implicit, "Solves equations in every step.")
      .def_readonly("keeps_angular_momentum", &StepperInfo::keeps_angular_momentum,
                    "In free flight, to the solver's tolerance; in space, where sections twist, to "
                    "the order.")
      .def_readonly("step_cost", &StepperInfo::step_cost,
                    "Cost of a step, against one of an implicit stepper of one stage.")
      .def_readonly("stability", &StepperInfo::stability, "In words.")
      .def_readonly("damping", &StepperInfo::damping, "Numerical damping, in words.")
      .def("__repr__", [](const StepperInfo& info) {
        return py::str("<StepperInfo {} (order {})>").format(info.name, info.order);
      });
  module.def("steppers", [] { return stepper_registry(); }, "Every time integrator there is.");
}

}  // namespace der::python
