// SPDX-License-Identifier: Apache-2.0
// Keystores for tests, in folders of this process' own.
#pragma once

#include <gtest/gtest.h>
#include <openssl/pem.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "common/bus/security/keystore.h"
#include "common/bus/security/openssl.h"

namespace telekerf::security {

/// Made at construction, gone at its end.
class Store {
 public:
  explicit Store(const std::vector<std::string>& cells = {"cell-1"},
                 std::chrono::seconds life = std::chrono::hours(24) * 365) {
    static int count = 0;
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("telekerf-keys-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
    std::filesystem::remove_all(folder_);
    make_keystore(folder_, cells, life);
  }
  ~Store() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path role(const std::string& role, const std::string& cell = "cell-1") const {
    return role_files(folder_, cell, role).key.parent_path();
  }
  void copy(const std::filesystem::path& from, const std::filesystem::path& to) const {
    std::filesystem::copy(from, to, std::filesystem::copy_options::overwrite_existing);
  }
  /// Gives one of the authorities' certificates another end, under its name and with its key.
  void end_authority(const std::string& name, std::chrono::seconds from_now) const {
    const CertificatePointer certificate = read_certificate(folder_ / (name + ".pem"));
    const KeyPointer key = read_key(folder_ / (name + ".key"));
    X509_gmtime_adj(X509_getm_notAfter(certificate.get()), from_now.count());
    X509_sign(certificate.get(), key.get(), EVP_sha256());
    const BioPointer out(BIO_new_file((folder_ / (name + ".pem")).c_str(), "wb"));
    PEM_write_bio_X509(out.get(), certificate.get());
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace telekerf::security
