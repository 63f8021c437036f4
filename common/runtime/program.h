// SPDX-License-Identifier: Apache-2.0
// What every program shares: its commands and their settings, --help, --version, --print-config, one sentence
// on stderr and exit code 2 when it cannot work.
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/runtime/settings.h"

namespace telekerf {

/// Something that a program can do: with its settings loaded, it runs and returns the exit code (0 good, 1 a
/// bad verdict).
struct Command {
  std::string name;
  std::string sentence;
  std::function<void(Settings&)> add_parameters;
  /// Throws StartupError if the settings do not go together.
  std::function<void()> validate;
  /// Hears the settings as --config reads them: all, and those that were given.
  std::function<void(const std::string& all, const std::string& given)> remember;
  std::function<int()> run;
};

class Program {
 public:
  Program(std::string name, std::string sentence) : name_(std::move(name)), sentence_(std::move(sentence)) {}

  /// `add_parameters(options, settings)` declares, `action(options)` does it. Options may have a `validate()`
  /// that throws StartupError: it is asked before anything is done, printing the settings too; and texts `config`,
  /// which is what --print-config would write, and `given`, of it what the user has said. `name`: as it stands on the
  /// command line; empty: the program has no other commands.
  template <typename Options, typename AddParameters, typename Action>
  void add(const std::string& name, const std::string& sentence, Options initial,
           AddParameters add_parameters, Action action) {
    for (const auto& command : commands_)
      if (command.name == name) throw std::logic_error("two commands are called " + name);
    auto options = std::make_shared<Options>(std::move(initial));
    commands_.push_back(
        {name, sentence,
         [options, add_parameters](Settings& settings) { add_parameters(*options, settings); },
         [options] {
           if constexpr (requires { options->validate(); }) options->validate();
         },
         [options]([[maybe_unused]] const std::string& all, [[maybe_unused]] const std::string& given) {
           if constexpr (requires { options->config = all; }) options->config = all;
           if constexpr (requires { options->given = given; }) options->given = given;
         },
         [options, action] { return action(*options); }});
  }

  /// Loads the settings and runs the command. Exit codes: 0 and 1 are the command's; 2: it cannot be done,
  /// one sentence on stderr says why.
  int run(int argc, char** argv);

 private:
  int dispatch(std::vector<std::string> words);
  /// Takes the command's name out of the words.
  const Command* chosen(std::vector<std::string>& words) const;
  std::string help(const Command* command) const;
  std::string description() const;

  std::string name_;
  std::string sentence_;
  std::vector<Command> commands_;
};

/// A program that does one thing: `main` in one line.
template <typename Options, typename AddParameters, typename Action>
int run_program(int argc, char** argv, const std::string& name, const std::string& sentence, Options initial,
                AddParameters add_parameters, Action action) {
  Program program(name, sentence);
  program.add("", sentence, std::move(initial), add_parameters, action);
  return program.run(argc, argv);
}

}  // namespace telekerf
