// SPDX-License-Identifier: Apache-2.0
#include "master/mode_words.h"

#include "common/protocol/sentences.h"

namespace telekerf::master {

const char* text_of(MasterMode mode, const StateHeader* slave, bool ours, std::uint32_t contour_id,
                    bool off_line) {
  if (mode == MasterMode::kEngaged && slave != nullptr && (!ours || slave->mode != SlaveMode::kFollowing))
    return !ours ? "engaged, but the slave does not answer to this master" : led_sentence_of(slave->reason);
  switch (mode) {
    case MasterMode::kIdle:
      return "waiting for a contour";
    case MasterMode::kApproach:
      return "moving to the contour";
    case MasterMode::kGuiding:
      if (slave != nullptr && slave->contour_id == 0)
        return "guiding the hand; the slave has no contour: it has refused this one, or hears no vision";
      if (slave != nullptr && slave->contour_id != contour_id)
        return "guiding the hand; the slave works on another contour than this side";
      return "guiding the hand; the slave does not follow";
    case MasterMode::kEngaged:
      return off_line ? "engaged: the hand pushes the tool off the line, so the beam waits until it is back"
                      : "engaged: the slave follows";
    case MasterMode::kStopped:
      return "stopped";
  }
  return "unknown";
}

}  // namespace telekerf::master
