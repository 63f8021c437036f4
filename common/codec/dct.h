// SPDX-License-Identifier: Apache-2.0
// Orthonormal discrete cosine transform of one block (eq. 162-163; its inverse is eq. 164 as corrected).
#pragma once

#include <span>
#include <vector>

namespace telekerf::codec {

inline constexpr int kMinTransform = 4;
inline constexpr int kMaxBlock = 64;

/// c(k) = sqrt(2/N) C(k) sum_n x(n) cos((2n+1) k pi / 2N), x = transposed matrix times c. Orthonormal, so
/// energies agree (Parseval) and the error of a block is the energy of what was dropped or rounded. The
/// cosine rows are even or odd about the block's middle, which halves the products.
class Dct {
 public:
  /// The shared, immutable table for N = `size` (4..64). The first call of the program builds all tables:
  /// call it outside the loop. After that it is a plain look-up.
  static const Dct& of_size(int size) noexcept;

  int size() const noexcept { return size_; }
  /// x: N samples, oldest first; c: N coefficients.
  void forward(std::span<const double> x, std::span<double> c) const noexcept;
  /// Coefficients that are zero cost nothing.
  void inverse(std::span<const double> c, std::span<double> x) const noexcept;

 private:
  explicit Dct(int size);

  int size_;
  int half_;                         // ceil(N / 2)
  int stride_;                       // half, rounded up to whole chunks
  std::vector<double> even_;         // [n][j]: row 2j at sample n, n < half, j < stride
  std::vector<double> odd_;          // [n][j]: row 2j+1 at sample n
  std::vector<double> even_by_row_;  // [j][n]
  std::vector<double> odd_by_row_;
};

}  // namespace telekerf::codec
