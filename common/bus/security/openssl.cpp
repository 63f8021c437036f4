// SPDX-License-Identifier: Apache-2.0
#include "common/bus/security/openssl.h"

#include <openssl/pem.h>
#include <openssl/sha.h>

namespace telekerf::security {
namespace {

BioPointer reading(const std::filesystem::path& file) { return BioPointer(BIO_new_file(file.c_str(), "rb")); }

}  // namespace

X509NamePointer subject_name(const std::string& cell, const std::string& common_name) {
  X509NamePointer name(X509_NAME_new());
  const auto add = [&](const char* field, const std::string& value) {
    X509_NAME_add_entry_by_txt(name.get(), field, MBSTRING_UTF8,
                               reinterpret_cast<const unsigned char*>(value.data()),
                               static_cast<int>(value.size()), -1, 0);
  };
  add("O", "Telekerf");
  if (!cell.empty()) add("OU", cell);
  add("CN", common_name);
  return name;
}

CertificatePointer read_certificate(const std::filesystem::path& file) {
  const BioPointer in = reading(file);
  return CertificatePointer(in ? PEM_read_bio_X509(in.get(), nullptr, nullptr, nullptr) : nullptr);
}

KeyPointer read_key(const std::filesystem::path& file) {
  const BioPointer in = reading(file);
  return KeyPointer(in ? PEM_read_bio_PrivateKey(in.get(), nullptr, nullptr, nullptr) : nullptr);
}

SubjectPrefix prefix_of(const X509_NAME* name) {
  unsigned char* der = nullptr;
  const int size = i2d_X509_NAME(name, &der);
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> hash{};
  if (size > 0) SHA256(der, static_cast<std::size_t>(size), hash.data());
  OPENSSL_free(der);
  SubjectPrefix prefix{};
  unsigned carried = 1;  // the bit before
  for (std::size_t i = 0; i < prefix.size(); ++i) {
    prefix[i] = static_cast<std::uint8_t>(carried << 7 | hash[i] >> 1);
    carried = hash[i] & 1U;
  }
  return prefix;
}

std::string text_of(const X509_NAME* name) {
  const BioPointer out(BIO_new(BIO_s_mem()));
  X509_NAME_print_ex(out.get(), name, 0, XN_FLAG_RFC2253);
  char* text = nullptr;
  const long size = BIO_get_mem_data(out.get(), &text);
  return {text, static_cast<std::size_t>(size)};
}

}  // namespace telekerf::security
