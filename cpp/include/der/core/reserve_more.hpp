#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace der {

/// Lets a list take `count` more entries without another allocation. A list that is made longer
/// again and again still grows by factors, and not by each of the counts.
template <class T>
void reserve_more(std::vector<T>& list, std::size_t count) {
  const std::size_t needed = list.size() + count;
  if (needed > list.capacity()) list.reserve(std::max(needed, 2 * list.capacity()));
}

}  // namespace der
