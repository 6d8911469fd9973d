#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace bris {

/// Memory in bytes that this process may use: that of the machine, or the limit of its control
/// group (a container) if that is less.
std::uint64_t machine_memory();

/// The least limit (bytes) of the control groups in which this process is, and of those around
/// them; the largest number if there is none. `root`: of the file system.
std::uint64_t memory_of_groups(const std::filesystem::path& root);

/// Bytes of memory that this process has used at most; 0 if the system does not say.
std::uint64_t largest_memory();

/// Returns to the system what this process has used for something large and rare, such as a frame
/// of all bodies. The allocator would keep most of it.
void return_free_memory();

/// Bytes of data that a process reserves without a scene, much of which it never touches: what its
/// libraries had reserved when this was first called, and what they will.
double bytes_of_process();
inline constexpr double bytes_of_thread = 4e6;

/// Makes every allocation fail that would take the data of the process beyond `bytes`; 0: no limit.
/// Throws InputError if the limit cannot be set or is too small for `threads` threads to start.
void limit_memory(std::uint64_t bytes, unsigned threads);

/// Rejects a request that cannot fit in memory, before anything is allocated. The option named
/// `option` requests `count` items, which need about `bytes` bytes in total. `limit`: bytes given
/// by --memory, 0 if there is no limit. Throws InputError.
void require_memory(const std::string& option, double count, double bytes, std::uint64_t limit);

} // namespace bris
