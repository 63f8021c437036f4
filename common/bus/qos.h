// SPDX-License-Identifier: Apache-2.0
// Fast DDS settings of readers and writers, by intent. Inside the bus only.
#pragma once

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "common/bus/middleware.h"
#include "common/bus/topics.h"

namespace telekerf::bus {

inline middleware::Duration_t milliseconds(double value) { return {static_cast<long double>(value * 1e-3)}; }

/// That a writer keeps for whoever comes late, or is behind.
std::size_t kept_samples(Intent intent);

eprosima::fastdds::dds::DataWriterQos writer_qos(Intent intent);
eprosima::fastdds::dds::DataReaderQos reader_qos(Intent intent);

}  // namespace telekerf::bus
