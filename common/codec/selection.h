// SPDX-License-Identifier: Apache-2.0
// Which coefficients carry the energy, and the cheapest way to name them (Algorithm 4, corrected: rank by
// magnitude).
#pragma once

#include <cstdint>
#include <span>

namespace telekerf::codec {

/// Bit k set: coefficient k is kept.
using IndexSet = std::uint64_t;

/// {0..count-1}, of at most 64.
constexpr IndexSet first_indices(int count) noexcept {
  return count >= 64 ? ~IndexSet{0} : (IndexSet{1} << count) - 1;
}

/// The m coefficients of largest |c|: by Parseval no other m leave less error. Ties go to the lower index, so
/// that the choice is the same everywhere. At most 64 coefficients.
IndexSet strongest(std::span<const double> coefficients, int m) noexcept;

/// C(n, k) for n <= 64; exact.
std::uint64_t choose(int n, int k) noexcept;

/// Bits of the enumerative code: ceil(log2 C(n, m)), never more than a mask or a list of indices.
int index_set_bits(int n, int m) noexcept;
/// Rank of an m-subset of {0..n-1} among all of its size (combinatorial number system).
std::uint64_t rank_of(IndexSet set) noexcept;
/// Inverse of rank_of; `rank` must be below C(n, m).
IndexSet set_of_rank(std::uint64_t rank, int n, int m) noexcept;

}  // namespace telekerf::codec
