// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/program.h"

#include <fmt/format.h>

#include <cctype>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "common/runtime/startup_error.h"
#include "common/runtime/version.h"

namespace telekerf {
namespace {

/// The command line as CLI11 wants it, last word first. It takes "-.5" for an option, "-0.5" for a number.
std::vector<std::string> words_of(int argc, char** argv) {
  std::vector<std::string> words;
  for (int i = argc - 1; i > 0; --i) {
    std::string word = argv[i];
    if (word.size() > 2 && word.starts_with("-.") && std::isdigit(static_cast<unsigned char>(word[2])))
      word.insert(1, "0");
    words.push_back(std::move(word));
  }
  return words;
}

}  // namespace

CLI::Validator within(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) {
        double value = 0.0;
        const bool good = CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
        return good ? std::string() : fmt::format("{} does not lie within [{:g}, {:g}]", text, low, high);
      },
      "NUMBER");
}

CLI::Validator whole_number() {
  return CLI::Validator(
      [](const std::string& text) {
        const bool good = !text.empty() && text.find_first_not_of("0123456789") == text.npos;
        return good ? std::string() : fmt::format("'{}' is no whole number of 0 or more", text);
      },
      "NUMBER");
}

int run_program(CLI::App& app, int argc, char** argv, Action& action) {
  constexpr int kCannot = 2;
  app.set_version_flag("--version", std::string(kVersion));
  for (CLI::App* command : app.get_subcommands({}))
    command->set_version_flag("--version", std::string(kVersion));
  try {
    app.parse(words_of(argc, argv));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    fmt::print(stderr, "{}: {}; see --help\n", app.get_name(), error.what());
    return kCannot;
  }
  try {
    return action();
  } catch (const StartupError& refusal) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), refusal.what());
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: unexpected: {}\n", app.get_name(), error.what());
  }
  return kCannot;
}

}  // namespace telekerf
