// SPDX-License-Identifier: Apache-2.0
// Defaults of the sanitizer builds, linked into every program and test of theirs: what is known of the libraries
// underneath, so that anything reported is ours.
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier): the names are the sanitizers'

/// Fast DDS 2.9's readers and writers are freed through a base class of another size.
const char* __asan_default_options();
const char* __asan_default_options() { return "new_delete_type_mismatch=0"; }

const char* __tsan_default_options();
const char* __tsan_default_options() { return "suppressions=" TELEKERF_TSAN_SUPPRESSIONS; }

// NOLINTEND(bugprone-reserved-identifier)
}
