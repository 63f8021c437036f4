// SPDX-License-Identifier: Apache-2.0
// Shipped data (robots, profiles, pictures, configurations): a shipped name or a path.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace telekerf {

/// Folder that holds the shipped data: $TELEKERF_DATA, else ../share/telekerf beside the running program.
std::filesystem::path data_folder();

/// Another program of Telekerf, beside the running one.
std::filesystem::path program_beside(const std::string& name);

/// A path that exists is taken as it is; otherwise `name` + `extension` is looked up in the shipped `kind`
/// ("robots", "profiles", "pictures", "config"). Throws StartupError that lists the shipped names.
std::filesystem::path find_resource(const std::string& kind, const std::string& name,
                                    const std::string& extension);

/// What is wrong with such a name, and what may be said instead; empty: a folder or file is there.
std::string complaint_about_resource(const std::string& kind, const std::string& name,
                                     const std::string& extension);

/// Names (without extension) of everything shipped of one kind, sorted.
std::vector<std::string> shipped_names(const std::string& kind, const std::string& extension);

}  // namespace telekerf
