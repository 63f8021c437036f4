// SPDX-License-Identifier: Apache-2.0
// The keys of a cell: what is made, what is found wrong with it, and what is made anew.
#include <openssl/pem.h>
#include <openssl/x509v3.h>
#include <unistd.h>

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

TEST(Keystore, FoldersThatOthersCanWriteAreFound) {
  const Store store;
  const fs::path master = store.role("master");
  for (const fs::path& folder : {store.folder(), store.folder() / "cells", master.parent_path(), master}) {
    for (const int mode : {0777, 0770, 0702}) {
      fs::permissions(folder, fs::perms(mode));
      expect_fault(store, folder, "can be written by others than its owner");
      const auto faults = check_role(store.folder(), "cell-1", "master", false, now()).faults;
      EXPECT_FALSE(faults.empty()) << folder << " " << mode;
    }
    fs::permissions(folder, fs::perms(0755));  // whoever sees names sees no keys
    EXPECT_TRUE(check_keystore(store.folder(), now()).faults.empty()) << folder;
  }
  fs::permissions(store.role("slave"), fs::perms(0777));
  EXPECT_TRUE(check_role(store.folder(), "cell-1", "master", false, now()).faults.empty());
}

/// The fault is found by a user who is not root, in a process of its own.
void expect_not_readable(const Store& store, const fs::path& what) {
  EXPECT_EXIT(
      {
        if (::geteuid() == 0 && ::setuid(65534) != 0) std::_Exit(3);
        expect_fault(store, what, "may not be read by this user");
        const auto faults = check_role(store.folder(), "cell-1", "master", false, now()).faults;
        const bool told = std::any_of(faults.begin(), faults.end(), [&](const std::string& fault) {
          return fault.starts_with(what.string() + " may not be read");
        });
        std::_Exit(told && !testing::Test::HasFailure() ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

TEST(Keystore, WhatMayNotBeReadIsNotSaidToBeMissing) {
  const Store store;
  std::vector<fs::path> all{store.folder()};
  for (const auto& entry : fs::recursive_directory_iterator(store.folder())) all.push_back(entry.path());
  for (const fs::path& each : all) fs::permissions(each, fs::perms(fs::is_directory(each) ? 0755 : 0644));
  const fs::path master = store.role("master");
  for (const fs::path& what : {store.folder(), store.folder() / "cells", master.parent_path(), master,
                               master / "key.pem", store.folder() / "identity_ca.pem"}) {
    const auto before = fs::status(what).permissions();
    // Who is root here is somebody else there.
    fs::permissions(what,
                    ::geteuid() != 0 ? fs::perms::none : fs::perms(fs::is_directory(what) ? 0700 : 0600));
    expect_not_readable(store, what);
    fs::permissions(what, before);
  }
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

TEST(Keystore, WhatPermissionsAllowIsJudgedAsTheLibraryDoes) {
  const Store store;
  const fs::path file = store.role("recorder") / "permissions.smime";
  const std::string text =
      permissions_text("cell-1", *find_role("recorder"), now() - hours(24), now() + hours(24 * 400));
  write_document(store, file, text);
  EXPECT_TRUE(check_keystore(store.folder(), now()).faults.empty());
  const std::string partitions = "<partitions><partition>cell-1</partition></partitions>";
  const std::string domains = "<domains><id_range><min>0</min><max>230</max></id_range></domains>";
  const std::string deny = "<deny_rule>" + domains + "<subscribe><topics><topic>telekerf/*</topic></topics>" +
                           "</subscribe></deny_rule>";
  const std::string grant = text.substr(text.find("<grant"), text.find("</grant>") + 8 - text.find("<grant"));
  struct Case {
    std::string what, by, told;
  };
  for (const Case& each : {
           Case{partitions, "", "for partition '' and not for cell-1 alone"},
           Case{partitions, "<partitions><partition>*</partition></partitions>", "for partition '*' and not"},
           Case{"</partition></partitions>", "</partition><partition>b</partition></partitions>",
                "for partition 'cell-1', 'b' and not"},
           Case{"<max>230</max>", "<max>232</max>", "names domain 232"},
           Case{"<max>230</max>", "<max>50</max>",
                "does not hold in domain 51, and must in all from 0 to 230"},
           Case{"<min>0</min>", "<min>3</min>", "does not hold in domain 0"},
           Case{"<id_range><min>0</min><max>230</max></id_range>", "<id>7</id>", "does not hold in domain 0"},
           Case{"telekerf/contour", "telekerf/command", "does not let it subscribe to telekerf/contour"},
           Case{"telekerf/contour", "telekerf/command", "lets it subscribe to telekerf/command"},
           Case{"telekerf/contour", "telekerf/c*", "lets it subscribe to telekerf/c*"},
           Case{"</validity>", "</validity>" + deny, "subscribe to telekerf/state: a deny rule comes first"},
           Case{"<subscribe>", "<publish><topics><topic>telekerf/stop</topic></topics></publish><subscribe>",
                "lets it publish telekerf/stop"},
           Case{"</subscribe>",
                "</subscribe><subscribe><topics><topic>telekerf/stop</topic></topics></subscribe>",
                "lets it subscribe to telekerf/stop"},
           Case{"<default>DENY", "<default>ALLOW", "says ALLOW of what no rule names"},
           Case{"<default>DENY</default>", "", "its <grant> in line"},
           Case{"</validity>", "</validity><relay/>", "its <grant> in line"},
           Case{"<subscribe>", "<relay><topics><topic>a</topic></topics></relay><subscribe>",
                "its <allow_rule>"},
           Case{domains, "", "its <allow_rule> in line"},
           Case{"<topic>telekerf/state</topic>", "<topic/>", "its <topic> in line"},
           Case{"<not_after>", "<ended>", "is not understood"},
           Case{"CN=recorder,OU=cell-1", "OU=cell-1,CN=recorder", "nothing to CN=recorder,OU=cell-1"},
           Case{"</grant>", "</grant>" + replaced(grant, "CN=recorder", "CN=console"),
                "holds another grant, to CN=console,OU=cell-1,O=Telekerf"},
       }) {
    write_document(store, file, replaced(text, each.what, each.by));
    expect_fault(store, file, each.told);
  }
  // What comes too late, or denies what nobody needs, changes nothing.
  write_document(store, file, replaced(text, "<default>", deny + "<default>"));
  EXPECT_TRUE(check_keystore(store.folder(), now()).faults.empty());
  write_document(store, file, "nothing");
  expect_fault(store, file, "grants nothing");
}

TEST(Keystore, AGovernanceThatProtectsOtherwiseIsFound) {
  const Store store;
  const fs::path file = governance_file(store.folder(), false);
  const auto says = [&](const std::string& what, const std::string& by, const std::string& told) {
    write_document(store, file, replaced(governance_text(false), what, by));
    expect_fault(store, file, "does not protect as it should: it says " + told);
  };
  says("SIGN_WITH_ORIGIN_AUTHENTICATION", "NONE",
       "rtps_protection_kind NONE in place of rtps_protection_kind SIGN_WITH_ORIGIN_AUTHENTICATION");
  says("<max>230</max>", "<max>50</max>", "max 50 in place of max 230");
  says("<allow_unauthenticated_participants>false", "<allow_unauthenticated_participants>true",
       "allow_unauthenticated_participants true");
  says("<data_protection_kind>NONE", "<data_protection_kind>ENCRYPT", "data_protection_kind ENCRYPT");
  says("<enable_discovery_protection>true", "<enable_discovery_protection>false",
       "enable_discovery_protection false");
  says("</topic_rule>", "</topic_rule><topic_rule/>", "topic_rule in place of nothing");
  write_document(store, file, "nothing");
  expect_fault(store, file, "nothing in place of dds");
  // An identity cannot sign for the authority, though the name in it is of the same house.
  const CertificatePointer master = read_certificate(store.role("master") / "cert.pem");
  const KeyPointer key = read_key(store.role("master") / "key.pem");
  std::ofstream(file) << signed_document(governance_text(false), master.get(), key.get());
  expect_fault(store, file, "is not signed by permissions_ca.pem");
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

TEST(Keystore, AnAuthorityNearItsEndIsNamedAndRenewedWithTheRest) {
  for (const std::string name : {"identity_ca", "permissions_ca"}) {
    const Store store;
    const fs::path file = store.folder() / (name + ".pem");
    const std::string key = contents(store.folder() / (name + ".key"));
    store.end_authority(name, hours(24 * 10));
    const KeystoreReport before = check_role(store.folder(), "cell-1", "master", false, now());
    ASSERT_TRUE(before.first_to_end);
    EXPECT_TRUE(before.first_to_end->authority);
    EXPECT_EQ(before.first_to_end->file, file.string());
    expect_fault(store, file, "has expired on", now() + hours(24 * 11));
    expect_fault(store, file, "--renew makes it anew", now() + hours(24 * 11));
    EXPECT_TRUE(renew_keystore(store.folder(), {}, hours(24 * 9)).empty()) << "it lasts longer than they do";
    EXPECT_EQ(renew_keystore(store.folder(), {}, hours(24 * 100)), std::vector<fs::path>{file});
    const KeystoreReport after = check_keystore(store.folder(), now());
    EXPECT_TRUE(after.faults.empty()) << after.faults.front();
    EXPECT_EQ(days_left(after.first_to_end->end, now()), 99);
    EXPECT_FALSE(after.first_to_end->authority);
    EXPECT_EQ(contents(store.folder() / (name + ".key")), key);
    EXPECT_EQ(fs::status(file).permissions(), fs::perms(0600));
  }
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
