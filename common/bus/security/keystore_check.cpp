// SPDX-License-Identifier: Apache-2.0
#include "common/bus/security/keystore_check.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/objects.h>
#include <openssl/x509v3.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/bus/security/documents.h"
#include "common/bus/security/keystore.h"
#include "common/bus/security/openssl.h"
#include "common/bus/security/roles.h"

namespace telekerf::security {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRenew = "./telekerf keys DIR --renew makes it anew";
constexpr const char* kNotReadable =
    "may not be read by this user: the keys belong to whoever starts the processes; remedy: start it as "
    "their owner";
constexpr auto kOthers = fs::perms::group_all | fs::perms::others_all;

Time time_of(const ASN1_TIME* time) {
  std::tm parts{};
  ASN1_TIME_to_tm(time, &parts);
  return std::chrono::system_clock::from_time_t(timegm(&parts));
}

/// What is found, file by file.
class Check {
 public:
  Check(fs::path store, Time now) : store_(std::move(store)), now_(now) {}

  KeystoreReport report;

  void authorities() {
    identity_ca_ = authority("identity_ca.pem");
    permissions_ca_ = authority("permissions_ca.pem");
    if (!identity_ca_ || !permissions_ca_) return;
    if (X509_NAME_cmp(X509_get_subject_name(identity_ca_.get()),
                      X509_get_subject_name(permissions_ca_.get())) == 0 ||
        EVP_PKEY_eq(X509_get0_pubkey(identity_ca_.get()), X509_get0_pubkey(permissions_ca_.get())) == 1)
      fault(store_ / "permissions_ca.pem",
            "is the identities' authority as well, so that every identity could sign its own permissions; "
            "make two "
            "with ./telekerf keys");
  }

  void governance(bool wan) {
    const fs::path file = governance_file(store_, wan);
    if (!readable(file) || !permissions_ca_) return;
    const auto text = verified_document(file, permissions_ca_.get());
    if (!text) return fault(file, fmt::format("is not signed by permissions_ca.pem; {}", kRenew));
    if (const std::string wrong = difference_from_governance(*text, wan); !wrong.empty())
      fault(file, fmt::format("does not protect as it should: it says {}; {}", wrong, kRenew));
  }

  void role(const std::string& cell, const Role& role) {
    const RoleFiles files = role_files(store_, cell, role.name);
    if (!folder(files.certificate.parent_path()) || !readable(files.certificate)) return;
    const CertificatePointer certificate = read_certificate(files.certificate);
    if (!certificate) return fault(files.certificate, fmt::format("is no certificate; {}", kRenew));
    ++report.identities;
    const std::string subject = subject_of(cell, common_name(cell, role.name));
    identity(files.certificate, certificate.get(), cell, role, subject);
    key(files.key, certificate.get());
    permissions(files.permissions, cell, role, subject);
  }

  /// Whoever may write a folder may put keys of its own there. False: nothing in it can be looked at.
  bool folder(const fs::path& folder) {
    std::error_code error;
    const auto status = fs::status(folder, error);
    if (error == std::errc::permission_denied ||
        (fs::is_directory(status) && ::access(folder.c_str(), R_OK | X_OK) != 0)) {
      fault(folder, kNotReadable);
      return false;
    }
    constexpr auto kWritten = fs::perms::group_write | fs::perms::others_write;
    if (fs::is_directory(status) && (status.permissions() & kWritten) != fs::perms::none)
      fault(folder,
            fmt::format("can be written by others than its owner (mode {:o}), who could put other keys "
                        "there; remedy: chmod 700 {}",
                        static_cast<unsigned>(status.permissions() & fs::perms::mask), folder.string()));
    return true;
  }

  void private_file(const fs::path& file) {
    std::error_code error;
    if (const auto status = fs::status(file, error);
        !error && (status.permissions() & kOthers) != fs::perms::none)
      fault(file, fmt::format("can be read by others than its owner (mode {:o}); remedy: chmod 600 {}",
                              static_cast<unsigned>(status.permissions()), file.string()));
  }

 private:
  void fault(const fs::path& file, const std::string& what) {
    report.faults.push_back(fmt::format("{} {}", file.string(), what));
  }

  bool readable(const fs::path& file) {
    std::error_code error;
    const bool there = fs::is_regular_file(file, error);
    if (error == std::errc::permission_denied || (there && ::access(file.c_str(), R_OK) != 0)) {
      fault(file, kNotReadable);
      return false;
    }
    if (!there) {
      fault(file, "is not there; copy it from where the keys were made");
      return false;
    }
    private_file(file);
    return true;
  }

  void ends(const fs::path& file, Time begin, Time end, bool authority = false) {
    if (now_ < begin)
      fault(file, fmt::format("is not valid before {}; look at this computer's clock", text_of(begin)));
    if (now_ > end) fault(file, fmt::format("has expired on {}; {}", text_of(end), kRenew));
    if (!report.first_to_end || end < report.first_to_end->end)
      report.first_to_end = Validity{begin, end, file.string(), authority};
  }

  CertificatePointer authority(const char* name) {
    const fs::path file = store_ / name;
    if (!readable(file)) return nullptr;
    CertificatePointer certificate = read_certificate(file);
    if (!certificate) {
      fault(file, "is no certificate; make new keys in another folder");
      return nullptr;
    }
    signature(file, certificate.get());
    if (X509_check_ca(certificate.get()) != 1) fault(file, "is not made to sign others; make new keys");
    ends(file, time_of(X509_get0_notBefore(certificate.get())),
         time_of(X509_get0_notAfter(certificate.get())), true);
    return certificate;
  }

  void signature(const fs::path& file, X509* certificate) {
    const int kind = X509_get_signature_nid(certificate);
    if (kind != NID_ecdsa_with_SHA256 && kind != NID_sha256WithRSAEncryption)
      fault(file,
            fmt::format("is signed with {}; the middleware takes ECDSA or RSA with SHA-256 and nothing else",
                        OBJ_nid2sn(kind)));
  }

  void identity(const fs::path& file, X509* certificate, const std::string& cell, const Role& role,
                const std::string& subject) {
    signature(file, certificate);
    const std::string said = security::text_of(X509_get_subject_name(certificate));
    if (said != subject) {
      fault(file, fmt::format("names {} and must name {}, in this order; {}", said, subject, kRenew));
    } else if (prefix_of(X509_get_subject_name(certificate)) !=
               prefix_of(cell, common_name(cell, role.name))) {
      fault(file, fmt::format("names {} in another encoding than UTF-8, and would not be known by it; {}",
                              said, kRenew));
    }
    ends(file, time_of(X509_get0_notBefore(certificate)), time_of(X509_get0_notAfter(certificate)));
    if (identity_ca_ && (X509_check_issued(identity_ca_.get(), certificate) != X509_V_OK ||
                         X509_verify(certificate, X509_get0_pubkey(identity_ca_.get())) != 1))
      fault(file, fmt::format("is not signed by identity_ca.pem; {}", kRenew));
    const std::uint32_t usage = X509_get_extended_key_usage(certificate);
    constexpr std::uint32_t kWanted = XKU_SSL_CLIENT | XKU_SSL_SERVER;
    if ((X509_get_extension_flags(certificate) & EXFLAG_XKUSAGE) == 0 || (usage & kWanted) != kWanted)
      fault(file, fmt::format("lacks extendedKeyUsage clientAuth, serverAuth; {}", kRenew));
    if (X509_check_ca(certificate) != 0) fault(file, fmt::format("could sign others; {}", kRenew));
  }

  void key(const fs::path& file, X509* certificate) {
    std::error_code error;
    if (!fs::exists(file, error)) {
      report.notes.push_back(file.string() + " is not here");
      return;
    }
    if (!readable(file)) return;
    const KeyPointer read = read_key(file);
    if (!read) return fault(file, fmt::format("is no private key; {}", kRenew));
    if (X509_check_private_key(certificate, read.get()) != 1)
      fault(file, fmt::format("does not belong to the certificate beside it; {}", kRenew));
  }

  void permissions(const fs::path& file, const std::string& cell, const Role& role,
                   const std::string& subject) {
    if (!readable(file) || !permissions_ca_) return;
    const auto text = verified_document(file, permissions_ca_.get());
    if (!text) return fault(file, fmt::format("is not signed by permissions_ca.pem; {}", kRenew));
    const auto grants = read_permissions(*text);
    if (!grants) return fault(file, fmt::format("is not understood: {}; {}", grants.error(), kRenew));
    const Grant& grant = grants->front();
    if (grant.subject != subject)
      return fault(file, fmt::format("grants something to {} and nothing to {}, in this order; {}",
                                     grant.subject, subject, kRenew));
    if (grants->size() > 1)
      fault(file,
            fmt::format("holds another grant, to {}, and must hold one; {}", (*grants)[1].subject, kRenew));
    const auto begin = local_time(grant.not_before), end = local_time(grant.not_after);
    if (!begin || !end) return fault(file, fmt::format("has no dates; {}", kRenew));
    ends(file, *begin, *end);
    rights(file, cell, role, grant);
  }

  void rights(const fs::path& file, const std::string& cell, const Role& role, const Grant& grant) {
    if (grant.otherwise != "DENY")
      fault(file,
            fmt::format("says {} of what no rule names, and must say DENY; {}", grant.otherwise, kRenew));
    for (const Rule& rule : grant.rules) place(file, cell, rule);
    for (const bool publish : {true, false}) {
      const auto& wanted = publish ? role.publishes : role.subscribes;
      const char* const what = publish ? "publish" : "subscribe to";
      for (const char* topic : wanted) {
        const Rule* const rule = deciding_rule(grant, publish, topic);
        if (rule == nullptr) {
          fault(file, fmt::format("does not let it {} {}; {}", what, topic, kRenew));
        } else if (!rule->allow) {
          fault(file, fmt::format("does not let it {} {}: a deny rule comes first; {}", what, topic, kRenew));
        }
      }
      std::set<std::string> more;
      for (const Rule& rule : grant.rules)
        if (rule.allow && rule.publish == publish) more.insert(rule.topics.begin(), rule.topics.end());
      for (const char* topic : wanted) more.erase(topic);
      for (const std::string& topic : more)
        fault(file, fmt::format("lets it {} {}, which is not its to do; {}", what, topic, kRenew));
    }
  }

  /// A rule that allows something does so in the whole of this cell, and nowhere else.
  void place(const fs::path& file, const std::string& cell, const Rule& rule) {
    if (!rule.allow) return;
    const std::string on =
        fmt::format("has a rule on {}", rule.topics.empty() ? "no topic" : rule.topics.front());
    if (rule.partitions != std::vector<std::string>{cell})
      fault(file, fmt::format("{} for partition '{}' and not for {} alone; {}", on,
                              fmt::join(rule.partitions, "', '"), cell, kRenew));
    int next = 0;  // the first domain that none of its ranges holds
    for (const auto& [first, last] : rule.domains) {
      if (std::max(first, last) > kHighestSecuredDomain)
        fault(file, fmt::format("names domain {}: other vendors' programs take none above {}; {}",
                                std::max(first, last), kHighestSecuredDomain, kRenew));
      if (first <= next && last >= next) next = last + 1;
    }
    if (next <= kHighestSecuredDomain)
      fault(file, fmt::format("{} that does not hold in domain {}, and must in all from 0 to {}; {}", on,
                              next, kHighestSecuredDomain, kRenew));
  }

  fs::path store_;
  Time now_;
  CertificatePointer identity_ca_, permissions_ca_;
};

}  // namespace

KeystoreReport check_keystore(const fs::path& store, Time now) {
  Check check(store, now);
  if (!check.folder(store) || !check.folder(store / "cells")) return check.report;
  check.authorities();
  for (const bool wan : {false, true}) check.governance(wan);
  for (const char* name : {"identity_ca.key", "permissions_ca.key"}) check.private_file(store / name);
  const std::vector<std::string> cells = cells_of(store);
  if (cells.empty())
    check.report.faults.push_back((store / "cells").string() + " holds no cell; ./telekerf keys makes them");
  for (const std::string& cell : cells) {
    if (!check.folder(store / "cells" / cell)) continue;
    check.private_file(device_key_file(store, cell));
    for (const Role& role : roles()) check.role(cell, role);
  }
  return check.report;
}

KeystoreReport check_role(const fs::path& store, const std::string& cell, const std::string& role, bool wan,
                          Time now) {
  Check check(store, now);
  const Role* const known = find_role(role);
  if (known == nullptr) {
    check.report.faults.push_back(fmt::format("there are no keys for a {}", role));
    return check.report;
  }
  for (const fs::path& folder : {store, store / "cells", store / "cells" / cell})
    if (!check.folder(folder)) return check.report;
  check.authorities();
  check.governance(wan);
  check.role(cell, *known);
  if (check.report.faults.empty() && !fs::exists(role_files(store, cell, role).key))
    check.report.faults.push_back(fmt::format("{} is not there; copy it from where the keys were made",
                                              role_files(store, cell, role).key.string()));
  return check.report;
}

std::optional<Time> certificate_end(const fs::path& file) {
  const CertificatePointer certificate = read_certificate(file);
  if (!certificate) return std::nullopt;
  return time_of(X509_get0_notAfter(certificate.get()));
}

int days_left(Time end, Time now) {
  return static_cast<int>(std::floor(std::chrono::duration<double, std::ratio<86400>>(end - now).count()));
}

std::string text_of(Time time) {
  return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

}  // namespace telekerf::security
