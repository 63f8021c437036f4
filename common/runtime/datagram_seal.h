// SPDX-License-Identifier: Apache-2.0
// What keeps a stranger's datagrams from a device: sixteen octets behind each one, if both ends have the same
// key.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace telekerf {

/// Behind a datagram stand its sender's wall clock (ns since 1970, little endian, 8 octets) and the first 8
/// octets of HMAC-SHA256 over both. What is older than kMaxAge_ns, or as far ahead, was recorded; so was what
/// was sealed no later than the newest that this object has opened, or than it was made, whoever sends it and
/// however long there was silence: nothing is opened twice. For one direction and one thread.
class DatagramSeal {
 public:
  static constexpr std::size_t kBytes = 16;
  static constexpr std::int64_t kMaxAge_ns = 2'000'000'000;

  /// None: datagrams go as they are.
  DatagramSeal() = default;
  /// `key_file`: 64 hexadecimal digits, as ./telekerf keys writes them; empty: none. Throws StartupError.
  explicit DatagramSeal(const std::string& key_file);

  /// What is sent: `datagram` and its seal. Allocates nothing.
  template <class Datagram>
  struct Sealed {
    Datagram datagram;
    std::array<std::uint8_t, kBytes> seal{};
  };
  template <class Datagram>
  std::size_t close(Sealed<Datagram>& sealed) const noexcept {
    static_assert(sizeof(Sealed<Datagram>) == sizeof(Datagram) + kBytes);
    return close(std::as_writable_bytes(std::span(&sealed, 1)), sizeof(Datagram));
  }
  /// Octets of the datagram in `size` octets that have come; 0: it is not sealed as it must be, or longer.
  template <class Datagram>
  std::size_t open(const Sealed<Datagram>& sealed, std::size_t size) noexcept {
    if (size > sizeof(sealed)) return 0;
    return open(std::as_bytes(std::span(&sealed, 1)).first(size));
  }

  /// Writes the seal behind the first `size` octets; the size of the whole. `whole` has room for both.
  std::size_t close(std::span<std::byte> whole, std::size_t size) const noexcept;
  std::size_t open(std::span<const std::byte> whole) noexcept;

 private:
  static std::vector<std::uint8_t> read(const std::string& key_file);
  std::array<std::uint8_t, 8> code(std::span<const std::byte> sealed) const noexcept;

  bool keyed_ = false;
  std::int64_t newest_ns_ = 0;                      ///< stamp of the newest that was opened
  std::array<std::uint8_t, 64> inner_{}, outer_{};  ///< the key, padded as RFC 2104 says
};

}  // namespace telekerf
