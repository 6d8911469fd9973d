#pragma once

#include <cstdint>
#include <string>

namespace bris {

/// Bytes that this process may have: the machine's, or what its control group (a container) allows if that is less.
std::uint64_t machine_memory();

/// Lets every allocation fail that would bring the process beyond `bytes` of data; 0: no limit. Throws InputError.
void limit_memory(std::uint64_t bytes);

/// Refuses what cannot fit, before anything is allocated. `option` asks for `count` things, which take about `bytes`
/// together; `limit`: bytes, of --memory, 0 if there is none. Throws InputError.
void require_memory(const std::string& option, double count, double bytes, std::uint64_t limit);

} // namespace bris
