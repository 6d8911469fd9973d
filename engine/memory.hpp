#pragma once

#include <cstdint>
#include <string>

namespace bris {

/// Bytes that this process may have: the machine's, or what its control group (a container) allows
/// if that is less.
std::uint64_t machine_memory();

/// Bytes of data that a process has before there is a scene, much of which it never touches, and
/// those of each thread.
inline constexpr double bytes_of_process = 1.3e8, bytes_of_thread = 4e6;

/// Lets every allocation fail that would bring the process beyond `bytes` of data; 0: no limit.
/// Throws InputError, also where `threads` could not even begin.
void limit_memory(std::uint64_t bytes, unsigned threads);

/// Refuses what cannot fit, before anything is allocated. `option` asks for `count` things, which
/// take about `bytes` together; `limit`: bytes, of --memory, 0 if there is none. Throws InputError.
void require_memory(const std::string& option, double count, double bytes, std::uint64_t limit);

} // namespace bris
