// SPDX-License-Identifier: Apache-2.0
#include "common/vision/extraction/thinning.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

namespace telekerf::vision {
namespace {

/// Drawn pixels as bits, 64 to a word, with an empty word or row all around. The lowest bit is the leftmost
/// pixel.
class Bits {
 public:
  explicit Bits(const cv::Mat& drawn)
      : columns_(drawn.cols),
        rows_(drawn.rows),
        stride_(static_cast<std::size_t>((drawn.cols + 63) / 64) + 2) {
    words_.assign(stride_ * static_cast<std::size_t>(rows_ + 2), 0);
    for (int y = 0; y < rows_; ++y) {
      const auto* row = drawn.ptr<unsigned char>(y);
      int x = 0;
      for (; x + 8 <= columns_; x += 8) {  // the lowest bits of eight pixels (0 or 255) at a time
        std::uint64_t eight = 0;
        std::memcpy(&eight, row + x, 8);
        if (eight == 0) continue;
        const std::uint64_t bits = (eight & 0x0101010101010101U) * 0x0102040810204080U >> 56;
        words_[index(x, y)] |= bits << x % 64;
      }
      for (; x < columns_; ++x) words_[index(x, y)] |= std::uint64_t{row[x] & 1U} << x % 64;
    }
  }

  std::uint64_t& operator[](std::size_t i) { return words_[i]; }
  std::size_t size() const { return words_.size(); }
  std::size_t stride() const { return stride_; }

  cv::Mat image() const {
    cv::Mat out(rows_, columns_, CV_8U, cv::Scalar(0));
    for (int y = 0; y < rows_; ++y) {
      auto* row = out.ptr<unsigned char>(y);
      for (int x = 0; x < columns_; x += 64) {
        for (std::uint64_t left = words_[index(x, y)]; left != 0; left &= left - 1)
          row[x + std::countr_zero(left)] = 255;
      }
    }
    return out;
  }

  /// Pixels of one word that Guo and Hall's first or second half step takes away.
  std::uint64_t taken(std::size_t i, bool first) const {
    const std::uint64_t p2 = words_[i - stride_];
    const std::uint64_t p3 = east(i - stride_);
    const std::uint64_t p4 = east(i);
    const std::uint64_t p5 = east(i + stride_);
    const std::uint64_t p6 = words_[i + stride_];
    const std::uint64_t p7 = west(i + stride_);
    const std::uint64_t p8 = west(i);
    const std::uint64_t p9 = west(i - stride_);
    const std::uint64_t c1 = ~p2 & (p3 | p4);
    const std::uint64_t c2 = ~p4 & (p5 | p6);
    const std::uint64_t c3 = ~p6 & (p7 | p8);
    const std::uint64_t c4 = ~p8 & (p9 | p2);
    const std::uint64_t one_crossing = ((c1 ^ c2) & ~(c3 | c4)) | ((c3 ^ c4) & ~(c1 | c2));
    const std::uint64_t n1 = two_of(p9 | p2, p3 | p4, p5 | p6, p7 | p8);
    const std::uint64_t n2 = two_of(p2 | p3, p4 | p5, p6 | p7, p8 | p9);
    const std::uint64_t all =
        (p9 | p2) & (p3 | p4) & (p5 | p6) & (p7 | p8) & (p2 | p3) & (p4 | p5) & (p6 | p7) & (p8 | p9);
    const std::uint64_t kept = first ? (p6 | p7 | ~p9) & p8 : (p2 | p3 | ~p5) & p4;
    return words_[i] & one_crossing & n1 & n2 & ~all & ~kept;
  }

 private:
  static std::uint64_t two_of(std::uint64_t a, std::uint64_t b, std::uint64_t c, std::uint64_t d) {
    return (a & b) | (c & d) | ((a | b) & (c | d));
  }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y + 1) * stride_ + static_cast<std::size_t>(x / 64 + 1);
  }
  std::uint64_t east(std::size_t i) const { return words_[i] >> 1 | words_[i + 1] << 63; }
  std::uint64_t west(std::size_t i) const { return words_[i] << 1 | words_[i - 1] >> 63; }

  int columns_;
  int rows_;
  std::size_t stride_;
  std::vector<std::uint64_t> words_;
};

}  // namespace

cv::Mat thinned(const cv::Mat& drawn) {
  Bits bits(drawn);
  const std::size_t stride = bits.stride();
  // A pixel's fate depends on its neighbours and on which half step it is: a word that has outlived both is
  // not looked at again until one of the words around it changes.
  std::vector<unsigned char> due(bits.size(), 0);  // half steps to go
  std::vector<std::size_t> active;
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (bits[i] == 0) continue;
    due[i] = 2;
    active.push_back(i);
  }
  std::vector<std::pair<std::size_t, std::uint64_t>> taken;
  for (int step = 0; !active.empty(); ++step) {
    taken.clear();
    std::erase_if(active, [&](std::size_t i) {
      if (const std::uint64_t mask = bits.taken(i, step % 2 == 0); mask != 0) taken.emplace_back(i, mask);
      return --due[i] == 0;
    });
    for (const auto& [word, mask] : taken) {
      bits[word] &= ~mask;
      // The words beside it see its outermost pixels only.
      const std::size_t first = (mask & 1) != 0 ? word - 1 : word;
      const std::size_t last = mask >> 63 != 0 ? word + 1 : word;
      for (const std::size_t up : {stride, std::size_t{0}, std::size_t{0} - stride}) {
        for (std::size_t i = first - up; i != last - up + 1; ++i) {
          if (bits[i] == 0) continue;
          if (due[i] == 0) active.push_back(i);
          due[i] = 2;
        }
      }
    }
  }
  return bits.image();
}

}  // namespace telekerf::vision
