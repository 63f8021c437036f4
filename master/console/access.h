// SPDX-License-Identifier: Apache-2.0
// Who may speak to the server: no other web page, and no name that somebody's DNS has turned to this host.
#pragma once

#include <string>
#include <string_view>

namespace telekerf::master {

/// A request's Host: an address literal, localhost or `name` (empty: no further one), with this port or,
/// if it is that of http or https, without one.
bool host_allowed(std::string_view host, std::string_view name, unsigned port);
/// A request's Origin: none (no browser), or the page of this very host and port, by http or https.
bool origin_allowed(std::string_view origin, std::string_view scheme, std::string_view host);
/// The same in constant time whatever is wrong with it. An empty token opens nothing.
bool token_matches(std::string_view token, std::string_view given) noexcept;
/// Nobody guesses it: 128 random bits in hexadecimal digits.
std::string new_token();

/// What anyone in the network could do where the page is served at `bind`, and which options help: one sentence. Empty:
/// this computer alone is served, or it is encrypted. `token_given`: by the user, for others to drive with.
std::string warning_of(const std::string& bind, bool encrypted, bool token_given);

}  // namespace telekerf::master
