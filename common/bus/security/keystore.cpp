// SPDX-License-Identifier: Apache-2.0
#include "common/bus/security/keystore.h"

#include <fmt/format.h>
#include <openssl/ec.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "common/bus/security/documents.h"
#include "common/bus/security/openssl.h"
#include "common/bus/security/roles.h"
#include "common/runtime/startup_error.h"

namespace telekerf::security {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

constexpr auto kOwnerOnly = fs::perms::owner_read | fs::perms::owner_write;

[[noreturn]] void cannot(const std::string& what, const fs::path& file) {
  throw environment_error(
      fmt::format("{}: {}; look at the folder's rights and its disk", file.string(), what));
}

/// Makes what is written in its scope readable by its owner alone from the beginning.
class PrivateFiles {
 public:
  PrivateFiles() : before_(::umask(0077)) {}
  ~PrivateFiles() { ::umask(before_); }
  PrivateFiles(const PrivateFiles&) = delete;
  PrivateFiles& operator=(const PrivateFiles&) = delete;

 private:
  mode_t before_;
};

template <class Write>
void write_file(const fs::path& file, Write write) {
  const BioPointer out(BIO_new_file(file.c_str(), "wb"));
  if (!out || write(out.get()) != 1 || BIO_flush(out.get()) != 1) cannot("cannot be written", file);
  fs::permissions(file, kOwnerOnly);
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) cannot("the folder cannot be made: " + error.message(), folder);
}

void add_extension(X509* certificate, X509* issuer, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  X509_EXTENSION* const extension = X509V3_EXT_conf_nid(nullptr, &context, kind, value);
  X509_add_ext(certificate, extension, -1);
  X509_EXTENSION_free(extension);
}

struct Life {
  std::chrono::system_clock::time_point begin, end;
};

Life lasting(seconds life) {
  const auto now = std::chrono::system_clock::now();
  return {now - std::min<seconds>(kDay, life), now + life};
}

CertificatePointer blank_certificate(const X509_NAME* subject, EVP_PKEY* key, const Life& life) {
  CertificatePointer made(X509_new());
  X509_set_version(made.get(), 2);  // X.509 v3
  std::uint64_t number = 0;
  RAND_bytes(reinterpret_cast<unsigned char*>(&number), sizeof number);
  ASN1_INTEGER_set_uint64(X509_get_serialNumber(made.get()), number >> 1 | 1);
  ASN1_TIME_set(X509_getm_notBefore(made.get()), std::chrono::system_clock::to_time_t(life.begin));
  ASN1_TIME_set(X509_getm_notAfter(made.get()), std::chrono::system_clock::to_time_t(life.end));
  X509_set_subject_name(made.get(), subject);
  X509_set_pubkey(made.get(), key);
  return made;
}

struct Authority {
  CertificatePointer certificate;
  KeyPointer key;
};

void write_pair(const fs::path& certificate_file, const fs::path& key_file, X509* certificate,
                EVP_PKEY* key) {
  write_file(certificate_file, [&](BIO* out) { return PEM_write_bio_X509(out, certificate); });
  write_file(key_file, [&](BIO* out) {
    return PEM_write_bio_PrivateKey(out, key, nullptr, nullptr, 0, nullptr, nullptr);
  });
}

/// Which authorities there are: its file's name, what its certificate calls it, and what its key is for.
struct AuthorityKind {
  const char* name;
  const char* title;
  const char* usage;
};
constexpr AuthorityKind kIdentities{"identity_ca", "identity CA", "critical,keyCertSign,cRLSign"};
constexpr AuthorityKind kPermissions{"permissions_ca", "permissions CA",
                                     "critical,keyCertSign,cRLSign,digitalSignature"};

CertificatePointer authority_certificate(const AuthorityKind& kind, EVP_PKEY* key) {
  const X509NamePointer subject = subject_name("", kind.title);
  CertificatePointer made = blank_certificate(subject.get(), key, lasting(kAuthorityLife));
  X509* const certificate = made.get();
  X509_set_issuer_name(certificate, subject.get());
  add_extension(certificate, certificate, NID_subject_key_identifier, "hash");
  add_extension(certificate, certificate, NID_basic_constraints, "critical,CA:TRUE");
  add_extension(certificate, certificate, NID_key_usage, kind.usage);
  X509_sign(certificate, key, EVP_sha256());
  return made;
}

Authority make_authority(const fs::path& store, const AuthorityKind& kind) {
  Authority made;
  made.key.reset(EVP_EC_gen("P-256"));
  made.certificate = authority_certificate(kind, made.key.get());
  const std::string name = kind.name;
  write_pair(store / (name + ".pem"), store / (name + ".key"), made.certificate.get(), made.key.get());
  return made;
}

Authority read_authority(const fs::path& store, const AuthorityKind& kind) {
  const std::string name = kind.name;
  Authority read{read_certificate(store / (name + ".pem")), read_key(store / (name + ".key"))};
  for (const auto& [there, file] : {std::pair{read.certificate != nullptr, name + ".pem"},
                                    std::pair{read.key != nullptr, name + ".key"}}) {
    if (!there)
      throw input_error(fmt::format(
          "{}: is not there or not readable: keys are renewed where the authorities' own keys are kept",
          (store / file).string()));
  }
  return read;
}

/// One that would end before what it is to sign gets new dates, under its name and with its key. The file of
/// its certificate then; empty: it lasts.
fs::path renew_authority(const fs::path& store, const AuthorityKind& kind, seconds life,
                         Authority& authority) {
  std::time_t until =
      std::chrono::system_clock::to_time_t(lasting(std::min<seconds>(life, kAuthorityLife)).end);
  if (X509_cmp_time(X509_get0_notAfter(authority.certificate.get()), &until) > 0) return {};
  authority.certificate = authority_certificate(kind, authority.key.get());
  const fs::path file = store / (std::string(kind.name) + ".pem");
  const fs::path fresh = store / (std::string(".") + kind.name + ".new");
  write_file(fresh, [&](BIO* out) { return PEM_write_bio_X509(out, authority.certificate.get()); });
  fs::rename(fresh, file);
  return file;
}

struct Authorities {
  Authority identity, permissions;
};

void write_document(const fs::path& file, const std::string& text, const Authority& by) {
  const std::string document = signed_document(text, by.certificate.get(), by.key.get());
  if (document.empty()) cannot("cannot be signed", file);
  write_file(file, [&](BIO* out) {
    return BIO_write(out, document.data(), static_cast<int>(document.size())) > 0 ? 1 : 0;
  });
}

void write_governance(const fs::path& store, const Authorities& by) {
  for (const bool wan : {false, true})
    write_document(governance_file(store, wan), governance_text(wan), by.permissions);
}

/// The one that is there stays: devices have it.
void write_device_key(const fs::path& file) {
  if (fs::exists(file)) return;
  std::array<unsigned char, 32> key{};
  RAND_bytes(key.data(), static_cast<int>(key.size()));
  std::string text;
  for (const unsigned char byte : key) text += fmt::format("{:02x}", byte);
  text += '\n';
  write_file(
      file, [&](BIO* out) { return BIO_write(out, text.data(), static_cast<int>(text.size())) > 0 ? 1 : 0; });
}

/// Into a folder beside, which then takes the old one's place.
void write_role(const fs::path& store, const std::string& cell, const Role& role, const Authorities& by,
                seconds life) {
  const Life span = lasting(std::min<seconds>(life, kAuthorityLife));
  const fs::path place = role_files(store, cell, role.name).key.parent_path();
  const fs::path fresh = place.parent_path() / fmt::format(".{}.new", role.name);
  const fs::path old = place.parent_path() / fmt::format(".{}.old", role.name);
  fs::remove_all(fresh);
  fs::remove_all(old);
  make_folder(fresh);

  const std::string name = common_name(cell, role.name);
  const KeyPointer key(EVP_EC_gen("P-256"));
  const X509NamePointer subject = subject_name(cell, name);
  const CertificatePointer made = blank_certificate(subject.get(), key.get(), span);
  X509* const certificate = made.get();
  X509_set_issuer_name(certificate, X509_get_subject_name(by.identity.certificate.get()));
  add_extension(certificate, by.identity.certificate.get(), NID_basic_constraints, "critical,CA:FALSE");
  add_extension(certificate, by.identity.certificate.get(), NID_key_usage, "critical,digitalSignature");
  add_extension(certificate, by.identity.certificate.get(), NID_ext_key_usage, "clientAuth,serverAuth");
  X509_sign(certificate, by.identity.key.get(), EVP_sha256());
  write_pair(fresh / "cert.pem", fresh / "key.pem", certificate, key.get());
  // The library takes permissions' dates for local time, wherever it runs: a day on either side.
  write_document(fresh / "permissions.smime",
                 permissions_text(cell, role, span.begin - kDay, span.end + kDay), by.permissions);

  if (fs::exists(place)) fs::rename(place, old);
  fs::rename(fresh, place);
  fs::remove_all(old);
}

void write_cells(const fs::path& store, const std::vector<std::string>& cells, const Authorities& by,
                 seconds life) {
  for (const std::string& cell : cells) {
    for (const Role& role : roles()) write_role(store, cell, role, by, life);
    write_device_key(device_key_file(store, cell));
  }
}

void refuse_names(const std::vector<std::string>& cells) {
  for (const std::string& cell : cells) {
    if (const std::string wrong = complaint_about_secured_cell(cell); !wrong.empty())
      throw usage_error(fmt::format("--cells: cell '{}' {}", cell, wrong));
  }
}

/// What the file system refuses is a sentence.
template <class Work>
void in_store(const fs::path& store, Work work) {
  const PrivateFiles guard;
  try {
    work();
  } catch (const fs::filesystem_error& error) {
    cannot(error.code().message(), error.path1().empty() ? store : error.path1());
  }
}

}  // namespace

RoleFiles role_files(const fs::path& store, const std::string& cell, const std::string& role) {
  const fs::path folder = store / "cells" / cell / role;
  return {folder / "cert.pem", folder / "key.pem", folder / "permissions.smime"};
}

fs::path device_key_file(const fs::path& store, const std::string& cell) {
  return store / "cells" / cell / "device.key";
}

fs::path governance_file(const fs::path& store, bool wan) {
  return store / (wan ? "governance_wan.smime" : "governance.smime");
}

std::vector<std::string> cells_of(const fs::path& store) {
  std::vector<std::string> cells;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(store / "cells", error)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory(error) && complaint_about_secured_cell(name).empty()) cells.push_back(name);
  }
  std::sort(cells.begin(), cells.end());
  return cells;
}

void make_keystore(const fs::path& store, const std::vector<std::string>& cells, seconds life) {
  refuse_names(cells);
  in_store(store, [&] {
    if (fs::exists(store) && (!fs::is_directory(store) || !fs::is_empty(store)))
      throw input_error(
          fmt::format("{}: is not an empty folder; --check looks at the keys in it, --renew makes new ones "
                      "from its authorities",
                      store.string()));
    make_folder(store);
    fs::permissions(store, kOwnerOnly | fs::perms::owner_exec);
    const Authorities by{make_authority(store, kIdentities), make_authority(store, kPermissions)};
    write_governance(store, by);
    write_cells(store, cells, by, life);
  });
}

std::vector<fs::path> renew_keystore(const fs::path& store, const std::vector<std::string>& more,
                                     seconds life) {
  refuse_names(more);
  std::vector<fs::path> renewed;
  in_store(store, [&] {
    Authorities by{read_authority(store, kIdentities), read_authority(store, kPermissions)};
    for (const fs::path& file : {renew_authority(store, kIdentities, life, by.identity),
                                 renew_authority(store, kPermissions, life, by.permissions)})
      if (!file.empty()) renewed.push_back(file);
    std::vector<std::string> cells = cells_of(store);
    for (const std::string& cell : more) {
      if (std::find(cells.begin(), cells.end(), cell) == cells.end()) cells.push_back(cell);
    }
    write_governance(store, by);
    write_cells(store, cells, by, life);
  });
  return renewed;
}

}  // namespace telekerf::security
