// SPDX-License-Identifier: Apache-2.0
#include "common/streaming/packetizer.h"

#include <utility>

namespace telekerf::streaming {

Packetizer::Packetizer(const PacketizerSettings& settings) : settings_(settings), encoder_(settings.codec) {
  samples_.fill(Vec3::Zero());
}

void Packetizer::change(const codec::StreamSettings& codec) {
  next_ = codec.validated();
  next_->sample_period_ns = settings_.codec.sample_period_ns;
  next_->anchored = settings_.codec.anchored;
}

void Packetizer::take_over(Packetizer& before) noexcept {
  std::swap(encoder_, before.encoder_);
  encoder_.change(settings_.codec);  // was in bounds when this one was made
  number_ = before.number_;
}

void Packetizer::begin(std::int64_t index, const Anchor& anchor) noexcept {
  if (next_) {
    settings_.codec = *next_;
    encoder_.change(settings_.codec);
    next_.reset();
  }
  index_ = index;
  anchor_ = anchor;
  buttons_ = 0;
  filled_ = 0;
}

bool Packetizer::add(const Vec3& sample, bool button) noexcept {
  if (button) buttons_ |= std::uint64_t{1} << filled_;
  samples_[filled_++] = sample;
  return filled_ == static_cast<std::size_t>(settings_.codec.block);
}

bool Packetizer::encode(Payload& payload) noexcept {
  const std::size_t count = filled_;
  filled_ = 0;
  codec::Trend trend;
  if (settings_.codec.anchored) {
    trend = {anchor_.position_m, anchor_.velocity_m_per_s * (settings_.sample_period_ns * 1e-9)};
  }
  const auto bytes = encoder_.encode(std::span(samples_.data(), count), buttons_, trend, payload.room());
  payload.size = static_cast<std::uint16_t>(bytes.value_or(0));
  return bytes.has_value();
}

}  // namespace telekerf::streaming
