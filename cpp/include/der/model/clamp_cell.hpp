#pragma once

namespace der {

// The cell of a clamp, as shares of the edge beside it (supports/clamp.hpp says where they come
// from).

/// Where the edge begins, on the held tangent, and where the moment of the cell acts.
inline constexpr double kPivotShare = 1.0 / 5.0;
/// Over this the edge turns against the held tangent. So far from the clamp the rod's tangent has
/// the direction of the edge, a little beyond the middle.
inline constexpr double kCellShare = 25.0 / 48.0;
/// By so much less the next node turns: kCellShare - 1/2.
inline constexpr double kFirstVertexCorrection = 1.0 / 48.0;

}  // namespace der
