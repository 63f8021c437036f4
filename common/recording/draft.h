// SPDX-License-Identifier: Apache-2.0
// A file on the way to its place: written beside it, put there whole, so that whoever is killed meanwhile
// leaves what was there before.
#pragma once

#include <filesystem>

namespace telekerf {

/// FILE.PROCESS.part of this process.
std::filesystem::path draft_of(const std::filesystem::path& file);
/// Syncs the draft to the disk and renames it. Throws h5::Failure.
void put_in_place(const std::filesystem::path& draft, const std::filesystem::path& file);
/// Removes the drafts of a recording (ROLE.h5) and of its flights that processes which are gone have left.
void remove_drafts(const std::filesystem::path& recording);

}  // namespace telekerf
