// SPDX-License-Identifier: Apache-2.0
#include "experiments/replay/virtual_run.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "common/recording/closed_file.h"
#include "common/recording/run_tables.h"
#include "common/runtime/resources.h"
#include "common/runtime/setting.h"
#include "common/runtime/startup_error.h"

namespace telekerf::experiments {

void write_virtual_run(const std::filesystem::path& folder, const RunRecord& record,
                       const ContourMessage& contour, const VirtualSettings& settings) {
  RunIdentity identity{.program = "telekerf-experiment lap", .cell = "", .virtual_time = true};
  identity.settings = settings.config;
  std::ifstream profile(find_resource(kProfile.shipped, settings.netem, kProfile.extension));
  identity.network.assign(std::istreambuf_iterator<char>(profile), {});
  const RunContour kept = recorded(contour);
  const InForceRow in_force{.tick = record.master.empty() ? 0 : record.master.front().tick,
                            .contour_id = contour.id};
  const auto write = [&](const std::string& role, const SeriesData& rows) {
    identity.role = role;
    try {
      ClosedFile file(folder / (role + ".h5"), identity, RunState::kClosed);
      file.append(file.add(rows.schema), rows.numbers);
      const SeriesData began = series_of<InForceRow>("in_force", in_force_columns(), std::span(&in_force, 1));
      file.append(file.add(began.schema), began.numbers);
      file.append(kept);
      (void)file.finish();
    } catch (const h5::Failure& failure) {
      throw environment_error(fmt::format("--out {}: {}.h5: {}", folder.string(), role, failure.what()));
    }
  };
  identity.words = record.words;
  identity.figures = record.master_figures;
  identity.drive = record.master_drive;
  write("master", series_of<MasterRow>("master", master_columns(), record.master, true));
  identity.words.clear();
  identity.figures = record.slave_figures;
  identity.drive = record.slave_drive;
  write("slave", series_of<SlaveRow>("slave", slave_columns(), record.slave, true));
}

}  // namespace telekerf::experiments
