#pragma once

#include "der/energies/element_list.hpp"

namespace der {

struct ElementLists;  // energies/registry.hpp

/// The elements of one kind. Files that use some kinds include this and the headers of their
/// kernels, so that a new kernel does not recompile them; loops over all kinds include
/// registry.hpp.
template <class Kernel>
ElementList<Kernel>& elements_of(ElementLists& elements);
template <class Kernel>
const ElementList<Kernel>& elements_of(const ElementLists& elements);

}  // namespace der
