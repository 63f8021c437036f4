// SPDX-License-Identifier: Apache-2.0
// The keys of a cell: what is made, what is found wrong with it, and what is made anew.
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "common/bus/security/documents.h"
#include "common/bus/security/keystore_check.h"
#include "common/bus/security/openssl.h"
#include "common/bus/security/roles.h"
#include "common/runtime/startup_error.h"
#include "tests/unit/security/store.h"

namespace telekerf::security {
namespace {

namespace fs = std::filesystem;
using std::chrono::hours;

Time now() { return std::chrono::system_clock::now(); }

std::string contents(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The only fault that is found names `file` and says `what`.
void expect_fault(const Store& store, const fs::path& file, const std::string& what, Time at = now()) {
  const KeystoreReport report = check_keystore(store.folder(), at);
  const bool found = std::any_of(report.faults.begin(), report.faults.end(), [&](const std::string& fault) {
    return fault.starts_with(file.string()) && fault.find(what) != fault.npos;
  });
  std::string all;
  for (const std::string& fault : report.faults) all += fault + '\n';
  EXPECT_TRUE(found) << what << " of " << file << " is not among:\n" << all;
}

TEST(Keystore, WhatIsMadeIsGoodForEveryRoleAndForItsOwnerAlone) {
  const Store store({"left", "right"});
  const KeystoreReport report = check_keystore(store.folder(), now());
  EXPECT_TRUE(report.faults.empty()) << report.faults.front();
  EXPECT_EQ(report.identities, static_cast<int>(2 * roles().size()));
  ASSERT_TRUE(report.first_to_end);
  EXPECT_EQ(days_left(report.first_to_end->end, now()), 364);
  for (const Role& role : roles())
    EXPECT_TRUE(check_role(store.folder(), "right", role.name, true, now()).faults.empty()) << role.name;
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(store.folder())) {
    const auto others = fs::perms::group_all | fs::perms::others_all;
    EXPECT_EQ(entry.status().permissions() & others, fs::perms::none) << entry.path();
    if (entry.is_regular_file()) {
      ++files;
      EXPECT_EQ(entry.status().permissions() & fs::perms::owner_exec, fs::perms::none);
    }
  }
  EXPECT_EQ(files, 6 + static_cast<int>(2 * (1 + 3 * roles().size())));
}

TEST(Keystore, AnIdentityThatIsNotItsRolesIsFound) {
  const Store store({"cell-1", "cell-2"});
  store.copy(store.role("master") / "cert.pem", store.role("slave") / "cert.pem");
  expect_fault(store, store.role("slave") / "cert.pem", "must name CN=slave,OU=cell-1,O=Telekerf");
  expect_fault(store, store.role("slave") / "key.pem", "does not belong to the certificate");
  store.copy(store.role("vision", "cell-2") / "permissions.smime",
             store.role("vision") / "permissions.smime");
  expect_fault(store, store.role("vision") / "permissions.smime",
               "nothing to CN=vision,OU=cell-1,O=Telekerf");
  fs::remove(store.role("ctl") / "permissions.smime");
  expect_fault(store, store.role("ctl") / "permissions.smime", "is not there");
}

TEST(Keystore, OneAuthorityForBothPurposesIsFound) {
  const Store store;
  store.copy(store.folder() / "identity_ca.pem", store.folder() / "permissions_ca.pem");
  expect_fault(store, store.folder() / "permissions_ca.pem", "is the identities' authority as well");
  expect_fault(store, store.folder() / "governance.smime", "is not signed by permissions_ca.pem");
}

TEST(Keystore, AnotherAuthorityOfTheSameNameIsFound) {
  const Store store, other;
  store.copy(other.role("master") / "cert.pem", store.role("master") / "cert.pem");
  store.copy(other.role("master") / "key.pem", store.role("master") / "key.pem");
  store.copy(other.role("master") / "permissions.smime", store.role("master") / "permissions.smime");
  expect_fault(store, store.role("master") / "cert.pem", "is not signed by identity_ca.pem");
  expect_fault(store, store.role("master") / "permissions.smime", "is not signed by permissions_ca.pem");
}

TEST(Keystore, DatesAreFoundInAnyZone) {
  const Store store({"cell-1"}, hours(24 * 40));
  const fs::path file = store.role("master") / "cert.pem";
  expect_fault(store, file, "has expired on", now() + hours(24 * 41));
  expect_fault(store, file, "is not valid before", now() - hours(30));
  const std::string zone = getenv("TZ") == nullptr ? "" : getenv("TZ");
  for (const char* where : {"UTC", "Pacific/Kiritimati", "Etc/GMT+12"}) {
    setenv("TZ", where, 1);
    tzset();
    EXPECT_TRUE(check_keystore(store.folder(), now()).faults.empty()) << where;
    // Permissions outlast their identity wherever they are read.
    EXPECT_TRUE(
        check_keystore(store.folder(), now() + hours(24 * 40) - std::chrono::minutes(1)).faults.empty())
        << where;
    // The same text, far from here.
    const auto read = local_time("2026-11-29T12:00:00");
    ASSERT_TRUE(read);
    const auto utc = std::chrono::system_clock::from_time_t(1795953600);
    EXPECT_EQ(std::chrono::duration_cast<hours>(*read - utc).count(), where == std::string("UTC") ? 0
                                                                      : where == std::string("Etc/GMT+12")
                                                                          ? 12
                                                                          : -14);
  }
  zone.empty() ? unsetenv("TZ") : setenv("TZ", zone.c_str(), 1);
  tzset();
}

TEST(Keystore, WhatOthersCanReadIsFound) {
  const Store store;
  fs::permissions(store.role("slave") / "key.pem", fs::perms(0640));
  expect_fault(store, store.role("slave") / "key.pem", "mode 640");
  fs::permissions(store.folder() / "identity_ca.key", fs::perms(0604));
  expect_fault(store, store.folder() / "identity_ca.key", "chmod 600");
}

/// A certificate of the master, signed by the true authority, with something about it that must not be.
void write_odd(const Store& store, bool usage, bool order, const EVP_MD* digest) {
  const CertificatePointer authority = read_certificate(store.folder() / "identity_ca.pem");
  const KeyPointer by = read_key(store.folder() / "identity_ca.key");
  const CertificatePointer old = read_certificate(store.role("master") / "cert.pem");
  const CertificatePointer made(X509_dup(old.get()));
  if (!order) {
    const X509NamePointer name(X509_NAME_new());
    for (const auto& [field, value] : {std::pair{"CN", "master"}, {"OU", "cell-1"}, {"O", "Telekerf"}})
      X509_NAME_add_entry_by_txt(name.get(), field, MBSTRING_UTF8,
                                 reinterpret_cast<const unsigned char*>(value), -1, -1, 0);
    X509_set_subject_name(made.get(), name.get());
  }
  if (!usage)
    X509_EXTENSION_free(X509_delete_ext(made.get(), X509_get_ext_by_NID(made.get(), NID_ext_key_usage, -1)));
  X509_sign(made.get(), by.get(), digest);
  const BioPointer out(BIO_new_file((store.role("master") / "cert.pem").c_str(), "wb"));
  PEM_write_bio_X509(out.get(), made.get());
}

TEST(Keystore, UsageOrderAndSignatureAreFound) {
  const Store store;
  const fs::path file = store.role("master") / "cert.pem";
  const std::string good = contents(file);
  const auto restore = [&] { std::ofstream(file) << good; };
  write_odd(store, false, true, EVP_sha256());
  expect_fault(store, file, "lacks extendedKeyUsage");
  restore();
  write_odd(store, true, false, EVP_sha256());
  expect_fault(store, file, "names O=Telekerf,OU=cell-1,CN=master and must name");
  restore();
  write_odd(store, true, true, EVP_sha384());
  expect_fault(store, file, "is signed with ecdsa-with-SHA384");
  restore();
  EXPECT_TRUE(check_keystore(store.folder(), now()).faults.empty());
}

/// Signs other text with the store's own authority.
void write_document(const Store& store, const fs::path& file, const std::string& text) {
  const CertificatePointer authority = read_certificate(store.folder() / "permissions_ca.pem");
  const KeyPointer key = read_key(store.folder() / "permissions_ca.key");
  std::ofstream(file) << signed_document(text, authority.get(), key.get());
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

TEST(Keystore, PartitionsDomainsRightsAndProtectionAreFound) {
  const Store store;
  const fs::path file = store.role("recorder") / "permissions.smime";
  const std::string text =
      permissions_text("cell-1", *find_role("recorder"), now() - hours(24), now() + hours(24 * 400));
  write_document(store, file, text);
  EXPECT_TRUE(check_keystore(store.folder(), now()).faults.empty());
  write_document(store, file, replaced(text, "<partitions><partition>cell-1</partition></partitions>", ""));
  expect_fault(store, file, "without partition cell-1");
  write_document(store, file, replaced(text, "<max>230</max>", "<max>232</max>"));
  expect_fault(store, file, "names domain 232");
  write_document(store, file, replaced(text, "telekerf/contour", "telekerf/command"));
  expect_fault(store, file, "does not let it subscribe to telekerf/contour");
  expect_fault(store, file, "lets it subscribe to telekerf/command");
  write_document(store, file, "nothing");
  expect_fault(store, file, "grants nothing");
  write_document(store, file, text);
  const fs::path governance = governance_file(store.folder(), false);
  write_document(store, governance,
                 replaced(governance_text(false), "SIGN_WITH_ORIGIN_AUTHENTICATION", "NONE"));
  expect_fault(store, governance, "does not protect what it should: rtps NONE");
  // An identity cannot sign for the authority, though the name in it is of the same house.
  const CertificatePointer master = read_certificate(store.role("master") / "cert.pem");
  const KeyPointer key = read_key(store.role("master") / "key.pem");
  std::ofstream(governance) << signed_document(governance_text(false), master.get(), key.get());
  expect_fault(store, governance, "is not signed by permissions_ca.pem");
}

TEST(Keystore, RenewedIdentitiesAreNewAndFromTheSameAuthorities) {
  const Store store({"cell-1"}, hours(24 * 10));
  const std::string authority = contents(store.folder() / "identity_ca.pem");
  const std::string key = contents(store.role("master") / "key.pem");
  renew_keystore(store.folder(), {"cell-2"}, hours(24 * 100));
  const KeystoreReport report = check_keystore(store.folder(), now());
  EXPECT_TRUE(report.faults.empty()) << report.faults.front();
  EXPECT_EQ(report.identities, static_cast<int>(2 * roles().size()));
  EXPECT_EQ(days_left(report.first_to_end->end, now()), 99);
  EXPECT_EQ(contents(store.folder() / "identity_ca.pem"), authority);
  EXPECT_NE(contents(store.role("master") / "key.pem"), key);
  fs::remove(store.folder() / "identity_ca.key");
  EXPECT_THROW(renew_keystore(store.folder(), {}, hours(24)), StartupError);
  EXPECT_TRUE(check_keystore(store.folder(), now()).faults.empty())
      << "a computer need not have the authorities' keys";
  EXPECT_THROW(make_keystore(store.folder(), {"cell-1"}, hours(24)), StartupError);
}

TEST(Keystore, AProcessNeedsItsOwnKeyAndNoOthers) {
  const Store store;
  fs::remove(store.role("slave") / "key.pem");
  EXPECT_TRUE(check_role(store.folder(), "cell-1", "master", false, now()).faults.empty());
  const auto faults = check_role(store.folder(), "cell-1", "slave", false, now()).faults;
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_NE(faults.front().find("key.pem is not there"), std::string::npos);
  EXPECT_FALSE(check_role(store.folder(), "cell-2", "master", false, now()).faults.empty());
  EXPECT_FALSE(check_role(store.folder(), "cell-1", "nobody", false, now()).faults.empty());
}

TEST(Roles, ThePeersPrefixIsTheLowestSoThatItBeginsTheHandshake) {
  for (const std::string cell : {"cell-1", "left", "b"}) {
    const SubjectPrefix peer = prefix_of(cell, common_name(cell, "peer"));
    EXPECT_GE(peer[0], 0x80);
    for (const Role& role : roles()) {
      if (role.name == std::string("peer")) continue;
      EXPECT_LT(peer, prefix_of(cell, role.name)) << role.name;
    }
  }
}

TEST(Roles, NamesThatWouldBePathsOrPatternsAreRefused) {
  for (const char* bad : {"", "..", ".x", "a/b", "a b", "*", "a,b"})
    EXPECT_FALSE(complaint_about_secured_cell(bad).empty()) << bad;
  EXPECT_TRUE(complaint_about_secured_cell("cell_1.b-2").empty());
}

}  // namespace
}  // namespace telekerf::security
