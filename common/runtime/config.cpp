// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <cmath>
#include <set>
#include <sstream>

#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

std::string shown(const toml::node& node) {
  if (const auto* array = node.as_array()) {
    std::vector<std::string> elements;
    for (const auto& element : *array) elements.push_back(element.is_table() ? "{..}" : shown(element));
    return fmt::format("[{}]", fmt::join(elements, ", "));
  }
  if (const auto* number = node.as_floating_point()) {
    const std::string digits = fmt::format("{}", number->get());
    const bool whole = digits.find_first_not_of("-0123456789") == std::string::npos;
    return whole ? digits + ".0" : digits;
  }
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  return out.str();
}

/// "stage.0.delay_ms" -> "stage[0].delay_ms", the spelling of toml++ paths.
std::string toml_path(const std::string& key) {
  std::string path;
  std::istringstream parts(key);
  for (std::string part; std::getline(parts, part, '.');) {
    if (!part.empty() && part.find_first_not_of("0123456789") == std::string::npos) {
      path += "[" + part + "]";
    } else {
      path += (path.empty() ? "" : ".") + part;
    }
  }
  return path;
}

void collect_leaves(const toml::node& node, const std::string& key, std::vector<std::string>& leaves) {
  if (const auto* table = node.as_table()) {
    for (const auto& [name, child] : *table) {
      collect_leaves(child, key.empty() ? std::string(name.str()) : key + "." + std::string(name.str()),
                     leaves);
    }
  } else if (const auto* array = node.as_array(); array != nullptr && array->is_array_of_tables()) {
    for (std::size_t i = 0; i < array->size(); ++i) {
      collect_leaves(*array->get(i), key + "." + std::to_string(i), leaves);
    }
  } else {
    leaves.push_back(key);
  }
}

}  // namespace

struct ConfigFile::Document {
  toml::table root;
  mutable std::set<std::string> known;

  const toml::node* find(const std::string& key) const {
    known.insert(key);
    return root.at_path(toml_path(key)).node();
  }
};

ConfigFile::ConfigFile(const std::filesystem::path& file)
    : document_(std::make_unique<Document>()), name_(file.string()) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw configuration_error(fmt::format("{}: is a folder, not a file", name_));
  try {
    document_->root = toml::parse_file(name_);
  } catch (const toml::parse_error& error) {
    if (error.source().begin.line == 0)
      throw configuration_error(fmt::format("{}: cannot be read; is the name right?", name_));
    throw configuration_error(
        fmt::format("{}: {} (line {})", name_, error.description(), error.source().begin.line));
  }
}

ConfigFile::ConfigFile(const std::string& text, const std::string& name)
    : document_(std::make_unique<Document>()), name_(name) {
  try {
    document_->root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw configuration_error(
        fmt::format("{}: {} (line {})", name_, error.description(), error.source().begin.line));
  }
}

ConfigFile::~ConfigFile() = default;
ConfigFile::ConfigFile(ConfigFile&&) noexcept = default;
ConfigFile& ConfigFile::operator=(ConfigFile&&) noexcept = default;

void ConfigFile::refuse(const std::string& key, const std::string& complaint) const {
  const toml::node* node = document_->find(key);
  if (node == nullptr || node->is_table())
    throw configuration_error(fmt::format("{}: {}: {}", name_, key, complaint));
  throw configuration_error(fmt::format("{}: {} = {}: {}", name_, key, shown(*node), complaint));
}

bool ConfigFile::has(const std::string& key) const {
  return document_->root.at_path(toml_path(key)).node() != nullptr;
}

std::optional<ConfigValue> ConfigFile::value(const std::string& key) const {
  const toml::node* node = document_->find(key);
  if (node == nullptr) return std::nullopt;
  if (const auto* truth = node->as_boolean()) return truth->get();
  if (const auto* text = node->as_string()) return text->get();
  if (node->is_number()) return *node->value<double>();
  const toml::array* array = node->as_array();
  if (array == nullptr) return std::nullopt;
  std::vector<double> numbers;
  std::vector<std::string> texts;
  for (const auto& element : *array) {
    if (element.is_number()) numbers.push_back(*element.value<double>());
    if (element.is_string()) texts.push_back(*element.value<std::string>());
  }
  if (numbers.size() == array->size()) return numbers;
  if (texts.size() == array->size()) return texts;
  return std::nullopt;
}

namespace {
double checked(const ConfigFile& file, const std::string& key, double value, Bounds bounds) {
  if (const std::string wrong = complaint_about(value, bounds); !wrong.empty()) file.refuse(key, wrong);
  return value;
}
}  // namespace

double ConfigFile::number(const std::string& key, Bounds bounds) const {
  const toml::node* node = document_->find(key);
  if (node == nullptr) refuse(key, "is missing; add it to the file");
  const auto value = node->value<double>();
  if (!value || node->is_boolean()) refuse(key, "must be a number");
  return checked(*this, key, *value, bounds);
}

double ConfigFile::number_or(const std::string& key, double fallback, Bounds bounds) const {
  return document_->find(key) == nullptr ? fallback : number(key, bounds);
}

std::int64_t ConfigFile::integer(const std::string& key, Bounds bounds) const {
  const double value = number(key, bounds);
  if (value != std::floor(value)) refuse(key, "must be a whole number");
  return static_cast<std::int64_t>(value);
}

std::int64_t ConfigFile::integer_or(const std::string& key, std::int64_t fallback, Bounds bounds) const {
  return document_->find(key) == nullptr ? fallback : integer(key, bounds);
}

bool ConfigFile::boolean_or(const std::string& key, bool fallback) const {
  const toml::node* node = document_->find(key);
  if (node == nullptr) return fallback;
  if (!node->is_boolean()) refuse(key, "must be true or false");
  return **node->as_boolean();
}

std::string ConfigFile::text(const std::string& key) const {
  const toml::node* node = document_->find(key);
  if (node == nullptr) refuse(key, "is missing; add it to the file");
  if (!node->is_string()) refuse(key, "must be a text in quotes");
  return **node->as_string();
}

std::string ConfigFile::text_or(const std::string& key, const std::string& fallback) const {
  return document_->find(key) == nullptr ? fallback : text(key);
}

std::string ConfigFile::choice_or(const std::string& key, const std::string& fallback,
                                  const std::vector<std::string>& choices) const {
  if (document_->find(key) == nullptr) return fallback;
  const std::string value = text(key);
  for (const auto& choice : choices) {
    if (choice == value) return choice;
  }
  refuse(key, fmt::format("must be one of {}", fmt::join(choices, ", ")));
}

std::vector<double> ConfigFile::numbers(const std::string& key, std::size_t count, Bounds bounds) const {
  const toml::node* node = document_->find(key);
  if (node == nullptr) refuse(key, "is missing; add it to the file");
  const toml::array* array = node->as_array();
  if (array == nullptr || (count != 0 && array->size() != count)) {
    refuse(key,
           count == 0 ? "must be a list of numbers" : fmt::format("must be a list of {} numbers", count));
  }
  std::vector<double> values;
  for (const auto& element : *array) {
    const auto value = element.value<double>();
    if (!value) refuse(key, "must hold numbers only");
    values.push_back(checked(*this, key, *value, bounds));
  }
  return values;
}

std::size_t ConfigFile::array_size(const std::string& key) const {
  const toml::node* node = document_->root.at_path(toml_path(key)).node();
  if (node == nullptr) return 0;
  if (!node->is_array()) refuse(key, fmt::format("must be written as [[{}]]", key));
  return node->as_array()->size();
}

void ConfigFile::pass_over(const std::string& table) const {
  if (const auto* const theirs = document_->root.get_as<toml::table>(table)) {
    std::vector<std::string> leaves;
    collect_leaves(*theirs, table, leaves);
    document_->known.insert(leaves.begin(), leaves.end());
  }
}

void ConfigFile::refuse_unknown() const {
  std::vector<std::string> leaves;
  collect_leaves(document_->root, "", leaves);
  for (const auto& leaf : leaves) {
    if (document_->known.contains(leaf)) continue;
    const std::string table = leaf.substr(0, leaf.rfind('.') + 1);
    std::set<std::string> here;  // keys of the same table, or else the tables themselves
    for (const auto& key : document_->known) {
      if (key.starts_with(table) && key.find('.', table.size()) == key.npos)
        here.insert(key.substr(table.size()));
    }
    if (here.empty()) {
      for (const auto& key : document_->known) here.insert(key.substr(0, key.find('.')));
    }
    throw configuration_error(
        fmt::format("{}: unknown key '{}'; known here: {}", name_, leaf, fmt::join(here, ", ")));
  }
}

}  // namespace telekerf
