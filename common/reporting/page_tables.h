// SPDX-License-Identifier: Apache-2.0
// Tables of result pages: Markdown between two comments, `<!-- table NAME -->` and `<!-- end of NAME -->`.
// The command that measures writes them, a test reads them again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace telekerf::reporting {

struct PageTable {
  std::string name;
  std::string markdown;
};
using TableRows = std::vector<std::vector<std::string>>;

/// The first row is the head. Cells hold no `|`.
std::string markdown_table(const TableRows& rows);

/// Puts each table between its comments; the rest of the page stays. Throws StartupError for a file that
/// cannot be read or written, or that lacks a table's comments.
void write_tables(const std::filesystem::path& page, const std::vector<PageTable>& tables);

/// The rows of such a table, the head first.
TableRows read_rows(const std::string& markdown);

/// The rows of the table of this name, the head first. Throws StartupError likewise.
TableRows read_table(const std::filesystem::path& page, const std::string& name);

}  // namespace telekerf::reporting
