// Sums that are the same in 2D and 3D.
#include <houle/water/energy.hpp>

namespace houle {

double total(index n, const double* value) {
  constexpr index block = 1024, lanes = 8;
  const index blocks = (n + block - 1) / block;
  std::vector<double> part(static_cast<std::size_t>(blocks), 0.0);
  double* parts = part.data();
  parallel_for(
      blocks,
      [=](index b) {
        double lane[lanes] = {};
        const index end = std::min(n, (b + 1) * block);
        index i = b * block;
        for (; i + lanes <= end; i += lanes)
          for (index k = 0; k < lanes; ++k) lane[k] += value[i + k];
        for (; i < end; ++i) lane[i % lanes] += value[i];
        parts[b] = ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
      },
      4);
  for (index apart = 1; apart < blocks; apart *= 2)
    for (index b = 0; b + apart < blocks; b += 2 * apart) parts[b] += parts[b + apart];
  return blocks > 0 ? parts[0] : 0.0;
}

bool all_finite(index n, const double* x) {
  return sum_by_four(n, [=](index i) { return x[i] - x[i]; }) == 0.0;
}

double weighted_sum(index n, const double* weight, const double* value, index stride) {
  return sum_by_four(n, [=](index p) { return weight[p] * value[p * stride]; });
}

}  // namespace houle
