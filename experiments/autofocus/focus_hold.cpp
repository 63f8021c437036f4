// SPDX-License-Identifier: Apache-2.0
#include "experiments/autofocus/focus_hold.h"

#include "experiments/autofocus/focus_trial.h"

namespace telekerf::experiments {

using namespace imaging;

FocusHold hold_focus(Target target, std::uint64_t seed, double seconds) {
  const DrawnStart start = draw_start({target, StartKind::kUsual, seed});
  VirtualUnit& unit = *start.unit;
  const ImagingModel& model = unit.microscope().settings().model;
  Autofocus autofocus({}, model, unit.control().lowest_m(), unit.control().highest_m(kFocus));
  focus_now(unit, autofocus);
  FocusHold hold;
  LiveFocus live(unit, autofocus);
  for (const double until_s = unit.time_s() + seconds; unit.time_s() < until_s;) {
    const cv::Mat picture = unit.next_frame();
    const double defocus_dof = unit.defocus_dof();
    hold.all_dof.add(defocus_dof);
    if (live.step(picture, false)) hold.passed_dof.add(defocus_dof);
  }
  hold.lost = autofocus.state() != Autofocus::State::kTracking || autofocus.searches() > 1;
  return hold;
}

}  // namespace telekerf::experiments
