// SPDX-License-Identifier: Apache-2.0
// A setting is declared once and read two ways: as key `stream_hz` of a configuration file and as flag
// --stream-hz.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/config.h"
#include "common/runtime/program.h"

namespace telekerf {

/// Declares settings that live in a plain struct (their values there are the defaults), then fills them:
/// first from the file named by --config, then from the command line. Refusals name the source, key, value
/// and bound.
class Settings {
 public:
  void add(const std::string& name, double& value, Bounds bounds, const std::string& help);
  void add(const std::string& name, int& value, Bounds bounds, const std::string& help);
  void add(const std::string& name, std::uint64_t& value, Bounds bounds, const std::string& help);
  void add(const std::string& name, bool& value, const std::string& help);
  void add(const std::string& name, std::string& value, const std::string& help,
           const std::vector<std::string>& choices = {});
  /// `complaint`: what a value must be, if it is not; empty: it is.
  void add(const std::string& name, std::string& value, const std::string& help,
           const std::function<std::string(const std::string&)>& complaint);

  /// Adds the flags (and --config FILE) to `app`; `fill` is called after parsing.
  void attach(CLI::App& app);
  void fill();

 private:
  struct Entry {
    std::string name;
    std::string help;
    std::function<void(const ConfigFile&)> read;
    bool is_flag = false;
    bool quoted = false;
    std::optional<std::string> given;  ///< the command line's text
  };
  void apply(const ConfigFile& file);

  std::vector<Entry> entries_;
  std::string config_;
};

}  // namespace telekerf
