// SPDX-License-Identifier: Apache-2.0
#include "common/bus/security/documents.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fnmatch.h>
#include <openssl/pkcs7.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <regex>

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

/// What the children of an element must be, each followed by a blank; elements that are not here hold text.
struct Form {
  const char* element;
  const char* children;
};
constexpr std::array<Form, 11> kForms{{{"permissions", "(grant )+"},
                                       {"grant", "subject_name validity ((allow|deny)_rule )*default "},
                                       {"validity", "not_before not_after "},
                                       {"allow_rule", "domains ((publish|subscribe) )*"},
                                       {"deny_rule", "domains ((publish|subscribe) )*"},
                                       {"domains", "((id|id_range) )+"},
                                       {"id_range", "min max "},
                                       {"publish", "((topics|partitions) )*"},
                                       {"subscribe", "((topics|partitions) )*"},
                                       {"topics", "(topic )+"},
                                       {"partitions", "(partition )+"}}};

/// Empty: it and all below it have their form.
std::string misshape(const tinyxml2::XMLElement* element) {
  std::string children, told;
  for (const auto* each = element->FirstChildElement(); each != nullptr; each = each->NextSiblingElement()) {
    const std::string name = std::string(each->Name()) + ' ';
    children += name;
    if (!told.ends_with(name)) told += name;
  }
  const std::string name = element->Name();
  const auto* const form =
      std::find_if(kForms.begin(), kForms.end(), [&](const Form& each) { return name == each.element; });
  if (form != kForms.end() && !std::regex_match(children, std::regex(form->children)))
    return fmt::format("its <{}> in line {} holds {}which the library does not take", name, element->GetLineNum(),
                       told.empty() ? "nothing " : told);
  if (form == kForms.end() && name != "partition" && element->GetText() == nullptr)
    return fmt::format("its <{}> in line {} is empty", name, element->GetLineNum());
  if (name == "grant" && element->Attribute("name") == nullptr) return "its <grant> has no name";
  for (const auto* each = element->FirstChildElement(); each != nullptr; each = each->NextSiblingElement()) {
    if (std::string wrong = misshape(each); !wrong.empty()) return wrong;
  }
  return "";
}

std::vector<std::pair<int, int>> domains_of(const tinyxml2::XMLElement* rule) {
  std::vector<std::pair<int, int>> ranges;
  const auto number = [](const tinyxml2::XMLElement* element) { return element->IntText(-1); };
  const auto* const all = rule->FirstChildElement("domains");
  for (const auto* each = all->FirstChildElement(); each != nullptr; each = each->NextSiblingElement()) {
    if (const auto* const min = each->FirstChildElement("min"); min == nullptr)
      ranges.emplace_back(number(each), number(each));
    else
      ranges.emplace_back(number(min), number(each->FirstChildElement("max")));
  }
  return ranges;
}

/// All of one kind in a rule are one: of several, any topic goes with any partition.
void add_rule(std::vector<Rule>& rules, const tinyxml2::XMLElement* element, bool publish) {
  const char* const kind = publish ? "publish" : "subscribe";
  Rule rule{element->Name() == std::string("allow_rule"), publish, {}, {}, domains_of(element)};
  const auto* said = element->FirstChildElement(kind);
  if (said == nullptr) return;
  for (; said != nullptr; said = said->NextSiblingElement(kind)) {
    const auto add = [&](std::vector<std::string>& to, const char* list, const char* name) {
      for (const auto* each = said->FirstChildElement(list); each != nullptr;
           each = each->NextSiblingElement(list)) {
        for (std::string& text : texts_of(each, name)) to.push_back(std::move(text));
      }
    };
    add(rule.topics, "topics", "topic");
    const std::size_t before = rule.partitions.size();
    add(rule.partitions, "partitions", "partition");
    if (rule.partitions.size() == before) rule.partitions.emplace_back();
  }
  rules.push_back(std::move(rule));
}

/// Element for element what it says, as "data_protection_kind NONE"; what holds others says its name alone.
void add_sayings(const tinyxml2::XMLElement* element, std::vector<std::string>& sayings) {
  const char* const text = element->GetText();
  const bool holds = element->FirstChildElement() != nullptr;
  sayings.push_back(holds || text == nullptr ? element->Name() : fmt::format("{} {}", element->Name(), text));
  for (const auto* each = element->FirstChildElement(); each != nullptr; each = each->NextSiblingElement())
    add_sayings(each, sayings);
}

std::vector<std::string> sayings_of(const std::string& text) {
  std::vector<std::string> sayings;
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS && document.RootElement() != nullptr)
    add_sayings(document.RootElement(), sayings);
  return sayings;
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

tl::expected<std::vector<Grant>, std::string> read_permissions(const std::string& text) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    return tl::unexpected<std::string>("grants nothing: it is no XML");
  const auto* const root = document.FirstChildElement("dds");
  const auto* const list = root == nullptr ? nullptr : root->FirstChildElement();
  if (list == nullptr || list->Name() != std::string("permissions"))
    return tl::unexpected<std::string>("grants nothing: it holds no <permissions>");
  if (std::string wrong = misshape(list); !wrong.empty()) return tl::unexpected(std::move(wrong));
  std::vector<Grant> grants;
  for (const auto* each = list->FirstChildElement("grant"); each != nullptr;
       each = each->NextSiblingElement("grant")) {
    const auto* const validity = each->FirstChildElement("validity");
    Grant grant{child_text(each, "subject_name"),
                child_text(validity, "not_before"),
                child_text(validity, "not_after"),
                {},
                each->LastChildElement()->GetText()};
    for (const auto* rule = validity->NextSiblingElement(); rule != each->LastChildElement();
         rule = rule->NextSiblingElement()) {
      for (const bool publish : {true, false}) add_rule(grant.rules, rule, publish);
    }
    grants.push_back(std::move(grant));
  }
  return grants;
}

const Rule* deciding_rule(const Grant& grant, bool publish, const std::string& topic) {
  const auto rule = std::find_if(grant.rules.begin(), grant.rules.end(), [&](const Rule& each) {
    return each.publish == publish &&
           std::any_of(each.topics.begin(), each.topics.end(), [&](const std::string& pattern) {
             return ::fnmatch(pattern.c_str(), topic.c_str(), FNM_NOESCAPE) == 0;
           });
  });
  return rule == grant.rules.end() ? nullptr : &*rule;
}

std::string difference_from_governance(const std::string& text, bool wan) {
  const std::vector<std::string> said = sayings_of(text), wanted = sayings_of(governance_text(wan));
  const auto [at, place] = std::mismatch(said.begin(), said.end(), wanted.begin(), wanted.end());
  if (at == said.end() && place == wanted.end()) return "";
  return fmt::format("{} in place of {}", at == said.end() ? "nothing" : *at,
                     place == wanted.end() ? "nothing" : *place);
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
