// SPDX-License-Identifier: Apache-2.0
#include "common/recording/run_process.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "common/recording/h5.h"

namespace telekerf {
namespace {

/// When a process was started, in the kernel's own count; a number that is used again has another. Empty:
/// there is no such process, or only what is left of it.
std::string start_of(int process) {
  std::ifstream in(fmt::format("/proc/{}/stat", process));
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto name_end = text.rfind(')');
  if (name_end == std::string::npos) return {};
  std::istringstream fields(text.substr(name_end + 1));
  std::string field;
  fields >> field;
  if (field == "Z" || field == "X") return {};
  for (int n = 0; n < 19; ++n) fields >> field;
  return field;
}

/// Empty where the system shows a process no more than processes (a service's ProcSubset=pid).
std::string boot() {
  std::ifstream in("/proc/sys/kernel/random/boot_id");
  std::string id;
  in >> id;
  return id;
}

}  // namespace

void write_process(hid_t file) {
  h5::set_count(file, "process", static_cast<std::uint64_t>(::getpid()));
  h5::set_text(file, "process_start", start_of(::getpid()));
  h5::set_text(file, "boot", boot());
}

std::optional<int> writing_process(hid_t file) {
  const auto process = h5::number_of(file, "process");
  if (!process) return std::nullopt;
  // Where either of the two may not know the boot, number and start say enough.
  const std::string then = h5::text_of(file, "boot").value_or(""), now = boot();
  if (!then.empty() && !now.empty() && then != now) return std::nullopt;
  const std::string start = start_of(static_cast<int>(*process));
  if (start.empty() || h5::text_of(file, "process_start") != start) return std::nullopt;
  return static_cast<int>(*process);
}

}  // namespace telekerf
