// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/runtime/startup_error.h"

namespace telekerf {
namespace {

std::string flag_of(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

std::string quoted_toml(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

}  // namespace

void Settings::add(const std::string& name, double& value, Bounds bounds, const std::string& help) {
  entries_.push_back(
      {name,
       fmt::format("{} [{:g}]", help, value),
       [name, &value, bounds](const ConfigFile& f) { value = f.number_or(name, value, bounds); },
       false,
       false,
       {}});
}

void Settings::add(const std::string& name, int& value, Bounds bounds, const std::string& help) {
  entries_.push_back({name,
                      fmt::format("{} [{}]", help, value),
                      [name, &value, bounds](const ConfigFile& f) {
                        value = static_cast<int>(f.integer_or(name, value, bounds));
                      },
                      false,
                      false,
                      {}});
}

void Settings::add(const std::string& name, std::uint64_t& value, Bounds bounds, const std::string& help) {
  entries_.push_back({name,
                      fmt::format("{} [{}]", help, value),
                      [name, &value, bounds](const ConfigFile& f) {
                        value = static_cast<std::uint64_t>(
                            f.integer_or(name, static_cast<std::int64_t>(value), bounds));
                      },
                      false,
                      false,
                      {}});
}

void Settings::add(const std::string& name, bool& value, const std::string& help) {
  entries_.push_back({name,
                      fmt::format("{} [{}]", help, value),
                      [name, &value](const ConfigFile& f) { value = f.boolean_or(name, value); },
                      true,
                      false,
                      {}});
}

void Settings::add(const std::string& name, std::string& value, const std::string& help,
                   const std::vector<std::string>& choices) {
  const std::string listed = choices.empty() ? "" : fmt::format(" ({})", fmt::join(choices, "|"));
  entries_.push_back({name,
                      fmt::format("{}{} [{}]", help, listed, value),
                      [name, &value, choices](const ConfigFile& f) {
                        value = choices.empty() ? f.text_or(name, value) : f.choice_or(name, value, choices);
                      },
                      false,
                      true,
                      {}});
}

void Settings::add(const std::string& name, std::string& value, const std::string& help,
                   const std::function<std::string(const std::string&)>& complaint) {
  entries_.push_back({name,
                      fmt::format("{} [{}]", help, value),
                      [name, &value, complaint](const ConfigFile& f) {
                        value = f.text_or(name, value);
                        if (const std::string wrong = complaint(value); !wrong.empty()) f.refuse(name, wrong);
                      },
                      false,
                      true,
                      {}});
}

void Settings::attach(CLI::App& app) {
  app.add_option("--config", config_, "TOML file with any of these settings (names with underscores)");
  for (auto& entry : entries_) {
    if (entry.is_flag) {
      app.add_flag_callback(
          flag_of(entry.name), [&entry] { entry.given = "true"; }, entry.help);
    } else {
      app.add_option_function<std::string>(
          flag_of(entry.name), [&entry](const std::string& text) { entry.given = text; }, entry.help);
    }
  }
}

void Settings::apply(const ConfigFile& file) {
  for (const auto& entry : entries_) entry.read(file);
  file.refuse_unknown();
}

void Settings::fill() {
  if (!config_.empty()) apply(ConfigFile(std::filesystem::path(config_)));
  for (const auto& entry : entries_) {
    if (!entry.given) continue;
    const std::string text = entry.quoted ? quoted_toml(*entry.given) : *entry.given;
    try {
      apply(ConfigFile(fmt::format("{} = {}\n", entry.name, text), "command line"));
    } catch (const StartupError& refusal) {
      const std::string what = refusal.what();
      if (what.find(entry.name) != std::string::npos) throw;
      throw StartupError(
          fmt::format("command line: {} {}: not a value of its kind", flag_of(entry.name), *entry.given));
    }
  }
}

}  // namespace telekerf
