// SPDX-License-Identifier: Apache-2.0
// SHA256_* are called old in OpenSSL 3, but what takes their place allocates, and control loops seal.
#define OPENSSL_API_COMPAT 0x10100000L
#include "common/runtime/datagram_seal.h"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/sha.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

constexpr std::size_t kKeyBytes = 32;
constexpr std::size_t kStampBytes = 8;
constexpr std::uint8_t kInnerPad = 0x36, kOuterPad = 0x5c;

std::int64_t wall_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

std::vector<std::uint8_t> DatagramSeal::read(const std::string& key_file) {
  std::ifstream in(key_file);
  if (!in)
    throw configuration_error(fmt::format("key = {}: cannot be read; ./telekerf keys makes one", key_file));
  std::error_code error;
  const auto status = std::filesystem::status(key_file, error);
  using std::filesystem::perms;
  if (!error && (status.permissions() & (perms::group_all | perms::others_all)) != perms::none)
    throw configuration_error(fmt::format(
        "key = {}: can be read by others than its owner; remedy: chmod 600 {}", key_file, key_file));
  std::string text;
  in >> text;
  std::vector<std::uint8_t> key;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    const int high = digit(text[i]), low = digit(text[i + 1]);
    if (high < 0 || low < 0) break;
    key.push_back(static_cast<std::uint8_t>(high << 4 | low));
  }
  if (text.size() != 2 * kKeyBytes || key.size() != kKeyBytes)
    throw configuration_error(
        fmt::format("key = {}: must hold {} hexadecimal digits", key_file, 2 * kKeyBytes));
  return key;
}

DatagramSeal::DatagramSeal(const std::string& key_file) : keyed_(!key_file.empty()) {
  if (!keyed_) return;
  const std::vector<std::uint8_t> key = read(key_file);
  newest_ns_ = wall_ns();
  inner_.fill(kInnerPad);
  outer_.fill(kOuterPad);
  for (std::size_t i = 0; i < key.size(); ++i) {
    inner_[i] ^= key[i];
    outer_[i] ^= key[i];
  }
}

std::array<std::uint8_t, 8> DatagramSeal::code(std::span<const std::byte> sealed) const noexcept {
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> hash{};
  SHA256_CTX context;
  SHA256_Init(&context);
  SHA256_Update(&context, inner_.data(), inner_.size());
  SHA256_Update(&context, sealed.data(), sealed.size());
  SHA256_Final(hash.data(), &context);
  SHA256_Init(&context);
  SHA256_Update(&context, outer_.data(), outer_.size());
  SHA256_Update(&context, hash.data(), hash.size());
  SHA256_Final(hash.data(), &context);
  std::array<std::uint8_t, 8> first{};
  std::memcpy(first.data(), hash.data(), first.size());
  return first;
}

std::size_t DatagramSeal::close(std::span<std::byte> whole, std::size_t size) const noexcept {
  if (!keyed_) return size;
  const std::int64_t now_ns = wall_ns();
  std::memcpy(whole.data() + size, &now_ns, kStampBytes);
  const auto made = code(whole.first(size + kStampBytes));
  std::memcpy(whole.data() + size + kStampBytes, made.data(), made.size());
  return size + kBytes;
}

std::size_t DatagramSeal::open(std::span<const std::byte> whole) noexcept {
  if (!keyed_) return whole.size();
  if (whole.size() < kBytes) return 0;
  const std::size_t size = whole.size() - kBytes;
  const auto made = code(whole.first(size + kStampBytes));
  if (CRYPTO_memcmp(made.data(), whole.data() + size + kStampBytes, made.size()) != 0) return 0;
  std::int64_t sent_ns = 0;
  std::memcpy(&sent_ns, whole.data() + size, kStampBytes);
  const std::int64_t age_ns = wall_ns() - sent_ns;
  if (age_ns > kMaxAge_ns || age_ns < -kMaxAge_ns || sent_ns <= newest_ns_) return 0;
  newest_ns_ = sent_ns;
  return size;
}

}  // namespace telekerf
