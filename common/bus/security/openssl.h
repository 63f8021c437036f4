// SPDX-License-Identifier: Apache-2.0
// OpenSSL's objects with owners. Inside the security room only.
#pragma once

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>

#include <filesystem>
#include <memory>
#include <string>

#include "common/bus/security/roles.h"

namespace telekerf::security {

template <auto kFree>
struct Freed {
  template <class Object>
  void operator()(Object* object) const noexcept {
    kFree(object);
  }
};
using KeyPointer = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using CertificatePointer = std::unique_ptr<X509, Freed<X509_free>>;
using X509NamePointer = std::unique_ptr<X509_NAME, Freed<X509_NAME_free>>;
using BioPointer = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Pkcs7Pointer = std::unique_ptr<PKCS7, Freed<PKCS7_free>>;

/// O=Telekerf, OU=cell, CN=common_name, in this order. `cell` empty: without it.
X509NamePointer subject_name(const std::string& cell, const std::string& common_name);

/// Null: not there, or not what it should be.
CertificatePointer read_certificate(const std::filesystem::path& file);
KeyPointer read_key(const std::filesystem::path& file);

/// Of its DER bytes, see roles.h.
SubjectPrefix prefix_of(const X509_NAME* name);

/// As RFC 2253 writes it.
std::string text_of(const X509_NAME* name);

}  // namespace telekerf::security
