// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>

#include "common/runtime/say.h"
#include "common/runtime/startup_error.h"
#include "common/runtime/version.h"

namespace telekerf {
namespace {

constexpr int kCannot = 2;

bool take_out(std::vector<std::string>& words, const std::string& word) {
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) return false;
  words.erase(found);
  return true;
}

constexpr const char* kCommonFlags =
    "\n"
    "  --config FILE               TOML file with any of these settings (names with underscores)\n"
    "  --print-config              writes that file, with the settings as they are given here\n"
    "  --help, --version\n";

}  // namespace

const Command* Program::chosen(std::vector<std::string>& words) const {
  if (commands_.size() == 1 && commands_.front().name.empty()) return &commands_.front();
  // Settings may stand before the command: their values are not taken for it.
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].starts_with("-")) {
      for (const Command& command : commands_) {
        Settings settings;
        command.add_parameters(settings);
        const auto declared = settings.declared();
        const auto known = std::find_if(declared.begin(), declared.end(),
                                        [&](const Setting& s) { return s.flag() == words[i]; });
        if (known == declared.end()) continue;
        if (known->type != Setting::Type::kSwitch) ++i;
        break;
      }
      continue;
    }
    for (const Command& command : commands_) {
      if (command.name != words[i]) continue;
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
      return &command;
    }
    throw usage_error(fmt::format("there is no command '{}'; see --help", words[i]));
  }
  return nullptr;
}

std::string Program::help(const Command* command) const {
  if (command == nullptr) {
    std::string text = fmt::format("{}\n\nUsage: {} COMMAND [OPTIONS]\n\n", sentence_, name_);
    for (const Command& one : commands_) text += fmt::format("  {:<18}{}\n", one.name, one.sentence);
    return text + fmt::format("\n`{} COMMAND --help` lists its options; --version\n", name_);
  }
  Settings settings;
  command->add_parameters(settings);
  std::string usage = name_ + (command->name.empty() ? "" : " " + command->name);
  bool options = false;
  for (const Setting& s : settings.declared()) {
    if (s.positional) usage += " " + s.name;
    options = options || !s.positional;
  }
  std::string text =
      fmt::format("{}\n\nUsage: {}{}\n\n", command->sentence, usage, options ? " [OPTIONS]" : "");
  text += settings.help();
  return text + (options ? kCommonFlags : "\n  --help, --version\n");
}

std::string Program::description() const {
  nlohmann::ordered_json json{
      {"program", name_}, {"sentence", sentence_}, {"commands", nlohmann::ordered_json::array()}};
  for (const Command& command : commands_) {
    Settings settings;
    command.add_parameters(settings);
    json["commands"].push_back(
        {{"command", command.name}, {"sentence", command.sentence}, {"settings", settings.json()}});
  }
  return json.dump(2) + "\n";
}

int Program::dispatch(std::vector<std::string> words) {
  if (take_out(words, "--version")) {
    fmt::print("{}\n", kVersion);
    return 0;
  }
  if (take_out(words, "--describe-settings")) {
    fmt::print("{}", description());
    return 0;
  }
  const bool helps = take_out(words, "--help") || take_out(words, "-h");
  const bool prints = take_out(words, "--print-config");
  const Command* const command = chosen(words);
  if (helps) {
    fmt::print("{}", help(command));
    return 0;
  }
  if (command == nullptr) {
    std::vector<std::string> names;
    for (const Command& one : commands_) names.push_back(one.name);
    throw usage_error(fmt::format("say what to do: {}; see --help", fmt::join(names, ", ")));
  }
  Settings settings;
  command->add_parameters(settings);
  if (command->name.empty()) settings.table(name_.substr(name_.find('-') + 1));
  settings.load(words);
  command->validate();
  if (prints) {
    fmt::print("{}", settings.toml());
    return 0;
  }
  settings.require_given();
  settings.refuse_without_effect();
  command->remember(settings.toml(), settings.given_toml());
  return command->run();
}

int Program::run(int argc, char** argv) {
  // Another process may have begun a line: its bar is wiped.
  const char* const wipe = isatty(STDERR_FILENO) != 0 ? "\r\033[K" : "";
  try {
    return dispatch({argv + 1, argv + argc});
  } catch (const StartupError& error) {
    write_line(stderr, fmt::format("{}{}: {}", wipe, name_, error.what()));
  } catch (const std::exception& error) {
    write_line(stderr, fmt::format("{}{}: unexpected: {}", wipe, name_, error.what()));
  }
  return kCannot;
}

}  // namespace telekerf
