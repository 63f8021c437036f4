// SPDX-License-Identifier: Apache-2.0
// The rules of the house. Each returns what breaks it, a sentence a breach that begins with the file's path.
#pragma once

#include <string>
#include <vector>

#include "tests/structure/repository.h"
#include "tests/structure/rooms.h"

namespace telekerf::structure {

using Breaches = std::vector<std::string>;

/// Includes go where the table lets them, and every source has a room.
Breaches upward_arrows(const Repository& repository, const Rooms& rooms);
/// No file includes itself through others, and no room.
Breaches include_cycles(const Repository& repository, const Rooms& rooms);
/// Libraries only in common/.
Breaches programs_in_common(const Repository& repository);
/// Fast DDS is known to common/bus and to one driver of the emulator.
Breaches strayed_dds(const Repository& repository);

/// 400 lines; 210 on the way from a law to a motor.
Breaches long_files(const Repository& repository);
/// A source and its header stand side by side under one name. Alone may stand: a program, a subcommand (it is
/// declared in commands.h), a header that defines all that it declares.
Breaches unpaired_files(const Repository& repository);
/// Sources of one library may be compiled together (a demo does): what they define for themselves has names
/// that differ.
Breaches colliding_names(const Repository& repository);
/// The first line names the licence.
Breaches missing_licence(const Repository& repository);

/// Files, folders and pages that prose names exist.
Breaches dead_mentions(const Repository& repository);
/// Programs that prose names exist.
Breaches dead_programs(const Repository& repository);

/// A number with a unit in the README or a page of results says where it comes from: `0.68<!-- claim ID -->`,
/// or `0.68<!-- cell TABLE: ROW; COLUMN -->` of a generated table, and is what stands there; or `list` gives
/// the reason why it may be typed, a row "PAGE | KIND | WHERE" each (tests/structure/typed_numbers.txt).
Breaches typed_numbers(const Repository& repository, const std::string& list);

}  // namespace telekerf::structure
