// SPDX-License-Identifier: Apache-2.0
#include "master/operator/operator_input.h"

#include "common/runtime/device_registry.h"
#include "common/runtime/udp.h"
#include "master/operator/evdev_device.h"
#include "master/operator/recorded_hand.h"
#include "master/operator/udp_foot_switch.h"
#include "master/operator/udp_hand.h"

namespace telekerf::master {
namespace {

class AlwaysPressed final : public OperatorInput {
 public:
  OperatorSample sample(std::int64_t) noexcept override { return {.trigger = true}; }
};

std::unique_ptr<OperatorInput> nobody(std::string_view) { return nullptr; }
std::unique_ptr<OperatorInput> pressed(std::string_view) { return std::make_unique<AlwaysPressed>(); }

// A device of your own: one row.
using Registry = DeviceRegistry<std::unique_ptr<OperatorInput>>;
constexpr Registry::Kind kKinds[] = {
    {"hand", "hand", no_argument, nobody},
    {"pressed", "pressed", no_argument, pressed},
    {"udp", "udp:HOST:PORT", validate_sealed_udp, open_udp_foot_switch},
    {"evdev", "evdev:PATH", validate_evdev, open_evdev_button},
};
constexpr Registry kInputs("button", kKinds);

/// A hand that nothing is set of.
template <auto kOpen>
std::unique_ptr<OperatorInput> plain(std::string_view rest, const SpaceMouseSettings&) {
  return kOpen(rest);
}

// A hand of your own: one row.
using HandRegistry = DeviceRegistry<std::unique_ptr<OperatorInput>, const SpaceMouseSettings&>;
constexpr HandRegistry::Kind kHandKinds[] = {
    {"simulated", "simulated", no_argument, plain<nobody>},
    {"browser", "browser, browser:HOST:PORT", validate_browser_hand, plain<open_browser_hand>},
    {"udp", "udp:HOST:PORT", validate_udp, plain<open_udp_hand>},
    {"evdev", "evdev:PATH", validate_evdev, open_evdev_hand},
    {"spacemouse", "spacemouse, spacemouse:PATH", validate_space_mouse, open_space_mouse},
    {"recorded", "recorded:FILE", validate_recorded_hand, plain<open_recorded_hand>},
};
constexpr HandRegistry kHands("hand", kHandKinds);

}  // namespace

std::string operator_input_forms() { return kInputs.forms(); }

std::string validate_operator_input(const std::string& button) { return kInputs.validate(button); }

std::unique_ptr<OperatorInput> open_operator_input(const std::string& button) { return kInputs.open(button); }

std::string hand_forms() { return kHands.forms(); }

std::string validate_hand(const std::string& hand) { return kHands.validate(hand); }

std::unique_ptr<OperatorInput> open_hand(const std::string& hand, const SpaceMouseSettings& cap) {
  return kHands.open(hand, cap);
}

}  // namespace telekerf::master
