#include "engine/archive.hpp"

#include "engine/errors.hpp"
#include "engine/running_hash.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

std::uint64_t mix_bytes(std::uint64_t h, const std::byte* data, std::size_t size) {
    for (; size >= 8; data += 8, size -= 8) {
        std::uint64_t word;
        std::memcpy(&word, data, 8);
        h = mix(h, word);
    }
    std::uint64_t tail = 0;
    if (size > 0) std::memcpy(&tail, data, size);
    return mix(h, tail + size);
}

} // namespace

const Archive::Array* Archive::find(const std::string& path) const {
    for (const Array& array : arrays_)
        if (array.path == path) return &array;
    return nullptr;
}

const Archive::Array& Archive::checked(const std::string& path, std::size_t scalar_size) const {
    const Array* array = find(path);
    require(array != nullptr, "checkpoint: expected an array '" + path + "', found none");
    require(array->scalar_size == scalar_size,
            "checkpoint: '" + path + "' has numbers of a different size");
    return *array;
}

std::uint64_t fingerprint(const Archive& archive, const std::string& prefix) {
    std::uint64_t h = 0x62726973;
    for (const auto& array : archive.arrays()) {
        if (!array.path.starts_with(prefix) || array.path.starts_with("guard/")) continue;
        h = mix(mix(h, array.scalar_size), array.columns);
        h = mix_bytes(h, array.bytes.data(), array.bytes.size());
    }
    return h;
}

std::string hexadecimal(std::uint64_t fingerprint) { return fmt::format("{:016x}", fingerprint); }

} // namespace bris
