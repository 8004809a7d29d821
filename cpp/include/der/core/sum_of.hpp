#pragma once

#include "der/core/types.hpp"

namespace der {

/// Sum of term(0) .. term(size - 1) in four partial sums. The order is the same for every number
/// type: a member of a batch has in its lane, to the last bit, what it has alone.
template <class T, class Term>
T sum_of(Index size, const Term& term) {
  T first = 0.0;
  T second = 0.0;
  T third = 0.0;
  T fourth = 0.0;
  Index i = 0;
  for (; i + 4 <= size; i += 4) {
    first += term(i);
    second += term(i + 1);
    third += term(i + 2);
    fourth += term(i + 3);
  }
  for (; i < size; ++i) first += term(i);
  return (first + second) + (third + fourth);
}

/// a . b of short vectors, in the order of their entries: Eigen's depends on the number type.
template <class Vec>
typename Vec::Scalar ordered_dot(const Vec& a, const Vec& b) {
  typename Vec::Scalar sum = a[0] * b[0];
  for (Index i = 1; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace der
