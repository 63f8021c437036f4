// SPDX-License-Identifier: Apache-2.0
#include "common/bus/security/documents.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <openssl/pkcs7.h>
#include <tinyxml2.h>

#include <ctime>

#include "common/bus/security/keystore.h"
#include "common/bus/security/openssl.h"

namespace telekerf::security {
namespace {

constexpr const char* kHead = R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_{}.xsd">
)";

std::string domains() {
  return fmt::format("<domains><id_range><min>0</min><max>{}</max></id_range></domains>",
                     kHighestSecuredDomain);
}

/// One topic a rule: of several in one, any topic goes with any partition.
std::string rules(const char* kind, const std::vector<const char*>& topics, const std::string& cell) {
  std::string text;
  for (const char* topic : topics)
    text += fmt::format(
        "<allow_rule>{0}<{1}><topics><topic>{2}</topic></topics><partitions><partition>{3}</partition></"
        "partitions>"
        "</{1}></allow_rule>\n",
        domains(), kind, topic, cell);
  return text;
}

std::string date(std::chrono::system_clock::time_point time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

std::string child_text(const tinyxml2::XMLElement* parent, const char* name) {
  const auto* const child = parent == nullptr ? nullptr : parent->FirstChildElement(name);
  if (child == nullptr || child->GetText() == nullptr) return "";
  std::string text = child->GetText();
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::vector<std::string> texts_of(const tinyxml2::XMLElement* list, const char* name) {
  std::vector<std::string> texts;
  if (list == nullptr) return texts;
  for (const auto* each = list->FirstChildElement(name); each != nullptr;
       each = each->NextSiblingElement(name))
    texts.emplace_back(each->GetText() == nullptr ? "" : each->GetText());
  return texts;
}

int highest_domain(const tinyxml2::XMLElement* rule) {
  int highest = -1;
  const auto* const all = rule->FirstChildElement("domains");
  if (all == nullptr) return highest;
  for (const auto* range = all->FirstChildElement(); range != nullptr; range = range->NextSiblingElement()) {
    int value = -1;
    if (range->QueryIntText(&value) != tinyxml2::XML_SUCCESS) {
      const auto* const max = range->FirstChildElement("max");
      if (max != nullptr) (void)max->QueryIntText(&value);
    }
    highest = std::max(highest, value);
  }
  return highest;
}

}  // namespace

std::string governance_text(bool wan) {
  return fmt::format(kHead, "governance") + fmt::format(R"(<domain_access_rules><domain_rule>{}
<allow_unauthenticated_participants>false</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>ENCRYPT</discovery_protection_kind>
<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
<rtps_protection_kind>{}_WITH_ORIGIN_AUTHENTICATION</rtps_protection_kind>
<topic_access_rules><topic_rule><topic_expression>*</topic_expression>
<enable_discovery_protection>true</enable_discovery_protection>
<enable_liveliness_protection>true</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control>
<enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>NONE</metadata_protection_kind>
<data_protection_kind>NONE</data_protection_kind>
</topic_rule></topic_access_rules></domain_rule></domain_access_rules></dds>
)",
                                                        domains(), wan ? "ENCRYPT" : "SIGN");
}

std::string permissions_text(const std::string& cell, const Role& role,
                             std::chrono::system_clock::time_point begin,
                             std::chrono::system_clock::time_point end) {
  return fmt::format(kHead, "permissions") +
         fmt::format(R"(<permissions><grant name="{} of {}"><subject_name>{}</subject_name>
<validity><not_before>{}</not_before><not_after>{}</not_after></validity>
{}{}<default>DENY</default></grant></permissions></dds>
)",
                     role.name, cell, subject_of(cell, common_name(cell, role.name)), date(begin), date(end),
                     rules("publish", role.publishes, cell), rules("subscribe", role.subscribes, cell));
}

std::string signed_document(const std::string& text, X509* certificate, EVP_PKEY* key) {
  const BioPointer in(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  constexpr int kFlags = PKCS7_DETACHED | PKCS7_TEXT;
  const Pkcs7Pointer made(PKCS7_sign(certificate, key, nullptr, in.get(), kFlags));
  const BioPointer out(BIO_new(BIO_s_mem()));
  if (!made || BIO_reset(in.get()) != 1 || SMIME_write_PKCS7(out.get(), made.get(), in.get(), kFlags) != 1)
    return "";
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(out.get(), &bytes);
  return {bytes, static_cast<std::size_t>(size)};
}

std::optional<std::string> verified_document(const std::filesystem::path& file, X509* authority) {
  const BioPointer in(BIO_new_file(file.c_str(), "rb"));
  if (!in) return std::nullopt;
  BIO* content = nullptr;
  const Pkcs7Pointer read(SMIME_read_PKCS7(in.get(), &content));
  const BioPointer owned(content);
  if (!read) return std::nullopt;
  const std::unique_ptr<X509_STORE, Freed<X509_STORE_free>> none(X509_STORE_new());
  const std::unique_ptr<STACK_OF(X509), void (*)(STACK_OF(X509)*)> signers(
      sk_X509_new_null(), [](STACK_OF(X509) * stack) { sk_X509_free(stack); });
  sk_X509_push(signers.get(), authority);
  const BioPointer out(BIO_new(BIO_s_mem()));
  if (PKCS7_verify(read.get(), signers.get(), none.get(), content, out.get(),
                   PKCS7_TEXT | PKCS7_NOVERIFY | PKCS7_NOINTERN) != 1)
    return std::nullopt;
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(out.get(), &bytes);
  return std::string(bytes, static_cast<std::size_t>(size));
}

std::optional<std::vector<Grant>> read_permissions(const std::string& text) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return std::nullopt;
  const auto* const root = document.FirstChildElement("dds");
  const auto* const list = root == nullptr ? nullptr : root->FirstChildElement("permissions");
  if (list == nullptr) return std::nullopt;
  std::vector<Grant> grants;
  for (const auto* each = list->FirstChildElement("grant"); each != nullptr;
       each = each->NextSiblingElement("grant")) {
    const auto* const validity = each->FirstChildElement("validity");
    Grant grant{child_text(each, "subject_name"),
                child_text(validity, "not_before"),
                child_text(validity, "not_after"),
                {}};
    for (const auto* rule = each->FirstChildElement("allow_rule"); rule != nullptr;
         rule = rule->NextSiblingElement("allow_rule")) {
      for (const bool publish : {true, false}) {
        const auto* const said = rule->FirstChildElement(publish ? "publish" : "subscribe");
        if (said == nullptr) continue;
        grant.rules.push_back({publish, texts_of(said->FirstChildElement("topics"), "topic"),
                               texts_of(said->FirstChildElement("partitions"), "partition"),
                               highest_domain(rule)});
      }
    }
    grants.push_back(std::move(grant));
  }
  return grants;
}

std::optional<Governance> read_governance(const std::string& text) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return std::nullopt;
  const auto* at = static_cast<const tinyxml2::XMLNode*>(&document);
  for (const char* name : {"dds", "domain_access_rules", "domain_rule"}) {
    at = at->FirstChildElement(name);
    if (at == nullptr) return std::nullopt;
  }
  const auto* const rule = at->ToElement();
  const auto* const topics = rule->FirstChildElement("topic_access_rules");
  const auto* const topic = topics == nullptr ? nullptr : topics->FirstChildElement("topic_rule");
  return Governance{
      .highest_domain = highest_domain(rule),
      .join_access_control = child_text(rule, "enable_join_access_control") == "true",
      .rtps = child_text(rule, "rtps_protection_kind"),
      .discovery = child_text(rule, "discovery_protection_kind"),
      .liveliness = child_text(rule, "liveliness_protection_kind"),
      .topics = child_text(topic, "topic_expression"),
      .metadata = child_text(topic, "metadata_protection_kind"),
      .data = child_text(topic, "data_protection_kind"),
      .topic_access_control = child_text(topic, "enable_read_access_control") == "true" &&
                              child_text(topic, "enable_write_access_control") == "true",
  };
}

std::optional<std::chrono::system_clock::time_point> local_time(const std::string& date) {
  std::tm parts{};
  if (strptime(date.c_str(), "%Y-%m-%dT%H:%M:%S", &parts) == nullptr) return std::nullopt;
  parts.tm_isdst = -1;
  const std::time_t time = std::mktime(&parts);
  if (time == -1) return std::nullopt;
  return std::chrono::system_clock::from_time_t(time);
}

}  // namespace telekerf::security
