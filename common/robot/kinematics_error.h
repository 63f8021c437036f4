// SPDX-License-Identifier: Apache-2.0
// Why a delta robot cannot take a pose: an error value for control steps, and its sentence for people.
#pragma once

#include <cstdint>
#include <string>

namespace telekerf::robot {

/// A pose that the machine cannot take. `leg` is 0..2; -1 when the reason is not one leg's.
struct KinematicsError {
  enum class Kind : std::uint8_t {
    kNotFinite,    ///< an input is NaN or infinite
    kUnreachable,  ///< the rod is too short for this pose (Delta_i < 0 in eq. 135, negative root in eq. 130)
    kOutOfStroke,  ///< the carriage would have to leave its rail
    kOtherAssembly,    ///< the tool would be on the other side of the carriages than the machine is built
    kSerialSingular,   ///< the rod is square to its rail (f_di = 0, eq. 142): the leg cannot move the tool
    kParallelSingular  ///< the rods lie in one plane (det J_2 = 0, eq. 145): the legs cannot hold the tool
  };
  Kind kind = Kind::kNotFinite;
  int leg = -1;
  double value_m =
      0.0;  ///< kOutOfStroke: the joint position asked for; kUnreachable: length that the rod lacks
  double bound_m = 0.0;  ///< kOutOfStroke: the end of the stroke that is passed

  bool operator==(const KinematicsError&) const = default;
};

/// One sentence that names the leg (counted from 1, as on the machine) and the reason.
std::string describe(const KinematicsError& error);

}  // namespace telekerf::robot
