// SPDX-License-Identifier: Apache-2.0
// telekerf-inspect label FOLDER good|bad [TEXT]: a person's verdict on a run, kept in its recordings.
#include <fmt/format.h>

#include "common/recording/run_folder.h"
#include "common/recording/run_probe.h"
#include "common/runtime/enum_table.h"
#include "tools/inspect/commands.h"

namespace telekerf::inspect {
namespace {

constexpr EnumRow<bool> kVerdicts[] = {{"good", true, "as it should be"}, {"bad", false, "not to be used"}};

struct LabelOptions {
  std::string folder;
  RunLabel label;
};

}  // namespace

void add_label_command(Program& program) {
  program.add(
      "label", "Attaches a person's verdict to a run: label FOLDER good|bad \"why\"", LabelOptions{},
      [](LabelOptions& o, Settings& s) {
        s.add("folder", o.folder, kFolder, "that the run recorded into").as_argument();
        s.add("verdict", o.label.good, EnumTable<bool>(kVerdicts), "good or bad").as_argument();
        s.add("text", o.label.text, kName, "why").as_argument();
      },
      [](const LabelOptions& o) {
        probe_recordings(o.folder);
        label_run(o.folder, o.label);
        fmt::print("{}: {}\n", o.label.good ? "good" : "bad", o.label.text);
        return 0;
      });
}

}  // namespace telekerf::inspect
