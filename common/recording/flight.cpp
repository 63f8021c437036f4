// SPDX-License-Identifier: Apache-2.0
#include "common/recording/flight.h"

#include "common/recording/closed_file.h"

namespace telekerf {

void write_flight(const std::filesystem::path& file, const RunIdentity& identity,
                  std::span<const SeriesData> last, const RunEvent& event) {
  ClosedFile to(file, identity, RunState::kClosed);
  for (const SeriesData& data : last)
    to.append(to.add(data.schema, ClosedFile::Begin::kAnywhere), data.numbers);
  to.append(event);
  (void)to.finish();
}

}  // namespace telekerf
