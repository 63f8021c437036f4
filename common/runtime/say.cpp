// SPDX-License-Identifier: Apache-2.0
#include "common/runtime/say.h"

namespace telekerf {

void write_text(std::FILE* to, std::string_view text) noexcept {
  (void)std::fwrite(text.data(), 1, text.size(), to);
  (void)std::fflush(to);
}

void write_line(std::FILE* to, std::string_view text) noexcept {
  (void)std::fwrite(text.data(), 1, text.size(), to);
  (void)std::fputc('\n', to);
  (void)std::fflush(to);
}

}  // namespace telekerf
