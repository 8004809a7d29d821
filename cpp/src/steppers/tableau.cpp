#include "der/steppers/tableau.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace der {
namespace {

constexpr double kRootOfTwo = 1.41421356237309505;

}  // namespace

double Tableau::time(Index stage) const {
  const auto& row = below[to_size(stage)];
  return std::accumulate(row.begin(), row.end(), is_implicit(stage) ? diagonal : 0.0);
}

bool Tableau::stiffly_accurate() const {
  const auto last = to_size(stages - 1);
  return weights[last] == diagonal &&
         std::equal(below[last].begin(), below[last].begin() + (stages - 1), weights.begin());
}

bool Tableau::is_l_stable() const {
  if (stiffly_accurate()) return true;
  if (explicit_first) return false;
  // Each stage is then 0, so that its slope is minus what is there before it, over a_ii dt.
  constexpr double kRounding = 1e-10;  // of coefficients that are given to 13 digits
  std::array<double, to_size(kMaxStages)> slopes{};
  double result = 1.0;
  for (std::size_t i = 0; i < to_size(stages); ++i) {
    double before = 1.0;
    for (std::size_t j = 0; j < i; ++j) before += below[i][j] * slopes[j];
    slopes[i] = -before / diagonal;
    result += weights[i] * slopes[i];
  }
  return std::abs(result) < kRounding;
}

constexpr Tableau kImplicitEuler{1, false, 1.0, {}, {1.0}};

constexpr Tableau kImplicitMidpoint{1, false, 0.5, {}, {1.0}};

constexpr Tableau kTrBdf2{3,
                          true,
                          1.0 - 0.5 * kRootOfTwo,
                          {{{}, {1.0 - 0.5 * kRootOfTwo}, {0.25 * kRootOfTwo, 0.25 * kRootOfTwo}}},
                          {0.25 * kRootOfTwo, 0.25 * kRootOfTwo, 1.0 - 0.5 * kRootOfTwo}};

constexpr Tableau kSdirk4{5,
                          false,
                          1.0 / 4.0,
                          {{{},
                            {1.0 / 2.0},
                            {17.0 / 50.0, -1.0 / 25.0},
                            {371.0 / 1360.0, -137.0 / 2720.0, 15.0 / 544.0},
                            {25.0 / 24.0, -49.0 / 48.0, 125.0 / 16.0, -85.0 / 12.0}}},
                          {25.0 / 24.0, -49.0 / 48.0, 125.0 / 16.0, -85.0 / 12.0, 1.0 / 4.0}};

constexpr Tableau kSdirk5{
    5,
    false,
    4024571134387.0 / 14474071345096.0,
    {{{},
      {9365021263232.0 / 12572342979331.0},
      {2144716224527.0 / 9320917548702.0, -397905335951.0 / 4008788611757.0},
      {-291541413000.0 / 6267936762551.0, 226761949132.0 / 4473940808273.0,
       -1282248297070.0 / 9697416712681.0},
      {-2481679516057.0 / 4626464057815.0, -197112422687.0 / 6604378783090.0,
       3952887910906.0 / 9713059315593.0, 4906835613583.0 / 8134926921134.0}}},
    {-2522702558582.0 / 12162329469185.0, 1018267903655.0 / 12907234417901.0,
     4542392826351.0 / 13702606430957.0, 5001116467727.0 / 12224457745473.0,
     1509636094297.0 / 3891594770934.0}};

const Tableau* find_tableau(std::string_view integrator) {
  constexpr std::array<std::pair<std::string_view, const Tableau*>, 5> kTableaus{{
      {"implicit_euler", &kImplicitEuler},
      {"implicit_midpoint", &kImplicitMidpoint},
      {"tr_bdf2", &kTrBdf2},
      {"sdirk4", &kSdirk4},
      {"sdirk5", &kSdirk5},
  }};
  for (const auto& [name, tableau] : kTableaus) {
    if (name == integrator) return tableau;
  }
  return nullptr;
}

}  // namespace der
