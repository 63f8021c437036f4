// SPDX-License-Identifier: Apache-2.0
#include "master/tool_hand.h"

namespace telekerf::master {

HandSample ToolHand::sample(std::int64_t now_ns, double now_s, const robot::RobotSupervisor& machine,
                            SimulatedOperator* simulated, double beta, bool guided) noexcept {
  const OperatorSample told = device_ ? device_->sample(now_ns) : OperatorSample{};
  held_ = told.held;
  if (simulated == nullptr) return {};
  HandSample hand{.force_n = Vec3::Zero(), .trigger = told.trigger};
  const auto tool_m = machine.true_tool_m();
  const auto velocity = machine.true_tool_velocity_m_per_s();
  if (!tool_m || !velocity) return hand;
  if (!device_) return simulated->sample(now_s, *tool_m, *velocity, guided);
  if (!guided) return hand;
  if (told.force_n) hand.force_n = *told.force_n;
  if (told.pointer_m) hand.force_n += arm_force(arm_, *told.pointer_m / beta, *tool_m, *velocity);
  return hand;
}

}  // namespace telekerf::master
